// Two descriptions of one robot held against each other.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "study/trial_walk.h"

namespace crossgait {

struct UnlikeQuantity {
  std::string of;  ///< "robot", "base", "contact", or a leg and role: "FL knee"
  std::string name, unit;
  double a = 0, b = 0;
};

struct RobotDifference {
  std::vector<UnlikeQuantity> unlike;
  std::size_t alike = 0;  ///< quantities that are the same
};

/// Compares masses, heights, contact, and leg by leg and role by role where joints and centres of mass are at
/// home (from the middle of the hips), axes, masses, moments, ranges, home, springs and every number
/// of the joints; feet by their radius. What joints and links are called, and which way an axis points, does
/// not matter. Alike is what differs by a hundredth of the larger or less, of places by one of the standing
/// height.
RobotDifference robot_difference(const RobotDescription& a, const RobotDescription& b);

/// Holds how far two descriptions lie apart in the speed at which they walk (over the commanded one), in the
/// engine where that is most, and how far engines do with one description, the one for which that is most.
struct WalkGaps {
  double descriptions = 0, engines = 0;
};
WalkGaps walk_gaps(const Trial& a, const Trial& b);

std::string describe(const RobotDifference& difference, const WalkGaps& gaps);
/// Writes `unlike` (lists of `of, name, unit, a, b`), `alike`, `gap_of_descriptions`, `gap_of_engines`.
nlohmann::ordered_json to_json(const RobotDifference& difference, const WalkGaps& gaps);

}  // namespace crossgait
