#include "ik/leg_kinematics.h"

#include <algorithm>

#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait {

std::string_view name(LegKind kind) noexcept {
  constexpr std::array<std::string_view, 4> kNames{"five_bar", "serial", "least_squares", "closed_chain"};
  return kNames[static_cast<std::size_t>(kind)];
}

LegKinematics::LegKinematics(const FiveBarGeometry& geometry, const LegModel& model, LegBranch home)
    : leg_(geometry), home_(home), servo_count_(geometry.has_tilt ? 3 : 2), passive_count_(2) {
  const std::vector<int> joints = model.joints();
  std::copy_n(joints.begin(), std::min(joints.size(), joints_.size()), joints_.begin());
}

LegKinematics::LegKinematics(const ClosedChainGeometry& geometry, const LegModel& model, LegBranch home)
    : leg_(std::make_shared<const ClosedChainGeometry>(geometry)),
      home_(home),
      servo_count_(geometry.chain.servo_count()),
      passive_count_(geometry.chain.passive_count()) {
  std::ranges::copy(model.joints(), joints_.begin());
}

LegKinematics::LegKinematics(const Kind& kind, const SerialLegJoints& joints, LegBranch home)
    : leg_(kind), home_(home) {
  const SerialChain chain = chain_of(joints);
  servo_count_ = chain.servos;
  passive_count_ = chain.count - chain.servos;
  std::copy_n(chain.joints.begin(), chain.count, joints_.begin());
}

namespace {

LegBranch five_bar_branch(const RobotDescription& robot, const LegModel& model,
                          const FiveBarGeometry& geometry) {
  if (robot.home.size() != robot.joint_count()) return {};
  const auto angle = [&](const char* role) { return robot.home[model.joint(role)]; };
  return {.mode = working_mode_of(geometry,
                                  {geometry.has_tilt ? angle("tilt") : 0, angle("shoulder_left"),
                                   angle("shoulder_right"), angle("elbow_left"), angle("elbow_right")})};
}

}  // namespace

LegKinematics make_leg_kinematics(const RobotDescription& robot, Leg leg) {
  if (!robot.legs) throw ConfigError(robot.source, "legs", "a robot with four legs", "none");
  const LegModel& model = (*robot.legs)[leg];
  if (model.linkage == LegLinkage::kFiveBar) {
    const FiveBarGeometry geometry = five_bar_geometry(robot, leg);
    return {geometry, model, five_bar_branch(robot, model, geometry)};
  }
  if (model.linkage == LegLinkage::kClosedChain) {
    const ClosedChainGeometry geometry = closed_chain_geometry(robot, leg);
    return {geometry, model, {.knee = closed_chain_knee(geometry)}};
  }
  return make_leg_kinematics(robot, leg, serial_leg_joints(model));
}

LegKinematics make_leg_kinematics(const RobotDescription& robot, Leg leg, const SerialLegJoints& joints) {
  const auto branch = [](double bend) {
    return LegBranch{.knee = bend > 0 ? KneeBranch::kForward : KneeBranch::kBackward};
  };
  const bool has_home = robot.home.size() == robot.joint_count();
  if (is_serial_leg(robot, leg, joints)) {
    const SerialLegGeometry geometry = serial_leg_geometry(robot, leg, joints);
    return {geometry, joints, has_home ? branch(knee_bend(geometry, robot.home[joints.knee])) : LegBranch()};
  }
  if (!has_home) {
    throw ConfigError(robot.source, "home", fmt::format("{} joint angles", robot.joint_count()),
                      fmt::format("{}", robot.home.size()));
  }
  LegJointAngles home = LegJointAngles::Zero();
  const SerialChain chain = chain_of(joints);
  for (int i = 0; i < chain.servos; ++i) home[i] = robot.home[chain.joints[static_cast<std::size_t>(i)]];
  const LeastSquaresLegGeometry geometry = least_squares_leg_geometry(robot, leg, joints, home);
  return {geometry, joints, branch(knee_bend(geometry, home))};
}

LegArray<LegKinematics> make_leg_kinematics(const RobotDescription& robot) {
  const auto of = [&robot](Leg leg) { return make_leg_kinematics(robot, leg); };
  return {{of(Leg::FL), of(Leg::FR), of(Leg::RL), of(Leg::RR)}};
}

LegArray<Vector3> leg_origins(const LegArray<LegKinematics>& legs) {
  LegArray<Vector3> origins;
  for (const Leg leg : kLegs) origins[leg] = legs[leg].origin();
  return origins;
}

LegArray<Vector3> leg_origins(const RobotDescription& robot) {
  return leg_origins(make_leg_kinematics(robot));
}

}  // namespace crossgait
