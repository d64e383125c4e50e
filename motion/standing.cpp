#include "motion/standing.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "ik/leg_kinematics.h"
#include "physics/core/error.h"
#include "physics/robot/multibody.h"

namespace crossgait {
namespace {

// So that the first touch-down does not hang on the rounding of a distance of exactly zero.
constexpr double kClearance = 1e-4;  // m

// The highest ground that a foot at (x, y) could rest on.
double ground_below(const Terrain& terrain, double x, double y, double radius) {
  double highest = -std::numeric_limits<double>::infinity();
  for (const double dx : {-radius, 0.0, radius}) {
    for (const double dy : {-radius, 0.0, radius})
      highest = std::max(highest, terrain.height(x + dx, y + dy));
  }
  return highest;
}

}  // namespace

RobotState standing_on(const Terrain& terrain, const Placement& placement, const RobotDescription& robot,
                       const JointVector& q) {
  RobotState state;
  state.p_WB = {placement.x, placement.y, 0};
  state.q_WB = from_roll_pitch_yaw(placement.roll, placement.pitch, placement.yaw);
  state.q = q;
  state.qd = JointVector::Zero(robot.joint_count());
  std::vector<Pose> poses;
  forward_kinematics(robot, state, poses);
  double height = -std::numeric_limits<double>::infinity();
  for (const Leg leg : kLegs) {
    const Vector3 foot = foot_position(robot, leg, poses);
    const double radius = (*robot.legs)[leg].foot_radius;
    height = std::max(height, ground_below(terrain, foot.x(), foot.y(), radius) + radius - foot.z());
  }
  state.p_WB.z() = height + kClearance;
  return state;
}

JointVector with_legs_closed(const RobotDescription& robot, JointVector q, std::string_view element) {
  for (const Leg leg : kLegs) {
    const LegKinematics kinematics = make_leg_kinematics(robot, leg);
    if (kinematics.passive_count() == 0) continue;
    ServoVector servos(kinematics.servo_count());
    for (Eigen::Index k = 0; k < servos.size(); ++k)
      servos[k] = q[kinematics.servo_joints()[static_cast<std::size_t>(k)]];
    const LegForward forward = kinematics.forward(servos);
    if (!forward.closed)
      throw ConfigError(robot.source, fmt::format("{} of {}", element, name(leg)),
                        "angles at which the chains of the leg meet", "others");
    for (Eigen::Index k = 0; k < forward.passive.size(); ++k)
      q[kinematics.passive_joints()[static_cast<std::size_t>(k)]] = forward.passive[k];
  }
  return q;
}

}  // namespace crossgait
