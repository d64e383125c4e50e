// A policy that follows a timetable.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "crossgait/env/policy.h"

namespace crossgait {

class YamlValue;

/// One entry of an action over one step of the timetable.
struct ScriptedEntry {
  std::size_t action;  ///< index in the action
  /// Constant part of the entry; where `gain` is not zero, the observation that makes the entry
  /// `constant + gain * value`.
  double constant = 0;
  double gain = 0;
  std::size_t observation = 0;
};

/// Holds from `first_act` until the next step takes over; entries of the action that are not named are zero.
struct ScriptedStep {
  std::int64_t first_act = 0;
  std::vector<ScriptedEntry> entries;
};

class ScriptedPolicy final : public Policy {
 public:
  /// @param steps  each later than the one before, with indices inside the layouts
  ScriptedPolicy(std::string name, PolicyInterface interface, std::vector<ScriptedStep> steps);

 private:
  void do_reset(std::uint64_t seed) noexcept override;
  void do_act(std::span<const double> observation, std::span<double> action) noexcept override;

  std::vector<ScriptedStep> steps_;
  std::int64_t acts_ = 0;  // since reset
  std::size_t begun_ = 0;  // steps whose time has come
};

/// From a description of kind `scripted` (docs/policies.md).
/// @throws ConfigError for unknown keys and entries (naming the known ones), values out of range, times that
/// do not increase
std::unique_ptr<Policy> make_scripted_policy(const YamlValue& root, const PolicyInterface& interface);

}  // namespace crossgait
