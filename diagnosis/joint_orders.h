// Orders of joints that files mean without saying them.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "physics/robot/leg.h"
#include "physics/robot/robot.h"

namespace crossgait {

/// Says where a servo is: its leg, and which of that leg's it is, from the hip.
struct ServoPlace {
  std::string joint;
  Leg leg;
  int depth = 0;
};
/// Returns the place of every servo, in the robot's order. @throws ConfigError for a robot without legs
std::vector<ServoPlace> servo_places(const RobotDescription& robot);

/// Describes a rule that gives the servos of any quadruped an order.
struct JointOrder {
  enum class By { kLeg, kDepth, kFile };  ///< leg after leg; all hips first; as the robot's file
  std::string_view name;
  By by;
  std::array<Leg, 4> legs;  ///< one after the other
  bool legs_by_name;        ///< in the place of `legs`: sorted by the names of their first joints
  std::string_view holds_for;
};
/// Returns the conventions. A change of a rule in a later release is a row of its own.
std::span<const JointOrder> joint_orders();
/// Lists the servos' names in that order.
std::vector<std::string> joints_in_order(const JointOrder& order, const std::vector<ServoPlace>& servos);

}  // namespace crossgait
