// What the joints of a leg do, by their axes. Private to inference.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "physics/robot_files/inference/leg_tree.h"

namespace crossgait {

/// Describes the round thing that a joint without limits turns about its middle.
struct Wheel {
  Vector3 centre = Vector3::Zero();  ///< in its body's frame, m
  double radius = 0;                 ///< m
};

/// Finds the wheel that the body at `index` is: its joint turns without limits, and its shapes are round
/// about it, next to alike in all directions across. Nothing for any other body.
std::optional<Wheel> wheel_of(const ParsedRobot& robot, int index);

/// Names joints of a leg by the bodies that they move.
struct LegJoints {
  LegLinkage linkage = LegLinkage::kSerial;
  std::vector<int> servos;  ///< along the chain: abduction (if any), hip, knee; or hip, abduction, knee; or
                            ///< tilt (if any) and both shoulders
  std::vector<int>
      followers;          ///< a knee that follows, and the joint behind the knee that does; or both elbows
  std::vector<int> held;  ///< the others: wheels, ankles, a second joint of the hip
  std::vector<LegPart> parts;  ///< of a closed chain, what servos, then followers are: cranks and rods too

  int knee() const;
};

/// Makes a closed chain of these joints from base to foot, if a loop moves any of them or joins bars to them,
/// or if one with a servo is behind one that follows.
std::optional<LegJoints> closed_chain_of(const JointTree& tree,
                                         const std::vector<std::pair<LegPart, int>>& chain);

/// Finds hip and knee: the first two of the joints that are parallel (to 37 degrees): of several directions
/// that of most joints, of two such that of joints in a row. The abduction is what turns them aside: the
/// joint of another direction before the knee; of two that which turns least about the vertical of the hips,
/// `up`. The first joint behind the knee that follows another one moves along with it; behind a knee that
/// follows, the first one parallel to it moves the foot instead. Whatever else there is, is held. Where loops
/// move any of these it is a closed chain, and has their bars besides.
/// @returns nothing where no two joints are parallel, or more than two would be held
std::optional<LegJoints> roles_of(const JointTree& tree, const JointChain& chain, const Vector3& up);

}  // namespace crossgait
