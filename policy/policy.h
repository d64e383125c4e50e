// From observations to actions.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "gait/parameters.h"
#include "policy/layout.h"

namespace crossgait {

/// Describes what a policy runs on: the layouts of an environment and its pace.
struct PolicyInterface {
  Layout observation, action;
  double policy_dt = 2e-3;           ///< s between two actions
  AdaptationRanges adaptation = {};  ///< what the numbers of parameters and deltas mean, beside the table
};

/// Acts for one environment at a time with each instance: it may remember what happened since `reset`.
class Policy {
 public:
  virtual ~Policy() = default;
  Policy(const Policy&) = delete;
  Policy& operator=(const Policy&) = delete;
  Policy(Policy&&) = delete;
  Policy& operator=(Policy&&) = delete;

  /// Begins an episode. @param seed  of whatever the policy draws
  void reset(std::uint64_t seed) noexcept;
  /// @param observation  of interface().observation.size(), raw as the environment gives it
  /// @param action       of interface().action.size(), written within its layout's bounds whatever the
  /// observation
  ///                     holds
  void act(std::span<const double> observation, std::span<double> action) noexcept;
  /// Tells whether it cannot act any more, as one whose own code has thrown: then its episode ends.
  virtual bool has_failed() const noexcept { return false; }

  /// Counts how often each entry of the action was beyond its bounds, and clipped, since `reset`.
  std::span<const std::int64_t> clipped() const noexcept { return clipped_; }

  const PolicyInterface& interface() const noexcept { return interface_; }
  /// Returns the policy's name in tables: "zero", "random", the file's name.
  const std::string& name() const noexcept { return name_; }

 protected:
  Policy(std::string name, PolicyInterface interface);

 private:
  virtual void do_reset(std::uint64_t seed) noexcept = 0;
  virtual void do_act(std::span<const double> observation, std::span<double> action) noexcept = 0;

  std::string name_;
  PolicyInterface interface_;
  std::vector<std::int64_t> clipped_;
};

/// Makes instances of one policy, which differ in nothing but their state. Reads no file, and may be called
/// from several threads. @throws ConfigError for an interface of another layout, saying what differs
using PolicyFactory = std::function<std::unique_ptr<Policy>(const PolicyInterface&)>;

/// Reads `zero`, `random`, a name of `policy_names()`, a folder (`find_policy_file`), a policy bundle
/// (FILE.safetensors) or a policy description (FILE.yaml: scripted, hierarchical or onnx; docs/policies.md),
/// and every file that it names, so that all instances are of the same bytes.
/// @throws ConfigError for an unknown name, a file that is no policy, or one of another layout version
PolicyFactory load_policy(const std::string& text);

/// Makes one instance of a policy. @throws ConfigError as both do
std::unique_ptr<Policy> make_policy(const std::string& text, const PolicyInterface& interface);

}  // namespace crossgait
