#include "policy/policy_bundle.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "physics/core/error.h"
#include "physics/core/random.h"
#include "physics/core/read_budget.h"
#include "policy/policy_bundle_names.h"
#include "policy/safetensors.h"

namespace crossgait {
namespace {

double activate(MlpActivation activation, double x) {
  switch (activation) {
    case MlpActivation::kTanh:
      return std::tanh(x);
    case MlpActivation::kElu:
      return x > 0 ? x : std::expm1(x);
    case MlpActivation::kRelu:
      return x > 0 ? x : 0;
    case MlpActivation::kSwish:
      return x / (1 + std::exp(-x));
    case MlpActivation::kSoftsign:
      return x / (1 + std::abs(x));
  }
  return x;
}

template <typename Table, typename Value>
std::string name_of(const Table& table, Value value) {
  return std::string(std::find_if(table.begin(), table.end(), [value](const auto& row) {
                       return row.second == value;
                     })->first);
}

Tensor to_tensor(const Eigen::MatrixXd& matrix, Tensor::Kind kind) {
  Tensor tensor{kind, {static_cast<std::size_t>(matrix.rows()), static_cast<std::size_t>(matrix.cols())}, {}};
  for (const auto& row : matrix.rowwise()) tensor.values.insert(tensor.values.end(), row.begin(), row.end());
  return tensor;
}

Tensor to_tensor(const Eigen::VectorXd& vector, Tensor::Kind kind) {
  return {kind, {static_cast<std::size_t>(vector.size())}, {vector.begin(), vector.end()}};
}

/// As the file will hold it: weights in single precision.
MlpNetwork rounded(MlpNetwork network) {
  for (MlpLayer& layer : network.layers) {
    layer.weight = layer.weight.cast<float>().cast<double>().eval();
    layer.bias = layer.bias.cast<float>().cast<double>().eval();
  }
  return network;
}

void expect(const std::string& path, std::string_view element, Eigen::Index found, Eigen::Index expected) {
  if (found != expected) throw ConfigError(path, element, std::to_string(expected), std::to_string(found));
}

void check_fit(const std::string& path, const MlpNetwork& network, const PolicyInterface& interface) {
  check_layers(path, network, static_cast<Eigen::Index>(interface.observation.size()));
  expect(path, "outputs", network.layers.back().weight.rows(),
         static_cast<Eigen::Index>(interface.action.size()));
}

/// @param stored  the network as the file will hold it
void check_numbers(const std::string& path, const MlpNetwork& stored) {
  const auto is_finite = [](const MlpLayer& layer) {
    return layer.weight.allFinite() && layer.bias.allFinite();
  };
  if (!std::all_of(stored.layers.begin(), stored.layers.end(), is_finite) ||
      !stored.observation_mean.allFinite()) {
    throw ConfigError(path, "weights, biases and means", "finite numbers", "others");
  }
  const auto deviation = stored.observation_std.array();
  if (!deviation.isFinite().all() || !(deviation > 0).all() || !(stored.observation_clip > 0)) {
    throw ConfigError(path, "observation_std and observation_clip", "positive numbers", "others");
  }
}

/// Observations around the network's mean; half of them with one entry beyond the clip (with more, saturated
/// activations would hide where the clip is).
Eigen::MatrixXd golden_observations(const MlpNetwork& network, std::size_t inputs) {
  constexpr Eigen::Index kPairs = 8;
  constexpr double kSpread = 2, kBeyondClip = 1.5;  // in standard deviations; times the clip
  Random random;
  Eigen::MatrixXd observations(kPairs, static_cast<Eigen::Index>(inputs));
  for (Eigen::Index row = 0; row < kPairs; ++row) {
    for (double& value : observations.row(row)) value = random.uniform(-kSpread, kSpread);
    if (row % 2 != 0 && std::isfinite(network.observation_clip)) {
      observations(row, row % observations.cols()) = kBeyondClip * network.observation_clip;
    }
    if (network.observation_mean.size() > 0) {
      observations.row(row).array() *= network.observation_std.transpose().array();
      observations.row(row) += network.observation_mean.transpose();
    }
  }
  return observations;
}

}  // namespace

Eigen::VectorXd MlpNetwork::evaluate(const Eigen::VectorXd& observation) const {
  Eigen::VectorXd x = observation;
  if (observation_mean.size() > 0) x = (x - observation_mean).cwiseQuotient(observation_std).eval();
  for (double& value : x) value = std::clamp(value, -observation_clip, observation_clip);
  for (const MlpLayer& layer : layers) {
    const bool last = &layer == &layers.back();
    x = (layer.weight * x + layer.bias).eval();
    for (double& value : x) {
      if (!last) value = activate(activation, value);
      if (last && output == MlpOutput::kTanh) value = std::tanh(value);
    }
  }
  return x;
}

void check_layers(const std::string& path, const MlpNetwork& network, Eigen::Index inputs) {
  if (network.layers.empty()) throw ConfigError(path, "layers", "at least one", "none");
  if (network.observation_mean.size() + network.observation_std.size() > 0) {
    expect(path, "size of observation_mean", network.observation_mean.size(), inputs);
    expect(path, "size of observation_std", network.observation_std.size(), inputs);
  }
  Eigen::Index width = inputs;
  for (const MlpLayer& layer : network.layers) {
    expect(path, "columns of a layer's weight", layer.weight.cols(), width);
    width = layer.weight.rows();
    expect(path, "size of a layer's bias", layer.bias.size(), width);
  }
}

PolicyBundle make_policy_bundle(const MlpNetwork& network, const PolicyInterface& interface,
                                const std::string& source) {
  check_fit(source, network, interface);
  PolicyBundle bundle{.network = rounded(network),
                      .observation_names = interface.observation.names(),
                      .action_names = interface.action.names(),
                      .layout_hash = layout_hash(interface.observation, interface.action),
                      .policy_dt = interface.policy_dt,
                      .golden_observation = {},
                      .golden_action = {}};
  check_numbers(source, bundle.network);
  bundle.golden_observation = golden_observations(bundle.network, interface.observation.size());
  bundle.golden_action.resize(bundle.golden_observation.rows(), bundle.network.layers.back().bias.size());
  for (Eigen::Index row = 0; row < bundle.golden_observation.rows(); ++row) {
    const Eigen::VectorXd action = bundle.network.evaluate(bundle.golden_observation.row(row));
    for (Eigen::Index i = 0; i < action.size(); ++i) {
      const LayoutEntry& entry = interface.action.entries[static_cast<std::size_t>(i)];
      bundle.golden_action(row, i) = std::clamp(action[i], entry.min, entry.max);
    }
  }
  return bundle;
}

PolicyBundle with_golden_pairs(PolicyBundle bundle, const Eigen::MatrixXd& observation,
                               const Eigen::MatrixXd& action, const std::string& source) {
  const auto rows = static_cast<std::size_t>(observation.rows());
  if (rows < 1 || rows > kMaxGoldenPairs) {
    throw ConfigError(source, "golden pairs", fmt::format("1 to {}", kMaxGoldenPairs), std::to_string(rows));
  }
  const auto check = [&](std::string_view element, const Eigen::MatrixXd& found, std::size_t columns) {
    const std::vector shape{static_cast<std::size_t>(found.rows()), static_cast<std::size_t>(found.cols())};
    if (shape != std::vector{rows, columns}) {
      throw ConfigError(source, element, "shape " + describe_shape({rows, columns}), describe_shape(shape));
    }
    if (!found.allFinite()) throw ConfigError(source, element, "finite numbers", "others");
  };
  check("golden.observation", observation, bundle.observation_names.size());
  check("golden.action", action, bundle.action_names.size());
  bundle.golden_observation = observation;
  bundle.golden_action = action;
  return bundle;
}

void write_policy_bundle(const std::string& path, const PolicyBundle& bundle) {
  const MlpNetwork& network = bundle.network;
  TensorFile file;
  file.metadata = {{"format", std::string(bundle_names::kFormat)},
                   {"activation", name_of(bundle_names::kActivations, network.activation)},
                   {"output", name_of(bundle_names::kOutputs, network.output)},
                   {"layout_version", std::to_string(kLayoutVersion)},
                   {"layout_hash", bundle.layout_hash},
                   {"observation_names", nlohmann::json(bundle.observation_names).dump()},
                   {"action_names", nlohmann::json(bundle.action_names).dump()}};
  if (bundle.policy_dt) file.metadata["policy_dt"] = fmt::format("{}", *bundle.policy_dt);
  if (std::isfinite(network.observation_clip)) {
    file.metadata["observation_clip"] = fmt::format("{}", network.observation_clip);
  }
  constexpr auto kF32 = Tensor::Kind::kF32, kF64 = Tensor::Kind::kF64;
  if (network.observation_mean.size() > 0) {
    file.tensors["observation.mean"] = to_tensor(network.observation_mean, kF64);
    file.tensors["observation.std"] = to_tensor(network.observation_std, kF64);
  }
  for (std::size_t k = 0; k < network.layers.size(); ++k) {
    file.tensors[fmt::format("layer.{}.weight", k)] = to_tensor(network.layers[k].weight, kF32);
    file.tensors[fmt::format("layer.{}.bias", k)] = to_tensor(network.layers[k].bias, kF32);
  }
  file.tensors["golden.observation"] = to_tensor(bundle.golden_observation, kF64);
  file.tensors["golden.action"] = to_tensor(bundle.golden_action, kF64);
  write_safetensors(path, file);
}

void write_policy_bundle(const std::string& path, const MlpNetwork& network,
                         const PolicyInterface& interface) {
  write_policy_bundle(path, make_policy_bundle(network, interface, path));
}

}  // namespace crossgait
