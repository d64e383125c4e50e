// Whether a leg can follow a gait for a whole cycle, and which parameter is to blame if not.
#pragma once

#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "gait/gait_generator.h"

namespace crossgait {

/// Tells whether a leg can put its foot on a target of its leg frame (z up, m): a question for kinematics,
/// which gaits know nothing of.
using TargetCheck = std::function<bool(Leg leg, const Vector3& target)>;

struct CycleCheck {
  int targets = 0;      ///< looked at
  int unreachable = 0;  ///< of these
  /// Describes the first unreachable one.
  struct Failure {
    Leg leg = Leg::FL;
    double phase = 0;  ///< of the clock
    Vector3 target = Vector3::Zero();
  };
  std::optional<Failure> first;
  /// Names of the parameters to blame, worst first: returned to their preferred values (GaitParameters of the
  /// gait) one after the other, each time the one that helps most, until the cycle is reachable. If even the
  /// preferred parameters are not, all that differ are listed.
  std::vector<std::string_view> offending;

  bool ok() const { return unreachable == 0; }
};

/// Walks one cycle of `gait` in full stride and asks `check` about every target.
/// @param samples  per cycle, at least 2
/// @throws ConfigError if gait or parameters are not valid or samples is too small
CycleCheck check_cycle(const Gait& gait, const GaitParameters& parameters, const TargetCheck& check,
                       int samples = 400);

/// Finds step limits of `gait`: the longest steps along x and along y whose cycles are reachable, then both
/// shrunk alike until the steps in 16 directions are.
/// @throws ConfigError naming the first unreachable target if not even stepping on the spot is, and as
/// check_cycle
StepLimits reachable_steps(const Gait& gait, const GaitParameters& parameters, const TargetCheck& check,
                           int samples = 400);

}  // namespace crossgait
