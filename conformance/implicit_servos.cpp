// Servos whose torque hangs on how a step ends: against their own recursion, where explicit ones are
// unstable, at their torque limits, and under a standing robot.
#include <algorithm>
#include <cmath>
#include <utility>

#include "conformance/topics.h"

namespace crossgait::conformance {
namespace {

using scenes::ArmLink;

constexpr double kStep = 2e-3;  // s

/// An arm of one link without gravity, held by such a servo; both directions have torque limits of their own.
struct HeldArm {
  ArmLink link;
  double implicit_stiffness = 1, implicit_damping = 1, effort_negative = 0;

  std::unique_ptr<PhysicsBackend> make(const Subject& subject) const {
    RobotDescription robot = *scenes::arm({link});
    Joint& joint = robot.bodies[1].joint;
    joint.implicit_stiffness = implicit_stiffness;
    joint.implicit_damping = implicit_damping;
    joint.effort_negative = effort_negative;
    WorldSpec spec = scenes::world_of(std::make_shared<const RobotDescription>(robot));
    spec.fixed_base = true;
    spec.physics_dt = kStep;
    spec.gravity = Vector3::Zero();
    return subject.make(spec);
  }
};

// J (v' - v) = h (kp (goal - q - s h v') - kd ((1 - d) v + d v')).
double recursion_error(const Subject& subject, const HeldArm& arm, double goal) {
  const auto world = arm.make(subject);
  const double J = arm.link.joint_inertia(), kp = arm.link.kp, kd = arm.link.kd, h = kStep;
  const double s = arm.implicit_stiffness, d = arm.implicit_damping;
  double q = 0, v = 0, worst = 0;
  for (int i = 0; i < 200; ++i) {
    const double before = v;
    v = (J * v + h * (kp * (goal - q) - kd * (1 - d) * v)) / (J + h * h * s * kp + h * d * kd);
    q += h * v;
    advance(*world, target(goal));
    worst = std::max({worst, std::abs(world->state().q[0] - q) / goal,
                      std::abs(world->torques()[0] - J * (v - before) / h) / (kp * goal)});
  }
  return worst;
}

std::vector<double> implicit_recursion(const Subject& subject) {
  const ArmLink link{.armature = 4e-3, .servo = true, .kp = 20, .kd = 0.5, .effort_limit = 1000};
  return {recursion_error(subject, {link, 1, 1}, 0.3), recursion_error(subject, {link, 0, 1}, 0.3),
          recursion_error(subject, {link, 0.5, 0.5}, 0.3)};
}

// kp h^2 / J = 64 and kd h / J = 16 here: explicit ones throw the arm about from the first step on.
std::vector<double> stiff_servo(const Subject& subject) {
  const ArmLink link{.servo = true, .effort_limit = 1e6};
  HeldArm arm{link};
  arm.link.kp = 64 * link.joint_inertia() / (kStep * kStep);
  arm.link.kd = 16 * link.joint_inertia() / kStep;
  const auto world = arm.make(subject);
  double beyond = 0, last = 0, backwards = 0;
  for (int i = 0; i < 100; ++i) {
    advance(*world, target(0.3));
    const double q = world->state().q[0];
    beyond = std::max(beyond, q - 0.3);
    backwards = std::max(backwards, last - q);
    last = q;
  }
  return {std::abs(last - 0.3), beyond, backwards};
}

std::vector<double> implicit_limits(const Subject& subject) {
  HeldArm arm{{.servo = true, .kp = 50, .kd = 0.5, .effort_limit = 0.4}};
  arm.effort_negative = 0.3;
  const auto world = arm.make(subject);
  double torque = 0, speed = 0;
  for (const auto& [goal, tau] : {std::pair{1.0, 0.4}, {-1.0, -0.3}}) {
    world->reset();
    advance(*world, target(goal), 10);
    torque = std::max(torque, std::abs(world->torques()[0] / tau - 1));
    speed =
        std::max(speed, std::abs(world->state().qd[0] * arm.link.joint_inertia() / (tau * 10 * kStep) - 1));
  }
  return {torque, speed};
}

// A servo at its limit against dry friction, and one whose spring is weaker than it: the most that it moves
// in a second is what MuJoCo's law of friction gives way by, hard friction does not.
std::vector<double> implicit_friction(const Subject& subject) {
  constexpr double kFriction = 0.05, kEffort = 0.4;
  HeldArm arm{{.friction = kFriction, .servo = true, .kp = 20, .kd = 0.5, .effort_limit = kEffort}};
  const auto world = arm.make(subject);
  advance(*world, target(1), 10);
  const double J = arm.link.joint_inertia();
  const double speed = world->state().qd[0] * J / ((kEffort - kFriction) * 10 * kStep);
  world->reset();
  const double torque = kFriction / 2;
  advance(*world, target(torque / arm.link.kp), 500);
  return {std::abs(speed - 1), std::abs(world->state().q[0]) / soft_creep(arm.link, torque)};
}

// A robot whose joints give way by its weight over their stiffness and no more.
std::vector<double> implicit_stand(const Subject& subject) {
  const scenes::RobotPtr robot = scenes::with_implicit_servos(scenes::quadruped(), 100);
  const auto world = subject.make(robot);
  const JointTargets targets = scenes::home_targets(*robot);
  advance(*world, targets, 2000);
  const std::vector<int> servos = robot->actuated_joints();
  double sag = 0, balance = 0;
  for (std::size_t k = 0; k < servos.size(); ++k) {
    const double off = targets.q[static_cast<Eigen::Index>(k)] - world->state().q[servos[k]];
    const double kp = robot->joint(servos[k]).kp;
    sag = std::max(sag, kp * std::abs(off) / robot->joint(servos[k]).effort_limit);
    balance = std::max(balance, std::abs(kp * off - world->torques()[servos[k]]));
  }
  return {sag, balance / robot->joint(servos.front()).effort_limit};
}

}  // namespace

std::vector<Check> implicit_servo_checks() {
  const Precondition precondition = has_law<&Laws::implicit_servos>("implicit_servos");
  return {
      {"implicit_servo_recursion",
       "An implicit servo's torque is that of the angle and speed at which a step ends",
       {rounds_to(1e4, "angle or torque off, spring and damper, relative", "", "200 steps of rounding"),
        rounds_to(1e4, "the same, damper alone", "", "as above"),
        rounds_to(1e4, "the same, half of both", "", "as above")},
       implicit_recursion,
       {"Laws::implicit_servos, of whole steps",
        [](const Subject& subject) {
          const std::string& law = subject.engine.info.laws.implicit_servos;
          return !law.empty() && law.find("temporal") == std::string::npos;
        }}},
      {"implicit_servo_stiff",
       "Servos too stiff for explicit steps arrive and stay",
       {at_most(1e-4, "from the target after a fifth of a second", "rad", "kd / kp is 0.5 ms"),
        at_most(1e-6, "beyond the target on the way", "rad", "overdamped"),
        at_most(1e-6, "backwards on the way", "rad", "overdamped")},
       stiff_servo,
       precondition},
      {"implicit_servo_limits",
       "Their torque keeps to its limits, one for each direction",
       {with_rounding(at_most(1e-12, "torque off, relative", "", "it is the limit itself"), 10),
        with_rounding(at_most(1e-9, "speed after ten steps off, relative", "", "solvers stop early"), 1000)},
       implicit_limits,
       precondition},
      {"implicit_servo_friction",
       "Dry friction resists them, and holds what a spring of theirs does not overcome",
       {with_rounding(
            at_most(1e-9, "speed after ten steps at the limit off, relative", "", "solvers stop early"),
            1000),
        at_most(1.01, "creeps in a second, over what the law allows", "",
                "of the soft law: R f / B; hard friction does not give way")},
       implicit_friction,
       {"Laws::implicit_servos and Laws::joint_friction",
        [](const Subject& subject) {
          const Laws& laws = subject.engine.info.laws;
          return !laws.implicit_servos.empty() && !laws.joint_friction.empty();
        }}},
      {"implicit_servo_standing",
       "A robot stands on them: solved along with loops and contacts",
       {at_most(0.6, "largest torque of a spring, over the servo's limit", "", "its weight takes less"),
        with_rounding(at_most(1e-3, "that torque off the one that is reported, over the limit", "",
                              "it has come to rest, but for rounding of speeds, a hundredfold damping times"),
                      1e5)},
       implicit_stand,
       precondition},
  };
}

}  // namespace crossgait::conformance
