#include "motion/foot_target_tracker.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "gait/scale.h"
#include "motion/standing.h"
#include "physics/core/error.h"
#include "physics/robot/multibody.h"

namespace crossgait {
namespace {

// Joints that turn slower change their direction, as far as dry friction is concerned.
constexpr double kSlow = 0.1;  // rad/s, of scara_quadruped

// Of a leg whose knee follows its hip: the foot moves on a surface, and is put where that has the depth and
// the distance aside that are asked for, by Newton's method from the nearest posture.
LegInverse solve_aside(const LegKinematics& kinematics, const std::array<JointLimits, 3>& limits,
                       const Vector3& foot) noexcept {
  constexpr int kIterations = 20;  // from the nearest posture about five are enough
  LegInverse nearest = kinematics.inverse(foot);
  if (nearest.status == IkStatus::kInvalidTarget) return nearest;
  LegInverse placed = nearest;
  for (int i = 0; i < kIterations; ++i) {
    const LegForward at = kinematics.forward(placed.posture.servos);
    if (!at.closed) break;
    placed.posture.passive = at.passive;
    const Vector2 off = (foot - at.foot).tail<2>();
    if (off.norm() < kConverged) {
      placed.status = IkStatus::kOk;
      return placed;
    }
    const Eigen::Matrix2d J = kinematics.jacobian(placed.posture).bottomRows<2>();
    if (std::abs(J.determinant()) < 1e-12) break;  // m^2/rad^2: the foot cannot be moved both ways
    placed.posture.servos += J.inverse() * off;
    for (int k = 0; k < 2; ++k) clamp_angle(placed.posture.servos[k], limits[static_cast<std::size_t>(k)]);
  }
  return nearest;
}

}  // namespace

double weight_per_mass(const WorldSpec& world) noexcept { return std::max(0.0, -world.gravity.z()); }

FootTargetTracker::FootTargetTracker(std::shared_ptr<const RobotDescription> description,
                                     const ServoCompensation& compensation, double gravity)
    : robot_(std::move(description)),
      compensation_(compensation),
      weight_(robot_->total_mass() * gravity),
      kinematics_(make_leg_kinematics(*robot_)) {
  const RobotDescription& robot = *robot_;
  compensation_.load_depth *= gait_scale(robot).length;
  const double slow = kSlow / gait_scale(robot).time();
  const std::vector<int> actuated = robot.actuated_joints();
  for (const Leg leg : kLegs) {
    const LegKinematics& kinematics = kinematics_[leg];
    LegServos& servos = servos_[leg];
    servos.count = kinematics.servo_count();
    for (std::size_t k = 0; k < kinematics.servo_joints().size(); ++k) {
      const int index = kinematics.servo_joints()[k];
      const Joint& joint = robot.joint(index);
      const auto it = std::find(actuated.begin(), actuated.end(), index);
      if (it == actuated.end() || joint.kp <= 0) {
        throw ConfigError(robot.source, joint.name, "a servo with kp > 0 N m/rad", "none");
      }
      servos.slots[k] = it - actuated.begin();
      servos.stiffness[static_cast<Eigen::Index>(k)] = joint.kp;
      servos.drag[k] = {joint.kd + joint.damping, joint.friction, slow};
      const auto* geometry = kinematics.as<LeastSquaresLegGeometry>();
      servos.limits[k] = geometry ? geometry->links[k].limits : JointLimits{joint.lower, joint.upper};
    }
    servos.is_on_surface = kinematics.servo_count() == 2 && (*robot.legs)[leg].joint("abduction") >= 0;
    if (kinematics.passive_count() > 0) {
      const Joint& elbow = robot.joint(kinematics.passive_joints()[0]);
      servos.passive_drag = {elbow.damping, elbow.friction, slow};
    }
  }
  // Actuated joints that belong to no leg hold their home angle.
  targets_.q.resize(static_cast<Eigen::Index>(actuated.size()));
  for (std::size_t k = 0; k < actuated.size(); ++k) {
    targets_.q[static_cast<Eigen::Index>(k)] = robot.home[actuated[k]];
  }
}

void FootTargetTracker::restart() noexcept {
  moving_ = false;
  clamped_ = 0;
}

LegInverse FootTargetTracker::solve(Leg leg, const Vector3& foot) const noexcept {
  const LegKinematics& kinematics = kinematics_[leg];
  if (kinematics.servo_count() == 3) return kinematics.inverse(foot);
  if (servos_[leg].is_on_surface) return solve_aside(kinematics, servos_[leg].limits, foot);
  return kinematics.inverse({foot.x(), 0, foot.z()});
}

// A five-bar's links say all of it, without the sines of its angles.
FootTargetTracker::Solution FootTargetTracker::follow(Leg leg, const Vector3& foot,
                                                      double dt) const noexcept {
  const LegKinematics& kinematics = kinematics_[leg];
  Solution s;
  const auto* five_bar = kinematics.as<FiveBarGeometry>();
  if (five_bar == nullptr) {
    const LegInverse inverse = solve(leg, foot);
    s.status = inverse.status;
    s.servos.head(inverse.posture.servos.size()) = inverse.posture.servos;
    if (compensates()) s.jacobian.leftCols(kinematics.servo_count()) = kinematics.jacobian(inverse.posture);
    return s;
  }
  const int count = kinematics.servo_count();
  const PlacedLeg placed =
      place_leg(*five_bar, {foot.x(), count == 3 ? foot.y() : 0, foot.z()}, kinematics.home_branch().mode);
  const ServoSolution found = servos_of(*five_bar, placed);
  s.status = found.status;
  s.servos = {found.angles.tilt, found.angles.shoulder_left, found.angles.shoulder_right};
  if (compensates()) s.jacobian = leg_jacobian(*five_bar, placed);
  if (count == 2) {  // without the tilt
    s.servos.head<2>() = Vector2(s.servos.tail<2>());
    s.jacobian.leftCols<2>() = Eigen::Matrix<double, 3, 2>(s.jacobian.rightCols<2>());
  }
  if (compensation_.lag && moving_)
    s.drag =
        elbow_drag_force(*five_bar, placed, (foot - last_[leg].position) / dt, servos_[leg].passive_drag);
  return s;
}

// Torques of the servos that the motion since the last update takes, N m, and those that hold up `load` (N).
Vector3 FootTargetTracker::torque(Leg leg, const Solution& at, double load, double dt) const noexcept {
  const LegServos& servos = servos_[leg];
  Vector3 torque = Vector3::Zero();
  for (Eigen::Index k = 0; k < servos.count; ++k) {
    torque[k] = -load * at.jacobian(2, k);  // the foot pushes down
    if (!compensation_.lag || !moving_) continue;
    const double rate = (at.servos[k] - last_[leg].servos[k]) / dt;
    const double lag =
        servos.drag[static_cast<std::size_t>(k)].torque(rate) + at.jacobian.col(k).dot(at.drag);
    const double bound = compensation_.max_lead * servos.stiffness[k];
    torque[k] += std::clamp(lag, -bound, bound);
  }
  return torque.allFinite() ? torque : Vector3(Vector3::Zero());
}

const JointTargets& FootTargetTracker::update(const LegArray<Vector3>& feet, double dt) noexcept {
  const LegArray<double> shares = load_shares(feet, compensation_.load_depth);
  for (const Leg leg : kLegs) {
    const Solution solution = follow(leg, feet[leg], dt);
    const LegServos& servos = servos_[leg];
    status_[leg] = solution.status;
    if (solution.status != IkStatus::kOk) ++clamped_;
    Vector3 servo = solution.servos;
    if (compensates() && solution.status == IkStatus::kOk) {
      const double load = compensation_.load ? load_share_ * weight_ * shares[leg] : 0;
      servo += torque(leg, solution, load, dt).cwiseQuotient(servos.stiffness);
    }
    last_[leg] = {feet[leg], solution.servos};
    for (Eigen::Index k = 0; k < servos.count; ++k)
      targets_.q[servos.slots[static_cast<std::size_t>(k)]] = servo[k];
  }
  moving_ = dt > 0;
  return targets_;
}

// All joints of a leg, with its foot (leg frame, m) there.
void FootTargetTracker::set_joints(Leg leg, const Vector3& foot, JointVector& q) const {
  const LegInverse solution = solve(leg, foot);
  if (solution.status != IkStatus::kOk) {
    throw ConfigError(robot_->source, fmt::format("foot {}", name(leg)), "a standing position within reach",
                      fmt::format("({:.4g}, {:.4g}, {:.4g}) m in the leg frame (z up): {}", foot.x(),
                                  foot.y(), foot.z(), name(solution.status)));
  }
  const LegKinematics& kinematics = kinematics_[leg];
  const LegPosture& posture = solution.posture;
  for (Eigen::Index k = 0; k < posture.servos.size(); ++k)
    q[kinematics.servo_joints()[static_cast<std::size_t>(k)]] = posture.servos[k];
  for (Eigen::Index k = 0; k < posture.passive.size(); ++k)
    q[kinematics.passive_joints()[static_cast<std::size_t>(k)]] = posture.passive[k];
}

// How far a foot gives way under `load` (N), against its servos, m.
Vector3 FootTargetTracker::compliance_deflection(Leg leg, const Vector3& foot, double load) const noexcept {
  const LegJacobian jacobian = kinematics_[leg].jacobian(solve(leg, foot).posture);
  const ServoVector torque = load * jacobian.row(2).transpose();
  return jacobian * torque.cwiseQuotient(servos_[leg].stiffness.head(torque.size()));
}

Vector2 FootTargetTracker::rolling_correction(const LegArray<Vector3>& feet,
                                              const GaitParameters& parameters) const {
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
      const Vector3 gave = compliance_deflection(leg, feet[leg] + way, load) -
                           compliance_deflection(leg, feet[leg] - way, load);
      advance[axis] += (1 + (rolled[axis] + gave[axis]) / (2 * kStep)) / kLegCount;
    }
  }
  return advance.cwiseInverse();
}

RobotState FootTargetTracker::standing_state(const LegArray<Vector3>& feet, const Terrain& terrain,
                                             const Placement& placement) const {
  JointVector q = robot_->home;
  for (const Leg leg : kLegs) set_joints(leg, feet[leg], q);
  return standing_on(terrain, placement, *robot_, q);
}

void solve_legs(FootTargetTracker& legs, const LegArray<Vector3>& feet, double dt,
                ControlTargets& out) noexcept {
  const std::int64_t before = legs.clamped();
  out.joints = legs.update(feet, dt);
  out.ik_clamped = static_cast<int>(legs.clamped() - before);
}

}  // namespace crossgait
