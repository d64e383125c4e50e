// A trained network with everything needed to use it right: one safetensors file (docs/policies.md).
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "policy/policy.h"

namespace crossgait {

/// Names activations; kSwish is x / (1 + exp(-x)), also called SiLU; kSoftsign x / (1 + |x|).
enum class MlpActivation { kTanh, kElu, kRelu, kSwish, kSoftsign };
enum class MlpOutput { kLinear, kTanh };

/// Computes y = weight x + bias.
struct MlpLayer {
  Eigen::MatrixXd weight;  ///< [outputs, inputs]
  Eigen::VectorXd bias;
};

/// Applies normalisation, clip, then layers: `activation` after all but the last, `output` after the last.
struct MlpNetwork {
  std::vector<MlpLayer> layers;
  MlpActivation activation = MlpActivation::kTanh;
  MlpOutput output = MlpOutput::kLinear;
  Eigen::VectorXd observation_mean, observation_std;                  ///< both empty: not normalised
  double observation_clip = std::numeric_limits<double>::infinity();  ///< of the normalised observation

  /// Runs in double precision for any layout: slow, plain, and independent of MlpPolicy, which it checks.
  Eigen::VectorXd evaluate(const Eigen::VectorXd& observation) const;
};

struct PolicyBundle {
  MlpNetwork network;
  std::vector<std::string> observation_names, action_names;
  std::string layout_hash;
  std::optional<double> policy_dt;  ///< s, if it was trained for one
  /// Pairs, one per row, by which a reader of the file proves that it computes what its writer did.
  Eigen::MatrixXd golden_observation, golden_action;
};

/// @throws ConfigError unless everything is there, of matching shapes and finite, with std > 0, and the
/// bundle was trained for this `kLayoutVersion`
PolicyBundle read_policy_bundle(const std::string& path);

/// @throws ConfigError saying in which entry the layouts differ, unless the bundle is for this interface
void check_interface(const PolicyBundle& bundle, const PolicyInterface& interface, const std::string& path);

/// @param path  what stands for the file in messages
/// @throws ConfigError unless there are layers, of which each takes what the one before gives and the first
/// `inputs` numbers, as the normalisation does, if there is one
void check_layers(const std::string& path, const MlpNetwork& network, Eigen::Index inputs);

/// Makes a network for `interface`, its weights and biases rounded to single precision as a file holds them,
/// with golden pairs of its own choice.
/// @param source  what stands for the file in messages
/// @throws ConfigError if the network does not fit the interface or is not finite
PolicyBundle make_policy_bundle(const MlpNetwork& network, const PolicyInterface& interface,
                                const std::string& source);

/// Returns `bundle` with other golden pairs: raw observations, and the actions of whoever made the network.
/// @throws ConfigError unless they are finite, 1 to `kMaxGoldenPairs` rows of the bundle's sizes
PolicyBundle with_golden_pairs(PolicyBundle bundle, const Eigen::MatrixXd& observation,
                               const Eigen::MatrixXd& action, const std::string& source);

/// @throws ConfigError if the place cannot be written
void write_policy_bundle(const std::string& path, const PolicyBundle& bundle);
/// Writes the bytes of `make_policy_bundle`.
void write_policy_bundle(const std::string& path, const MlpNetwork& network,
                         const PolicyInterface& interface);

}  // namespace crossgait
