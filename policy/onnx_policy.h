// A network of any kind as a policy, with or without memory.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "policy/onnx_network.h"
#include "policy/policy.h"

namespace crossgait {

class YamlValue;

/// Says what the inputs and outputs of a network are.
struct OnnxPolicyPorts {
  std::string observation, action;
  /// Input and output: what an output holds after an action is its input's before the next, and zero before
  /// the first.
  std::vector<std::pair<std::string, std::string>> memory;
};

/// Computes in single precision in ONNX Runtime, on one thread. Where it cannot, or the observation is not
/// finite, the action is zero and the memory stays as it was. Unlike other policies it allocates: inside ONNX
/// Runtime.
class OnnxPolicy final : public Policy {
 public:
  /// @param source  what stands for the file in messages, and whose last part is the policy's name
  /// @throws ConfigError unless every input and output is one of `ports`, of the interface's sizes, and the
  /// network can be computed
  OnnxPolicy(std::shared_ptr<const OnnxNetwork> network, const OnnxPolicyPorts& ports,
             const std::string& source, const PolicyInterface& interface);

 private:
  void do_reset(std::uint64_t seed) noexcept override;
  void do_act(std::span<const double> observation, std::span<double> action) noexcept override;

  OnnxRun run_;
  std::size_t observation_ = 0, action_ = 0;
  std::vector<std::pair<std::size_t, std::size_t>> memory_;  // input and output
};

/// Takes a description of kind `onnx` and reads its network (docs/policies.md). @throws ConfigError
PolicyFactory load_onnx_policy(const YamlValue& root);
/// Loads the same network for any interface of its sizes: what the description says of layout and time
/// between two actions is not asked.
PolicyFactory load_relabelled_onnx_policy(const YamlValue& root);

}  // namespace crossgait
