// Coupled joints: two that are geared to one another move as one, lose no momentum, and give way as the
// coupling's softness says.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "conformance/topics.h"
#include "physics/robot/multibody.h"

namespace crossgait::conformance {
namespace {

using scenes::ArmLink;

constexpr double kRatio = 2;
constexpr ArmLink kLeader{.mass = 0.3, .armature = 1e-3}, kFollower{.mass = 0.1, .length = 0.1};

std::unique_ptr<PhysicsBackend> geared(const Subject& subject, const scenes::RobotPtr& robot,
                                       const Vector3& gravity, double angle, double speed) {
  WorldSpec spec = scenes::world_of(robot);
  spec.fixed_base = true;
  spec.gravity = gravity;
  auto world = subject.make(spec);
  RobotState start = world->home_state();
  start.q << angle, kRatio * angle;
  start.qd[0] = speed;
  world->reset(start);
  return world;
}

/// How far the follower is from where it was asked to be, rad.
double coupling_violation(const PhysicsBackend& world) {
  return std::abs(world.state().q[1] - kRatio * world.state().q[0]);
}

/// I1 + n^2 I2: what the leader moves.
double reduced_inertia() { return kLeader.joint_inertia() + kRatio * kRatio * kFollower.joint_inertia(); }

std::vector<double> geared_period(const Subject& subject) {
  const auto world = geared(subject, scenes::geared_pendulums(kLeader, kFollower, kRatio),
                            Vector3(0, 0, -kGravity), 0.01, 0);
  const double stiffness =
      kGravity * (kLeader.mass * kLeader.length + kRatio * kRatio * kFollower.mass * kFollower.length);
  const double period = 2 * M_PI * std::sqrt(reduced_inertia() / stiffness);
  // Times at which it comes through, seen to a small part of a step by a straight line between two.
  double before = world->state().q[0], first = 0, last = 0, largest = 0;
  int crossings = 0;
  for (int i = 0; i < 10000 && crossings < 9; ++i) {
    advance(*world, {});
    const double now = world->state().q[0];
    largest = std::max(largest, coupling_violation(*world));
    if ((before > 0) != (now > 0)) {
      last = world->state().time - world->spec().physics_dt * now / (now - before);
      if (crossings++ == 0) first = last;
    }
    before = now;
  }
  if (crossings < 9) throw std::runtime_error("the pendulums do not swing");
  return {std::abs((last - first) / 4 / period - 1), largest};
}

std::vector<double> geared_momentum(const Subject& subject) {
  const auto world =
      geared(subject, scenes::geared_pendulums(kLeader, kFollower, kRatio), Vector3::Zero(), 0, 1);
  const double leader = kLeader.joint_inertia(), follower = kFollower.joint_inertia();
  double drift = 0;
  for (int i = 0; i < 500; ++i) {
    advance(*world, {});
    const JointVector& qd = world->state().qd;
    drift = std::max(drift, std::abs((leader * qd[0] + kRatio * follower * qd[1]) / leader - 1));
  }
  const JointVector& qd = world->state().qd;
  return {drift, std::abs(qd[0] * reduced_inertia() / leader - 1), std::abs(qd[1] / qd[0] / kRatio - 1)};
}

/// A spring turns the follower, one holds the leader: at rest the coupling carries what the follower's pulls
/// with, R f = K imp r.
std::vector<double> geared_softness(const Subject& subject) {
  RobotDescription robot = *scenes::geared_pendulums(kLeader, kFollower, kRatio);
  for (const int i : {1, 2}) {
    Joint& joint = robot.bodies[static_cast<std::size_t>(i)].joint;
    joint.stiffness = 2;
    joint.damping = 0.02;
  }
  robot.bodies[2].joint.spring_reference = 0.3;
  const JointVector weights = joint_inverse_weights(robot, true);
  std::vector<double> values;
  for (const double time_constant : {0.005, 0.02}) {
    Softness& soft = robot.couplings.front().softness;
    soft.time_constant = time_constant;
    soft.impedance_max = soft.impedance_min;  // the same at every violation
    const auto world =
        geared(subject, std::make_shared<const RobotDescription>(robot), Vector3::Zero(), 0, 0);
    advance(*world, {}, 5000);
    const double imp = soft.impedance_min, torque = 2 * (0.3 - world->state().q[1]);
    const double expected = (1 - imp) / imp * weights.sum() * torque * std::pow(imp * time_constant, 2) / imp;
    values.push_back(coupling_violation(*world) / expected);
  }
  return values;
}

}  // namespace

std::vector<Check> coupling_checks() {
  const Precondition precondition = has_law<&Laws::couplings>("couplings");
  constexpr double kAngleOverStep =
      3000;  // roundings of angles up to 1.5 rad, half of one each, in steps of 1 ms
  const std::string rest = "R f = K imp r at rest; the engine's rounding of a small difference";
  return {
      {"coupled_pendulums",
       "Two pendulums geared 1 to 2 swing as one of inertia I1 + 4 I2",
       {at_most(1e-3, "period, off, relative", "", "amplitude^2 / 16, and what the row lets them be apart"),
        at_most(1e-4, "largest violation", "rad", "a hundredth of the amplitude")},
       geared_period,
       precondition},
      {"coupling_momentum",
       "A coupling takes from one joint what it gives to the other",
       {with_rounding(at_most(1e-12, "I1 w1 + n I2 w2, drift, relative", "", "forces are equal and opposite"),
                      1000),
        with_rounding(
            at_most(1e-6, "speed at which they turn together, off, relative", "",
                    "a damper's end is exponential; what holds angles has their rounding over a step"),
            kAngleOverStep),
        with_rounding(at_most(1e-6, "ratio of their speeds, off, relative", "", "likewise"), kAngleOverStep)},
       geared_momentum,
       precondition},
      {"coupling_softness",
       "A coupling gives way as its softness says, in MuJoCo's terms",
       {between(0.99, 1.01, "violation over the law's at 5 ms", "", rest),
        between(0.99, 1.01, "the same at 20 ms", "", rest)},
       geared_softness,
       {"Laws::couplings is \"mujoco\"",
        [](const Subject& subject) { return subject.engine.info.laws.couplings == "mujoco"; }}},
  };
}

}  // namespace crossgait::conformance
