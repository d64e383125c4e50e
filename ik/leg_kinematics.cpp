#include "crossgait/ik/leg_kinematics.h"

#include <fmt/format.h>

#include "crossgait/physics/error.h"

namespace crossgait {

std::string_view name(LegKind kind) noexcept {
  constexpr std::array<std::string_view, 3> kNames{"five_bar", "serial", "least_squares"};
  return kNames[static_cast<std::size_t>(kind)];
}

LegKinematics::LegKinematics(const Kind& kind, const SerialLegJoints& joints) : leg_(kind) {
  if (joints.abduction != -1) joints_[static_cast<std::size_t>(servo_count_++)] = joints.abduction;
  joints_[static_cast<std::size_t>(servo_count_++)] = joints.hip;
  joints_[static_cast<std::size_t>(servo_count_++)] = joints.knee;
}

LegKinematics make_leg_kinematics(const RobotDescription& robot, Leg leg) {
  const FiveBarGeometry geometry = five_bar_geometry(robot, leg);
  return {geometry, (*robot.legs)[leg]};
}

LegKinematics make_leg_kinematics(const RobotDescription& robot, Leg leg, const SerialLegJoints& joints) {
  if (is_serial_leg(robot, leg, joints)) return {serial_leg_geometry(robot, leg, joints), joints};
  if (robot.home.size() != robot.joint_count()) {
    throw ConfigError(robot.source, "home", fmt::format("{} joint angles", robot.joint_count()),
                      fmt::format("{}", robot.home.size()));
  }
  LegJointAngles home = LegJointAngles::Zero();
  Eigen::Index i = 0;
  if (joints.abduction != -1) home[i++] = robot.home[joints.abduction];
  home[i++] = robot.home[joints.hip];
  home[i] = robot.home[joints.knee];
  return {least_squares_leg_geometry(robot, leg, joints, home), joints};
}

}  // namespace crossgait
