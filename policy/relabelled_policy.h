// A policy's network where what its numbers mean is in question.
#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

#include "policy/policy.h"

namespace crossgait {

/// Holds a network that runs on any interface of its sizes.
struct RelabelledPolicy {
  PolicyFactory make;                                 ///< of an interface of its sizes
  std::optional<std::string> layout_hash;             ///< of what it states that it was made for
  std::optional<double> policy_dt;                    ///< s, the same
  Eigen::VectorXd observation_mean, observation_std;  ///< of its normaliser; empty where that is not known
};

/// Reads a bundle or a description of kind onnx; names, units and times that they state are not held against
/// the interface. Of all else that `make_policy` takes it makes what that makes. @throws ConfigError
RelabelledPolicy read_relabelled_policy(const std::string& text);

}  // namespace crossgait
