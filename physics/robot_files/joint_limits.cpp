#include "physics/robot_files/joint_limits.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "physics/robot/robot_check.h"

namespace crossgait {
namespace {

/// Beyond this a limit is a placeholder, rad; not beyond are those of whole turns, rounded.
constexpr double kLargestLimit = 2 * std::numbers::pi;
constexpr double kManyTurns = 20, kMostDegrees = 360;  // rad; degrees of one turn

}  // namespace

void set_limits(double lower, double upper, bool follows, std::string_view element, Joint& joint,
                ReaderWarnings& warnings) {
  const Joint unlimited;
  const bool are_meant = follows && lower < upper && lower >= -kLargestAngle && upper <= kLargestAngle;
  const double most = are_meant ? kLargestAngle : kLargestLimit;
  const bool low = lower<-most, high = upper> most;
  joint.lower = low ? unlimited.lower : lower;
  joint.upper = high ? unlimited.upper : upper;
  joint.limited = !(low && high);
  const double larger = std::max(std::abs(lower), std::abs(upper));
  if (std::isinf(larger)) {
    warnings.count("took +-pi rad for the one limit that is not given in ", " joint(s)", element);
  } else if (low || high) {
    const bool are_degrees = larger > kManyTurns && larger <= kMostDegrees;
    warnings.count(
        fmt::format("took limits beyond +-2 pi rad{} for +-pi in ", are_degrees ? ", likely degrees," : ""),
        " joint(s)", element);
  }
  if (joint.lower >= joint.upper && (low || high)) {
    joint.lower = unlimited.lower;
    joint.upper = unlimited.upper;
    joint.limited = false;
  } else if (joint.lower >= joint.upper) {
    joint.lower = unlimited.lower;
    joint.upper = unlimited.upper;
    joint.limited = false;
    warnings.count("took limits that are missing or not lower < upper for +-pi rad in ", " joint(s)",
                   element);
  }
}

void keep_velocity_limit(double limit, const std::string& joint, std::map<std::string, double>& limits) {
  constexpr double kPlaceholder = 1e9;  // kLargestGain's: beyond any number that a joint may have
  if (limit > 0 && limit < kPlaceholder) limits[joint] = limit;
}

}  // namespace crossgait
