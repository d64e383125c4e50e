// What the policies of tests and benchmarks run on, and networks for them.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "physics/core/random.h"
#include "policy/policy_bundle.h"

namespace crossgait::policy_tests {

inline Layout layout_of(const std::vector<std::string>& names) {
  Layout layout;
  for (const std::string& name : names) layout.entries.push_back({name, "-", -1, 1});
  return layout;
}

/// Has two parameters that adapt, of which one is observed, and two residuals.
inline PolicyInterface small_interface() {
  return {layout_of({"p_WB.x", "param.step_height", "terrain.front", "terrain.back"}),
          layout_of({"delta.step_height", "delta.step_length", "residual.FL.x", "residual.FL.z"}), 2e-3};
}

/// Is as large as an environment's.
inline PolicyInterface large_interface(int observations = 69, int actions = 16) {
  PolicyInterface interface;
  const auto fill = [](Layout& layout, int size, char name) {
    for (int i = 0; i < size; ++i) layout.entries.push_back({name + std::to_string(i), "-", -1, 1});
  };
  fill(interface.observation, observations, 'o');
  fill(interface.action, actions, 'a');
  return interface;
}

/// Draws random weights (so that activations neither die out nor saturate) and normalisation.
inline MlpNetwork random_network(const PolicyInterface& interface, const std::vector<int>& hidden,
                                 std::uint64_t seed = 1) {
  Random random(seed);
  const auto uniform = [&random](double most) {
    return [&random, most] { return random.uniform(-most, most); };
  };
  MlpNetwork network;
  auto width = static_cast<Eigen::Index>(interface.observation.size());
  network.observation_mean = Eigen::VectorXd::NullaryExpr(width, uniform(1));
  network.observation_std = Eigen::VectorXd::NullaryExpr(width, uniform(0.5)).array() + 1;
  network.observation_clip = 10;
  std::vector<int> sizes = hidden;
  sizes.push_back(static_cast<int>(interface.action.size()));
  for (const int size : sizes) {
    const double most = std::sqrt(3 / static_cast<double>(width));
    network.layers.push_back({Eigen::MatrixXd::NullaryExpr(size, width, uniform(most)),
                              Eigen::VectorXd::NullaryExpr(size, uniform(0.1))});
    width = size;
  }
  network.layers.back().weight *= 0.2;  // actions well inside their limits
  return network;
}

}  // namespace crossgait::policy_tests
