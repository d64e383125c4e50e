#include "crossgait/env/leg_controller.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "crossgait/physics/error.h"
#include "crossgait/physics/multibody.h"

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

LegController::LegController(const RobotDescription& robot, const ServoCompensation& compensation,
                             WorkingMode mode)
    : robot_(robot), compensation_(compensation), mode_(mode) {
  if (!robot.legs) throw ConfigError(robot.source, "legs", "four five-bar legs", "a robot without legs");
  const std::vector<int> actuated = robot.actuated_joints();
  for (const Leg leg : kLegs) {
    geometry_[leg] = five_bar_geometry(robot, leg);
    const LegModel& model = (*robot.legs)[leg];
    const std::array<int, 3> joints{model.tilt, model.shoulder_left, model.shoulder_right};
    LegServos& servos = servos_[leg];
    for (std::size_t k = 0; k < joints.size(); ++k) {
      const Joint& joint = robot.joint(joints[k]);
      const auto it = std::find(actuated.begin(), actuated.end(), joints[k]);
      if (it == actuated.end() || joint.kp <= 0) {
        throw ConfigError(robot.source, joint.name, "a servo with kp > 0 N m/rad", "none");
      }
      servos.slots[k] = it - actuated.begin();
      servos.stiffness[static_cast<Eigen::Index>(k)] = joint.kp;
      servos.damping[static_cast<Eigen::Index>(k)] = joint.kd + joint.damping;
    }
    servos.elbow_damping = robot.joint(model.elbow_left).damping;
  }
  // Actuated joints that belong to no leg hold their home angle.
  targets_.q.resize(static_cast<Eigen::Index>(actuated.size()));
  for (std::size_t k = 0; k < actuated.size(); ++k) {
    targets_.q[static_cast<Eigen::Index>(k)] = robot.home[actuated[k]];
  }
}

void LegController::restart() noexcept {
  moving_ = false;
  clamped_ = 0;
}

// How far the servos' targets lead the wanted angles, rad.
Vector3 LegController::lead(Leg leg, const Vector3& position, const LegAngles& angles,
                            double dt) const noexcept {
  const LegServos& servos = servos_[leg];
  const LastUpdate& last = last_[leg];
  const Vector3 wanted(angles.tilt, angles.shoulder_left, angles.shoulder_right);
  const Vector3 velocity = (position - last.position) / dt;
  const Vector3 rates = (wanted - last.servos) / dt;
  const Vector3 torque =
      elbow_drag_torque(geometry_[leg], position, angles, mode_, velocity, servos.elbow_damping) +
      servos.damping.cwiseProduct(rates);
  const double bound = compensation_.max_lead;
  return torque.cwiseQuotient(servos.stiffness).cwiseMax(-bound).cwiseMin(bound);
}

const JointTargets& LegController::update(const LegArray<Vector3>& feet, double dt) noexcept {
  for (const Leg leg : kLegs) {
    const LegSolution solution = solve_leg(geometry_[leg], feet[leg], mode_);
    status_[leg] = solution.status;
    if (solution.status != IkStatus::kOk) ++clamped_;
    const Vector3 wanted(solution.angles.tilt, solution.angles.shoulder_left, solution.angles.shoulder_right);
    Vector3 servo = wanted;
    if (compensation_.lag && moving_ && solution.status == IkStatus::kOk) {
      servo += lead(leg, feet[leg], solution.angles, dt);
    }
    last_[leg] = {feet[leg], wanted};
    for (std::size_t k = 0; k < 3; ++k) {
      targets_.q[servos_[leg].slots[k]] = servo[static_cast<Eigen::Index>(k)];
    }
  }
  moving_ = dt > 0;
  return targets_;
}

RobotState LegController::standing_state(const LegArray<Vector3>& feet, const Terrain& terrain) const {
  RobotState state;
  state.q = robot_.home;
  state.qd = JointVector::Zero(robot_.joint_count());
  for (const Leg leg : kLegs) {
    const LegSolution solution = solve_leg(geometry_[leg], feet[leg], mode_);
    if (solution.status != IkStatus::kOk) {
      throw ConfigError(robot_.source, fmt::format("foot {}", name(leg)), "a standing position within reach",
                        fmt::format("({:.4g}, {:.4g}, {:.4g}) m in the leg frame: {}", feet[leg].x(),
                                    feet[leg].y(), feet[leg].z(), name(solution.status)));
    }
    const LegModel& model = (*robot_.legs)[leg];
    state.q[model.tilt] = solution.angles.tilt;
    state.q[model.shoulder_left] = solution.angles.shoulder_left;
    state.q[model.shoulder_right] = solution.angles.shoulder_right;
    state.q[model.elbow_left] = solution.angles.elbow_left;
    state.q[model.elbow_right] = solution.angles.elbow_right;
  }
  std::vector<Pose> poses;
  forward_kinematics(robot_, state, poses);
  double height = -std::numeric_limits<double>::infinity();
  for (const Leg leg : kLegs) {
    const Vector3 foot = foot_position(robot_, leg, poses);
    const double radius = (*robot_.legs)[leg].foot_radius;
    height = std::max(height, ground_below(terrain, foot.x(), foot.y(), radius) + radius - foot.z());
  }
  state.p_WB.z() = height + kClearance;
  return state;
}

}  // namespace crossgait
