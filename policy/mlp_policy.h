// A trained multilayer perceptron as a policy.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "policy/policy.h"
#include "policy/policy_bundle.h"

namespace crossgait {

/// Computes in single precision, as networks are trained, without allocating. One observation gives one
/// action whatever came before. Where the observation, normalised and clipped, is not finite, the action is
/// zero.
class MlpPolicy final : public Policy {
 public:
  /// @param source  what stands for the file in messages, and whose last part is the policy's name
  /// @throws ConfigError if the bundle is for another interface, or does not reproduce its golden pairs
  MlpPolicy(const PolicyBundle& bundle, const std::string& source, const PolicyInterface& interface);

 private:
  struct Layer {
    Eigen::MatrixXf weight;
    Eigen::VectorXf bias, values;
  };

  void check_golden(const PolicyBundle& bundle, const std::string& path);
  void do_reset(std::uint64_t seed) noexcept override;
  void do_act(std::span<const double> observation, std::span<double> action) noexcept override;

  MlpActivation activation_;
  MlpOutput output_;
  Eigen::VectorXd mean_, std_;
  double clip_;
  Eigen::VectorXf input_;
  std::vector<Layer> layers_;
};

/// Reads a policy bundle. @throws ConfigError if it is none
PolicyFactory load_mlp_policy(const std::string& path);

}  // namespace crossgait
