#include "crossgait/env/leg_controller.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "crossgait/physics/error.h"
#include "crossgait/physics/multibody.h"
#include "crossgait/physics/world_spec.h"

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

LegController::LegController(std::shared_ptr<const RobotDescription> description,
                             const ServoCompensation& compensation, WorkingMode mode)
    : robot_(std::move(description)),
      compensation_(compensation),
      weight_(robot_->total_mass() * -WorldSpec{}.gravity.z()),
      mode_(mode) {
  const RobotDescription& robot = *robot_;
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

// Torques of the servos that the motion since the last update takes, N m, and those that hold up `load` (N).
Vector3 LegController::torque(Leg leg, const Vector3& position, const LegAngles& angles, double load,
                              double dt) const noexcept {
  const LegServos& servos = servos_[leg];
  const Matrix3 jacobian = leg_jacobian(geometry_[leg], angles);
  Vector3 torque = -load * jacobian.row(2).transpose();  // the foot pushes down
  if (compensation_.lag && moving_) {
    const LastUpdate& last = last_[leg];
    const Vector3 wanted(angles.tilt, angles.shoulder_left, angles.shoulder_right);
    const Vector3 drag = elbow_drag_force(geometry_[leg], position, mode_, (position - last.position) / dt,
                                          servos.elbow_damping);
    const Vector3 lag =
        jacobian.transpose() * drag + servos.damping.cwiseProduct((wanted - last.servos) / dt);
    const Vector3 bound = compensation_.max_lead * servos.stiffness;
    torque += lag.cwiseMax(-bound).cwiseMin(bound);
  }
  return torque.allFinite() ? torque : Vector3(Vector3::Zero());
}

const JointTargets& LegController::update(const LegArray<Vector3>& feet, double dt) noexcept {
  const LegArray<double> shares = load_shares(feet, compensation_.load_depth);
  const bool compensates = compensation_.lag || compensation_.load;
  for (const Leg leg : kLegs) {
    const LegSolution solution = solve_leg(geometry_[leg], feet[leg], mode_);
    status_[leg] = solution.status;
    if (solution.status != IkStatus::kOk) ++clamped_;
    const Vector3 wanted(solution.angles.tilt, solution.angles.shoulder_left, solution.angles.shoulder_right);
    Vector3 servo = wanted;
    if (compensates && solution.status == IkStatus::kOk) {
      const double load = compensation_.load ? load_share_ * weight_ * shares[leg] : 0;
      servo += torque(leg, feet[leg], solution.angles, load, dt).cwiseQuotient(servos_[leg].stiffness);
    }
    last_[leg] = {feet[leg], wanted};
    for (std::size_t k = 0; k < 3; ++k) {
      targets_.q[servos_[leg].slots[k]] = servo[static_cast<Eigen::Index>(k)];
    }
  }
  moving_ = dt > 0;
  return targets_;
}

// All joints of a leg, with its foot (leg frame, m) there.
void LegController::set_joints(Leg leg, const Vector3& foot, JointVector& q) const {
  const LegSolution solution = solve_leg(geometry_[leg], foot, mode_);
  if (solution.status != IkStatus::kOk) {
    throw ConfigError(robot_->source, fmt::format("foot {}", name(leg)), "a standing position within reach",
                      fmt::format("({:.4g}, {:.4g}, {:.4g}) m in the leg frame (z up): {}", foot.x(),
                                  foot.y(), foot.z(), name(solution.status)));
  }
  const LegModel& model = (*robot_->legs)[leg];
  q[model.tilt] = solution.angles.tilt;
  q[model.shoulder_left] = solution.angles.shoulder_left;
  q[model.shoulder_right] = solution.angles.shoulder_right;
  q[model.elbow_left] = solution.angles.elbow_left;
  q[model.elbow_right] = solution.angles.elbow_right;
}

// How far a foot gives way under `load` (N), against its servos, m.
Vector3 LegController::give(Leg leg, const Vector3& foot, double load) const noexcept {
  const Matrix3 jacobian = leg_jacobian(geometry_[leg], solve_leg(geometry_[leg], foot, mode_).angles);
  const Vector3 torque = load * jacobian.row(2).transpose();
  return jacobian * torque.cwiseQuotient(servos_[leg].stiffness);
}

Vector2 LegController::foot_sweep(const LegArray<Vector3>& feet, const GaitParameters& parameters) const {
  constexpr double kStep = 1e-4;  // m
  const double share = compensation_.load ? parameters.load_share : 0;
  const double load = (1 - share) * weight_ / (kLegCount * parameters.duty_factor);
  RobotState state;
  state.q = robot_->home;
  state.qd = JointVector::Zero(robot_->joint_count());
  std::vector<Pose> ahead, behind;
  Vector2 advance = Vector2::Zero();
  for (const int axis : {0, 1}) {
    const Vector3 way = kStep * Vector3::Unit(axis);
    for (const Leg leg : kLegs) set_joints(leg, feet[leg] + way, state.q);
    forward_kinematics(*robot_, state, ahead);
    for (const Leg leg : kLegs) set_joints(leg, feet[leg] - way, state.q);
    forward_kinematics(*robot_, state, behind);
    for (const Leg leg : kLegs) {
      const LegModel& model = (*robot_->legs)[leg];
      const auto link = static_cast<std::size_t>(model.foot_body);
      const Eigen::AngleAxisd turn(ahead[link].linear() * behind[link].linear().transpose());
      const Vector3 rolled = turn.angle() * turn.axis().cross(-model.foot_radius * Vector3::UnitZ());
      const Vector3 gave = give(leg, feet[leg] + way, load) - give(leg, feet[leg] - way, load);
      advance[axis] += (1 + (rolled[axis] + gave[axis]) / (2 * kStep)) / kLegCount;
    }
  }
  return advance.cwiseInverse();
}

RobotState LegController::standing_state(const LegArray<Vector3>& feet, const Terrain& terrain,
                                         const Placement& placement) const {
  RobotState state;
  state.p_WB = {placement.x, placement.y, 0};
  state.q_WB = from_roll_pitch_yaw(placement.roll, placement.pitch, placement.yaw);
  state.q = robot_->home;
  state.qd = JointVector::Zero(robot_->joint_count());
  for (const Leg leg : kLegs) set_joints(leg, feet[leg], state.q);
  std::vector<Pose> poses;
  forward_kinematics(*robot_, state, poses);
  double height = -std::numeric_limits<double>::infinity();
  for (const Leg leg : kLegs) {
    const Vector3 foot = foot_position(*robot_, leg, poses);
    const double radius = (*robot_->legs)[leg].foot_radius;
    height = std::max(height, ground_below(terrain, foot.x(), foot.y(), radius) + radius - foot.z());
  }
  state.p_WB.z() = height + kClearance;
  return state;
}

void solve_legs(LegController& legs, const LegArray<Vector3>& feet, double dt, ControlTargets& out) noexcept {
  const std::int64_t before = legs.clamped();
  out.joints = legs.update(feet, dt);
  out.ik_clamped = static_cast<int>(legs.clamped() - before);
}

}  // namespace crossgait
