// Limits of joints: where they hold, how they stop what runs into them, and that other joints turn on.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "conformance/topics.h"

namespace crossgait::conformance {
namespace {

using scenes::ArmLink;

constexpr double kLimit = 0.5;  // rad

ArmLink limited_link() { return {.limit = kLimit, .limited = true}; }

/// How far beyond the limit MuJoCo's law lets a joint of this link alone rest under `torque`, rad: the spring
/// K imp r, through R = (1 - imp) / imp / inertia, carries it. Impedance rises with r.
double soft_rest(const ArmLink& link, double torque) {
  const Softness soft;
  const double stiffness = 1 / std::pow(soft.impedance_max * soft.time_constant * soft.damping_ratio, 2);
  double beyond = 0;
  for (int i = 0; i < 100; ++i) {  // contracts: the impedance changes by a twentieth
    const double x = std::min(beyond / soft.impedance_width, 1.0);
    const double share = x < 0.5 ? 2 * x * x : 1 - 2 * (1 - x) * (1 - x);
    const double imp = soft.impedance_min + share * (soft.impedance_max - soft.impedance_min);
    beyond = torque * (1 - imp) / imp / link.joint_inertia() / (stiffness * imp);
  }
  return beyond;
}

/// Gravity along x presses it against its lower limit.
std::vector<double> rest(const Subject& subject) {
  const ArmLink link = limited_link();
  const auto world = swinging_arm(subject, link, {kGravity, 0, 0}, -0.3, 0);
  advance(*world, {}, 2000);
  const double torque = link.mass * kGravity * link.length * std::cos(kLimit);
  const double beyond = -kLimit - world->state().q[0], before = world->state().q[0];
  advance(*world, {}, 1000);
  return {beyond / soft_rest(link, torque), std::max(-beyond, 0.0), std::abs(world->state().q[0] - before)};
}

/// Runs into the upper limit. MuJoCo's law: r'' = -(2 r' / T + r / T^2), critically damped, which only
/// pushes: r = v t exp(-t / T) is largest at T, v T / e, and the joint is let go where it would be pulled, at
/// 2 T with v / e^2.
std::vector<double> stop(const Subject& subject) {
  constexpr double kSpeed = 2;
  const auto world = swinging_arm(subject, limited_link(), Vector3::Zero(), 0, kSpeed);
  double furthest = 0, lowest = kSpeed;
  for (int i = 0; i < 500; ++i) {
    advance(*world, {});
    furthest = std::max(furthest, world->state().q[0]);
    lowest = std::min(lowest, world->state().qd[0]);
  }
  const double T = Softness().time_constant, e = std::numbers::e;
  const bool soft = subject.engine.info.laws.joint_limits == "mujoco";
  const double allowed = soft ? kSpeed * T / e : kSpeed * world->spec().physics_dt;
  return {(furthest - kLimit) / allowed, kLimit - furthest, -lowest / (kSpeed / (e * e))};
}

/// Begins far beyond.
std::vector<double> comes_back(const Subject& subject) {
  const auto world = swinging_arm(subject, limited_link(), Vector3::Zero(), kLimit + 0.1, 0);
  double fastest = 0;
  int steps = 0;
  for (; world->state().q[0] > kLimit + 1e-3 && steps < 1000; ++steps) {
    advance(*world, {});
    fastest = std::max(fastest, std::abs(world->state().qd[0]));
  }
  return {steps * 1e-3, fastest};
}

std::vector<double> unlimited(const Subject& subject) {
  ArmLink link = limited_link();
  link.limited = false;
  const auto world = swinging_arm(subject, link, Vector3::Zero(), 0, 2);
  advance(*world, {}, 1000);
  return {std::abs(world->state().q[0] - 2)};
}

std::vector<double> limits_reported(const Subject& subject) {
  RobotDescription changed = *scenes::quadruped();
  Joint& joint = changed.bodies[3].joint;
  joint.limited = true;
  joint.lower = changed.home[2] - 0.25;
  joint.upper = changed.home[2] + 0.125;
  const JointRanges expected = joint_limits(changed);
  const JointRanges found = subject.make(std::make_shared<const RobotDescription>(changed))->joint_limits();
  if (found.lower.size() != expected.lower.size()) return {HUGE_VAL};
  double worst = 0;
  for (Eigen::Index i = 0; i < expected.lower.size(); ++i) {
    for (const auto& [x, y] :
         {std::pair(found.lower[i], expected.lower[i]), {found.upper[i], expected.upper[i]}})
      if (x != y) worst = std::max(worst, std::abs(x / y - 1));
  }
  return {std::isnan(worst) ? HUGE_VAL : worst};
}

}  // namespace

std::vector<Check> joint_limit_checks() {
  const Precondition precondition = has_law<&Laws::joint_limits>("joint_limits");
  const std::string law = "of the soft law; a hard limit lets nothing beyond it";
  return {
      {"joint_limit_rest",
       "What presses a joint against its limit leaves it there",
       {at_most(1.001, "beyond the limit, over what the law allows", "", law),
        with_rounding(at_most(1e-9, "short of it", "rad", "nothing holds it before"), 10),
        with_rounding(at_most(1e-9, "moves in a second", "rad", "it is at rest; rounding of 1000 steps"),
                      1000)},
       rest,
       precondition},
      {"joint_limit_stop",
       "A limit stops what runs into it, and throws nothing back",
       {at_most(1.06, "beyond the limit, over v T / e of the soft law, v h of others", "",
                "its impedance is a twentieth less before the width of 1 mrad; a step of 20 to its peak"),
        at_most(2e-3, "short of it", "rad", "a step at 2 rad/s"),
        at_most(1.06, "speed of return, over v / e^2 of the soft law", "", "the same; hard limits: none")},
       stop,
       precondition},
      {"joint_limit_return",
       "A joint that begins beyond its limit is brought back, not thrown",
       {at_most(0.2, "within 1 mrad after", "s", "ten time constants of the soft law; 0.1 rad at 1 rad/s"),
        at_most(2, "fastest", "rad/s", "the soft law: 0.1 rad / (T e); a hard limit returns it at 1 rad/s")},
       comes_back,
       precondition},
      {"joint_limit_none",
       "A joint that is not limited turns on",
       {with_rounding(at_most(1e-9, "angle, off", "rad", "rounding of 1000 steps"), 1000)},
       unlimited,
       precondition},
      {"joint_limits_reported",
       "joint_limits() is what the engine holds, joint by joint",
       {rounds_to(0.5, "off, relative", "", "the numbers next to them: half an eps")},
       limits_reported,
       precondition},
  };
}

}  // namespace crossgait::conformance
