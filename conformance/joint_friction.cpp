// Dry friction in joints: what it takes from motions that are known in closed form, and that it holds.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "conformance/topics.h"
#include "physics/robot/multibody.h"

namespace crossgait::conformance {
namespace {

using scenes::ArmLink;

constexpr double kFriction = 0.05;  // N m, a tenth of the pendulum's weight at its length

const Vector3 kDown(0, 0, -kGravity);

double weight_torque(const ArmLink& link) { return link.mass * kGravity * link.length; }

/// Where a pendulum let go at `from` is at rest next: m g l (cos to - cos from) = friction |to - from|.
double next_rest(const ArmLink& link, double from) {
  const double side = std::copysign(1.0, from), start = std::abs(from);
  const auto energy = [&](double to) {
    return weight_torque(link) * (std::cos(to) - std::cos(start)) - link.friction * (start - to);
  };
  double moving = std::asin(link.friction / weight_torque(link)), beyond = -start;  // fastest; never reached
  for (int i = 0; i < 60; ++i) {
    const double middle = (moving + beyond) / 2;
    (energy(middle) > 0 ? moving : beyond) = middle;
  }
  return side * moving;
}

/// How far it moves in a second, rad.
double creep(PhysicsBackend& world) {
  const double before = world.state().q[0];
  advance(world, {}, 1000);
  return std::abs(world.state().q[0] - before);
}

std::vector<double> friction_pendulum(const Subject& subject) {
  const ArmLink link{.friction = kFriction};
  double from = 1.2, worst = 0;
  const auto world = swinging_arm(subject, link, kDown, from);
  int swings = 0;
  for (; weight_torque(link) * std::abs(std::sin(from)) > kFriction; ++swings) {
    if (swings == 20) throw std::runtime_error("the pendulum does not come to rest");
    const double expected = next_rest(link, from), direction = std::copysign(1.0, expected - from);
    advance(*world, {}, 10);  // it is under way
    for (int i = 0; direction * world->state().qd[0] > soft_creep(link, kFriction); ++i) {
      if (i == 10000) throw std::runtime_error("the pendulum does not turn");
      advance(*world, {});
    }
    worst = std::max(worst, std::abs(world->state().q[0] / expected - 1));
    from = expected;
  }
  const double held = weight_torque(link) * std::abs(std::sin(world->state().q[0]));
  return {worst, static_cast<double>(swings), creep(*world) / soft_creep(link, held)};
}

std::vector<double> coasting(const Subject& subject) {
  const ArmLink link{.armature = 1e-3, .friction = kFriction};
  const auto world = swinging_arm(subject, link, Vector3::Zero(), 0, 2);
  const double deceleration = kFriction / link.joint_inertia();  // 3.2 rad/s^2
  double speed = 0;
  for (int i = 1; i <= 500; ++i) {
    advance(*world, {});
    speed = std::max(speed, std::abs(world->state().qd[0] - (2 - deceleration * i * 1e-3)));
  }
  advance(*world, {}, 500);
  const double way = std::abs(world->state().q[0] - 2 * 2 / (2 * deceleration));
  return {speed, way, creep(*world)};
}

std::vector<double> holding(const Subject& subject) {
  const ArmLink link{.friction = kFriction};
  double worst = 0;
  for (const double share : {0.1, 0.5, 0.95}) {
    const auto world = swinging_arm(subject, link, kDown, std::asin(share * kFriction / weight_torque(link)));
    worst = std::max(worst, creep(*world) / soft_creep(link, share * kFriction));
  }
  // A tenth of the friction above it: the mean of ten steps is of (n + 1) h / 2, and the angle has changed
  // little.
  const auto moving = swinging_arm(subject, link, kDown, std::asin(1.1 * kFriction / weight_torque(link)));
  advance(*moving, {}, 10);
  return {worst, -moving->state().qd[0] / (0.1 * kFriction / link.joint_inertia() * 0.01)};
}

std::vector<double> reported(const Subject& subject) {
  RobotDescription changed = *scenes::quadruped();
  changed.bodies[3].joint.friction = 0.02;
  changed.bodies[20].joint.friction = 0.01;
  const auto world = subject.make(std::make_shared<const RobotDescription>(changed));
  JointVector expected = JointVector::Zero(changed.joint_count());
  expected[2] = 0.02;
  expected[19] = 0.01;
  const JointVector friction = world->joint_friction();
  return {friction.size() == expected.size() ? relative_difference(friction, expected) : HUGE_VAL};
}

std::vector<double> stays_still(const Subject& subject) {
  const scenes::RobotPtr robot = scenes::with_joint_friction(scenes::quadruped(), 0.05);
  const auto world = subject.make(robot);
  const JointTargets targets = scenes::home_targets(*robot);
  advance(*world, targets, 1000);
  const RobotState before = world->state();
  advance(*world, targets, 1000);
  const Softness& soft = robot->friction_softness;
  const double damping = 2 / (soft.impedance_max * soft.time_constant);
  const double weight = joint_inverse_weights(*robot, false).maxCoeff();
  const double allowed = 0.05 * (1 - soft.impedance_min) / soft.impedance_min * weight / damping;
  return {(world->state().q - before.q).cwiseAbs().maxCoeff() / allowed};
}

}  // namespace

std::vector<Check> joint_friction_checks() {
  const Precondition precondition = has_law<&Laws::joint_friction>("joint_friction");
  const std::string creeps = "of the soft law: R f / B; hard friction does not give way";
  return {
      {"joint_friction_pendulum",
       "Friction takes its torque times the way: a pendulum turns and stops where its energy says",
       {at_most(0.01, "angles of rest, off, relative", "",
                "turns are seen to a step, (w h)^2 / 2 of their angle, and more of the small last one"),
        at_least(4, "swings", "", "it is watched until it stops"),
        at_most(1.01, "creeps once stopped, over what the law allows", "",
                creeps + "; the torque falls on the way")},
       friction_pendulum,
       precondition},
      {"joint_friction_coasting",
       "A joint without load coasts to rest at constant deceleration",
       {with_rounding(at_most(1e-9, "speed, off", "rad/s", "solvers stop early; rounding of 500 steps"), 100),
        at_most(2e-3, "way, off", "rad", "v h / 2 ahead, and the way of MuJoCo's damper to its end"),
        at_most(1e-9, "creeps at rest", "rad", "nothing moves it; a damper's end is exponential")},
       coasting,
       precondition},
      {"joint_friction_holding",
       "Friction holds what is below it and gives way to what is above it",
       {at_most(1.001, "creeps in a second, over what the law allows", "", creeps),
        between(0.99, 1.01, "speed after ten steps of a tenth above, over the excess torque's", "",
                "the angle has changed little")},
       holding,
       precondition},
      {"joint_friction_reported",
       "joint_friction() is what the engine holds, joint by joint",
       {rounds_to(0.5, "off, relative", "", "the numbers next to them: half an eps")},
       reported,
       precondition},
      {"joint_friction_standing",
       "Friction keeps a standing robot still: solved along with loops and contacts",
       {at_most(1, "joints move in a second, over what the law allows", "",
                "no row of friction gives way faster, nor more than its bound")},
       stays_still,
       precondition},
  };
}

}  // namespace crossgait::conformance
