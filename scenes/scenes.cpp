#include "scenes/scenes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "physics/robot/multibody.h"

namespace crossgait::scenes {
namespace {

LegArray<Vector3> feet_at_home(const RobotDescription& robot, const LegArray<LegKinematics>& legs) {
  RobotState home;
  home.q = robot.home;
  std::vector<Pose> poses;
  forward_kinematics(robot, home, poses);
  LegArray<Vector3> feet;
  for (const Leg leg : kLegs) feet[leg] = foot_position(robot, leg, poses) - legs[leg].origin();
  return feet;
}

// Servos are in the order of the legs and their roles (load_robot).
JointTargets solve(const LegArray<LegKinematics>& legs, const LegArray<Vector3>& feet) noexcept {
  JointTargets targets;
  targets.q.resize(kLegCount * legs[Leg::FL].servo_count());
  Eigen::Index next = 0;
  for (const Leg leg : kLegs) {
    const ServoVector servos = legs[leg].inverse(feet[leg]).posture.servos;
    targets.q.segment(next, servos.size()) = servos;
    next += servos.size();
  }
  return targets;
}

// Of a leg's cycle, in [0, 1); the first half is swing.
double trot_phase(Leg leg, double time) noexcept {
  const bool first_pair = is_front(leg) == is_left(leg);
  const double phase = (time - Trot::kStand) / Trot::kCycle + (first_pair ? 0.0 : 0.5);
  return phase - std::floor(phase);
}

}  // namespace

WorldSpec world_of(RobotPtr robot) {
  WorldSpec spec;
  spec.robot = std::move(robot);
  return spec;
}

JointTargets home_targets(const RobotDescription& robot) {
  const std::vector<int> servos = robot.actuated_joints();
  JointTargets targets;
  targets.q.resize(static_cast<Eigen::Index>(servos.size()));
  for (std::size_t i = 0; i < servos.size(); ++i)
    targets.q[static_cast<Eigen::Index>(i)] = robot.home[servos[i]];
  return targets;
}

RobotState random_state(const RobotDescription& robot, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto vector = [&] {
    const double x = uniform(random), y = uniform(random);
    return Vector3(x, y, uniform(random));
  };
  RobotState state;
  state.p_WB = vector();
  state.q_WB = Quaternion(Eigen::AngleAxisd(std::numbers::pi * uniform(random), vector().normalized()));
  state.v_WB = vector();
  state.w_WB = 5 * vector();
  state.q = robot.home;
  state.qd = JointVector::Zero(robot.joint_count());
  for (int i = 0; i < robot.joint_count(); ++i) {
    state.q[i] = std::clamp(robot.home[i] + uniform(random), robot.joint(i).lower, robot.joint(i).upper);
    state.qd[i] = 5 * uniform(random);
  }
  return state;
}

bool identical(const RobotState& a, const RobotState& b) {
  return a.time == b.time && a.p_WB == b.p_WB && a.q_WB.coeffs() == b.q_WB.coeffs() && a.v_WB == b.v_WB &&
         a.w_WB == b.w_WB && a.q == b.q && a.qd == b.qd;
}

Trot::Trot(const RobotDescription& robot)
    : legs_(make_leg_kinematics(robot)), rest_(feet_at_home(robot, legs_)) {}

bool Trot::swings(Leg leg, double time) noexcept { return time >= kStand && trot_phase(leg, time) < 0.5; }

JointTargets Trot::targets(double time) const noexcept {
  LegArray<Vector3> feet = rest_;
  if (time >= kStand) {
    const double ramp = std::min(1.0, (time - kStand) / kCycle);
    for (const Leg leg : kLegs) {
      const double phase = trot_phase(leg, time);
      if (phase < 0.5) {
        const double angle = 2 * std::numbers::pi * phase;
        feet[leg].x() -= ramp * kStepLength / 2 * std::cos(angle);
        feet[leg].z() += ramp * kStepHeight * std::sin(angle);
      } else {
        feet[leg].x() += ramp * kStepLength * (1.5 - 2 * phase);
      }
    }
  }
  return solve(legs_, feet);
}

Swing::Swing(const RobotDescription& robot)
    : legs_(make_leg_kinematics(robot)), rest_(feet_at_home(robot, legs_)) {}

JointTargets Swing::targets(double time) const noexcept {
  LegArray<Vector3> feet = rest_;
  for (const Leg leg : kLegs) {
    const double turn = 2 * std::numbers::pi * time;
    const auto shift = static_cast<double>(leg);
    feet[leg] += Vector3(0.015 * std::sin(1.5 * turn + shift), 0.012 * std::sin(turn + shift),
                         -0.008 * std::sin(2 * turn + 0.5 * shift));
  }
  return solve(legs_, feet);
}

}  // namespace crossgait::scenes
