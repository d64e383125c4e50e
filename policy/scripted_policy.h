// A policy that follows a timetable.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "policy/policy.h"

namespace crossgait {

class YamlValue;

/// Sets one entry of an action during one step of the timetable: constant + gain * observation.
struct ScriptedEntry {
  std::size_t action = 0;  ///< index in the action
  double constant = 0, gain = 0;
  std::size_t observation = 0;  ///< index in the observation, which is not looked at while `gain` is zero
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

/// Takes a description of kind `scripted` (docs/policies.md). What it makes
/// @throws ConfigError for unknown keys and entries (naming the known ones), values out of range, times that
/// do not increase
PolicyFactory load_scripted_policy(const YamlValue& root);

}  // namespace crossgait
