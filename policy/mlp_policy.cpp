#include "policy/mlp_policy.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "policy/mlp_activation.h"

namespace crossgait {
MlpPolicy::MlpPolicy(const PolicyBundle& bundle, const std::string& source, const PolicyInterface& interface)
    : Policy(std::filesystem::path(source).filename(), interface),
      activation_(bundle.network.activation),
      output_(bundle.network.output),
      mean_(bundle.network.observation_mean),
      std_(bundle.network.observation_std),
      clip_(bundle.network.observation_clip),
      input_(static_cast<Eigen::Index>(interface.observation.size())) {
  check_interface(bundle, interface, source);
  if (mean_.size() == 0) {
    mean_ = Eigen::VectorXd::Zero(input_.size());
    std_ = Eigen::VectorXd::Ones(input_.size());
  }
  for (const MlpLayer& layer : bundle.network.layers) {
    layers_.push_back({layer.weight.cast<float>(), layer.bias.cast<float>(), layer.bias.cast<float>()});
    if (!layers_.back().weight.allFinite() || !layers_.back().bias.allFinite()) {
      throw ConfigError(source, "layers", "weights and biases in the range of single precision",
                        "larger ones");
    }
  }
  check_golden(bundle, source);
}

void MlpPolicy::check_golden(const PolicyBundle& bundle, const std::string& path) {
  // Sums of a thousand products of order one are good to about 1e-6 in single precision, in whatever order
  // they are added; a wrong activation, normalisation or layer order is off by far more than 1e-5, which in
  // turn moves a foot by no more than 0.1 micrometres.
  constexpr double kTolerance = 1e-5;
  std::vector<double> action(interface().action.size());
  for (Eigen::Index row = 0; row < bundle.golden_observation.rows(); ++row) {
    const Eigen::VectorXd observation = bundle.golden_observation.row(row);
    act({observation.data(), static_cast<std::size_t>(observation.size())}, action);
    for (std::size_t i = 0; i < action.size(); ++i) {
      // As acted: what is beyond the limits counts as at them, in the file as in the action.
      const LayoutEntry& entry = interface().action.entries[i];
      const double golden =
          std::clamp(bundle.golden_action(row, static_cast<Eigen::Index>(i)), entry.min, entry.max);
      if (std::abs(action[i] - golden) <= kTolerance) continue;
      throw ConfigError(path, fmt::format("golden.action [{}, {}]", row, i),
                        fmt::format("what the network makes of golden.observation, {:.7g} within {:g}",
                                    action[i], kTolerance),
                        fmt::format("{:.7g}", golden));
    }
  }
}

void MlpPolicy::do_reset(std::uint64_t /*seed*/) noexcept {}

void MlpPolicy::do_act(std::span<const double> observation, std::span<double> action) noexcept {
  for (Eigen::Index i = 0; i < input_.size(); ++i) {
    const double value = (observation[static_cast<std::size_t>(i)] - mean_[i]) / std_[i];
    input_[i] = static_cast<float>(std::clamp(value, -clip_, clip_));
  }
  // Checked here, for an activation may hide what is not a number.
  if (!input_.allFinite()) {
    std::fill(action.begin(), action.end(), 0.0);
    return;
  }
  const Eigen::VectorXf* x = &input_;
  for (Layer& layer : layers_) {
    layer.values = layer.bias;
    layer.values.noalias() += layer.weight * *x;
    if (&layer != &layers_.back()) activate(activation_, layer.values);
    x = &layer.values;
  }
  if (output_ == MlpOutput::kTanh) layers_.back().values.array() = layers_.back().values.array().tanh();
  for (std::size_t i = 0; i < action.size(); ++i) action[i] = (*x)[static_cast<Eigen::Index>(i)];
}

PolicyFactory load_mlp_policy(const std::string& path) {
  const auto bundle = std::make_shared<const PolicyBundle>(read_policy_bundle(path));
  return [bundle, path](const PolicyInterface& interface) {
    return std::make_unique<MlpPolicy>(*bundle, path, interface);
  };
}

}  // namespace crossgait
