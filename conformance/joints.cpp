// Pendulums and servos on a fixed base: the tree's dynamics and what drives it, against textbook motion.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "conformance/topics.h"
#include "scenes/analytic.h"

namespace crossgait::conformance {
namespace {

using scenes::ArmLink;

double frequency_of(const ArmLink& link) {
  return std::sqrt(link.mass * kGravity * link.length / link.joint_inertia());
}

std::unique_ptr<PhysicsBackend> make_arm(const Subject& subject, const scenes::RobotPtr& robot,
                                         double h = 1e-3, double gravity = kGravity) {
  WorldSpec spec = scenes::world_of(robot);
  spec.fixed_base = true;
  spec.physics_dt = h;
  spec.gravity = {0, 0, -gravity};
  return subject.make(spec);
}

std::vector<double> small_swings(const Subject& subject) {
  const ArmLink link{.armature = 1e-3};
  const double w = frequency_of(link), h = 1e-3, amplitude = 1e-3;
  const double T = scenes::pendulum_period(subject.engine, link, amplitude, h, 5);
  // Semi-implicit Euler turns a harmonic oscillator by acos(1 - (w h)^2 / 2) per step; amplitude adds a^2
  // / 16.
  const double discrete =
      2 * std::numbers::pi * h / std::acos(1 - w * w * h * h / 2) * (1 + amplitude * amplitude / 16);
  const double continuous = 2 * std::numbers::pi / w;
  return {std::abs(T / discrete - 1), std::abs(T / continuous - 1) / (w * w * h * h)};
}

std::vector<double> large_swings(const Subject& subject) {
  const double coarse = scenes::pendulum_error(subject.engine, 4e-3);
  const double middle = scenes::pendulum_error(subject.engine, 2e-3);
  const double fine = scenes::pendulum_error(subject.engine, 1e-3);
  const double rounding = 100 * epsilon(subject.precision());  // of zero crossings
  return {std::abs(fine), convergence(middle, coarse, 0.25, rounding),
          convergence(fine, middle, 0.25, rounding)};
}

std::vector<double> armature(const Subject& subject) {
  const double plain = scenes::pendulum_period(subject.engine, {}, 1e-3, 1e-3, 3);
  const ArmLink heavy{.armature = 3 * ArmLink{}.joint_inertia()};
  return {std::abs(scenes::pendulum_period(subject.engine, heavy, 1e-3, 1e-3, 3) / plain - 2)};
}

// J (v' - v) = -h d ((1 - s) v + s v'), with a damper that an explicit step would let go through zero: h d >
// 2 J.
std::vector<double> damping_at_the_end(const Subject& subject) {
  std::vector<double> worst;
  for (const double share : {1.0, 0.5}) {
    const ArmLink link{.armature = 4e-3, .damping = share == 1 ? 45.0 : 1.0};
    RobotDescription robot = *scenes::arm({link});
    robot.bodies[1].joint.implicit_joint_damping = share;
    WorldSpec spec = scenes::world_of(std::make_shared<const RobotDescription>(robot));
    spec.fixed_base = true;
    spec.gravity = Vector3::Zero();
    const auto world = subject.make(spec);
    RobotState state = world->state();
    state.qd[0] = 1;
    world->reset(state);
    const double J = link.joint_inertia(), hd = spec.physics_dt * link.damping;
    double v = 1, q = state.q[0];
    worst.push_back(0);
    for (int i = 0; i < 100; ++i) {
      v *= (J - (1 - share) * hd) / (J + share * hd);
      q += spec.physics_dt * v;
      advance(*world, {});
      worst.back() =
          std::max({worst.back(), std::abs(world->state().qd[0] - v), std::abs(world->state().q[0] - q)});
    }
  }
  return worst;
}

std::vector<double> damping(const Subject& subject) {
  const ArmLink link{.damping = 0.02};
  const auto world = make_arm(subject, scenes::arm({link}));
  RobotState start = world->home_state();
  start.q[0] = 0.01;
  world->reset(start);
  const double a = link.damping / (2 * link.joint_inertia()), w = frequency_of(link);
  const double wd = std::sqrt(w * w - a * a);
  double worst = 0;
  for (int i = 0; i < 2000; ++i) {
    advance(*world, {});
    const double t = world->state().time;
    const double exact = 0.01 * std::exp(-a * t) * (std::cos(wd * t) + a / wd * std::sin(wd * t));
    worst = std::max(worst, std::abs(world->state().q[0] - exact));
  }
  return {worst / 0.01 / (w * 1e-3)};
}

/// Largest change of energy over two seconds of chaotic swinging, relative to the swing's potential energy.
double energy_drift(const Subject& subject, double h) {
  const ArmLink upper{}, lower{.mass = 0.1, .length = 0.15, .inertia = 1e-3, .armature = 5e-4};
  const auto world = make_arm(subject, scenes::arm({upper, lower}), h);
  RobotState start = world->home_state();
  start.q << 2.0, 0.5;
  world->reset(start);
  const auto energy = [&](const RobotState& s) {
    // Angles from the vertical and heights of the centres of mass; the elbow is at 2 length of the upper
    // link.
    const double a = s.q[0], b = s.q[0] + s.q[1], wa = s.qd[0], wb = s.qd[0] + s.qd[1];
    const double L = 2 * upper.length, l = lower.length;
    const double v2 = L * L * wa * wa + l * l * wb * wb + 2 * L * l * wa * wb * std::cos(a - b);
    const double kinetic = 0.5 * (upper.joint_inertia() * wa * wa + lower.inertia * wb * wb +
                                  lower.mass * v2 + lower.armature * s.qd[1] * s.qd[1]);
    return kinetic - kGravity * (upper.mass * upper.length * std::cos(a) +
                                 lower.mass * (L * std::cos(a) + l * std::cos(b)));
  };
  const double E0 = energy(world->state());
  double worst = 0;
  for (long i = 0; i < std::lround(2 / h); ++i) {
    advance(*world, {});
    worst = std::max(worst, std::abs(energy(world->state()) - E0));
  }
  return worst / (kGravity * (upper.mass * upper.length + lower.mass * (2 * upper.length + lower.length)));
}

std::vector<double> double_pendulum(const Subject& subject) {
  const double coarse = energy_drift(subject, 5e-4), fine = energy_drift(subject, 2.5e-4);
  return {coarse, fine / coarse};
}

/// Largest difference over a second between a step response and the closed form of
/// J q'' + D q' + kp (q - goal) = 0, rad.
double step_response_error(PhysicsBackend& world, const ArmLink& link, double goal) {
  const double J = link.joint_inertia(), D = link.kd + link.damping, a = D / (2 * J);
  const double wd = std::sqrt(link.kp / J - a * a);
  double worst = 0;
  while (world.state().time < 1) {
    advance(world, target(goal));
    const double t = world.state().time;
    const double exact = goal * (1 - std::exp(-a * t) * (std::cos(wd * t) + a / wd * std::sin(wd * t)));
    worst = std::max(worst, std::abs(world.state().q[0] - exact));
  }
  return worst;
}

std::vector<double> servo_step(const Subject& subject) {
  const ArmLink link{
      .armature = 4e-3, .damping = 0.03, .servo = true, .kp = 2, .kd = 0.05, .effort_limit = 100};
  const double goal = 0.3, w = std::sqrt(link.kp / link.joint_inertia());
  const double coarse = step_response_error(*make_arm(subject, scenes::arm({link}), 1e-3, 0), link, goal);
  const double fine = step_response_error(*make_arm(subject, scenes::arm({link}), 5e-4, 0), link, goal);
  return {coarse / goal / (w * 1e-3), fine / coarse};
}

std::vector<double> servo_load(const Subject& subject) {
  const ArmLink link{.damping = 0.2, .servo = true, .kp = 2, .effort_limit = 100};
  const auto world = make_arm(subject, scenes::arm({link}));
  const double goal = 0.8;
  advance(*world, target(goal), 6000);
  // At rest kp (goal - q) = m g l sin q.
  const double q = world->state().q[0], torque = link.kp * (goal - q);
  return {std::abs(world->state().qd[0]), std::abs(torque - link.mass * kGravity * link.length * std::sin(q)),
          goal - q, std::abs(world->torques()[0] - torque)};
}

std::vector<double> servo_limits(const Subject& subject) {
  const ArmLink weak{.servo = true, .kp = 50, .kd = 0.5, .effort_limit = 0.4};
  const auto pushed = make_arm(subject, scenes::arm({weak}), 1e-3, 0);
  double torque = 0, speed = 0, angle = 0;
  for (const double goal : {1.0, -1.0}) {
    pushed->reset();
    advance(*pushed, target(goal), 10);
    const double tau = std::copysign(weak.effort_limit, goal);
    torque = std::max(torque, std::abs(pushed->torques()[0] - tau));
    speed = std::max(speed, std::abs(pushed->state().qd[0] - tau / weak.joint_inertia() * 0.01));
  }
  const ArmLink bounded{.damping = 0.2, .servo = true, .kp = 2, .effort_limit = 100, .limit = 0.5};
  const auto held = make_arm(subject, scenes::arm({bounded}), 1e-3, 0);
  for (const double goal : {2.0, -2.0}) {
    advance(*held, target(goal), 6000);
    angle = std::max(angle, std::abs(held->state().q[0] - std::copysign(bounded.limit, goal)));
  }
  return {torque, speed, angle};
}

std::vector<double> servo_substeps(const Subject& subject) {
  const ArmLink link{.servo = true, .kp = 2, .effort_limit = 100};
  const auto one = make_arm(subject, scenes::arm({link})), many = make_arm(subject, scenes::arm({link}));
  advance(*one, target(0.7), 20);
  for (int i = 0; i < 20; ++i) advance(*many, target(0.7));
  return {scenes::identical(one->state(), many->state()) ? 0.0 : 1.0};
}

std::vector<double> servo_no_load_speed(const Subject& subject) {
  // A full-torque swing of a light link without gravity: qd approaches no_load_speed as a first-order lag,
  // J qd' = effort (1 - qd / w), of time constant J w / effort.
  const ArmLink link{.armature = 4e-3, .servo = true, .kp = 1e3, .effort_limit = 0.5};
  RobotDescription robot = *scenes::arm({link});
  robot.bodies[1].joint.no_load_speed = 5;
  const auto world = make_arm(subject, std::make_shared<const RobotDescription>(robot), 1e-3, 0);
  const double lag = link.joint_inertia() * 5 / 0.5;
  double worst = 0;
  while (world->state().time < 3 * lag) {
    advance(*world, target(3));
    const double exact = 5 * (1 - std::exp(-world->state().time / lag));
    worst = std::max(worst, std::abs(world->state().qd[0] - exact));
  }
  return {worst / (0.5 * 5 * 1e-3 / lag), world->state().qd[0]};
}

std::vector<Check> pendulum_checks() {
  return {
      {"pendulum_small_swings",
       "A joint's inertia, armature included, and its weight's torque",
       {with_rounding(at_most(1e-9, "period off that of discrete steps, relative", "",
                              "timed by linear interpolation; rounding of angles where they cross zero"),
                      100),
        at_most(1 / 20.0, "period off the harmonic oscillator's, relative, over (w h)^2", "",
                "1/24 by semi-implicit Euler")},
       small_swings},
      {"pendulum_large_swings",
       "The same at 143 degrees, against the elliptic integral",
       {at_most(1e-5, "period off, relative, h = 1 ms", "", "(w h)^2 / 24, and some for the amplitude"),
        between(0.23, 0.27, "the error at 2 ms over 4 ms", "", "second order: symplectic for one joint"),
        between(0.23, 0.27, "the error at 1 ms over 2 ms", "", "the same")},
       large_swings},
      {"armature",
       "Armature is inertia without weight",
       {at_most(1e-5, "period with four times the inertia, off twice", "", "(w h)^2 / 24 differs by 1e-6")},
       armature},
      {"joint_damping_at_the_end",
       "What a damper does on the speed at which a step ends is that",
       {rounds_to(1e3, "speed or angle off, all of it, of 1 rad/s", "rad/s", "100 steps of rounding"),
        rounds_to(1e3, "the same, half of it", "rad/s", "as above")},
       damping_at_the_end},
      {"joint_damping",
       "Damping is that of the description and nothing beside it",
       {at_most(1, "off the damped oscillation, share of amplitude, over w h", "",
                "half a step of phase, and half a step of the damping")},
       damping},
      {"double_pendulum",
       "Joints on joints: centrifugal and Coriolis torques, by the energy of a chaotic swing",
       {at_most(0.02, "energy drifts, h = 0.5 ms, relative", "",
                "seen half a step late (0.005), and errors of earlier turns have added up"),
        between(0.4, 0.6, "the drift at h / 2 over h", "", "first order")},
       double_pendulum},
  };
}

std::vector<Check> servo_checks() {
  return {
      {"servo_step",
       "Torques handed to the engine act at once and in full: a step response in closed form",
       {at_most(1, "off the closed form, share of the step, over w h", "",
                "half a step of delay, and as much for the damping"),
        between(0.48, 0.52, "the error at h / 2 over h", "", "first order")},
       servo_step},
      {"servo_load",
       "A servo lags a constant load by load over stiffness, and says its torque",
       {with_rounding(at_most(1e-9, "moves at rest", "rad/s",
                              "exponential decay over 6 s, to what rounding of the angle keeps moving"),
                      1000),
        with_rounding(at_most(1e-9, "torque off the load", "N m", "the same"), 1000),
        at_least(0.1, "lag", "rad", "one worth the name"),
        with_rounding(at_most(1e-9, "torque reported, off", "N m", "the same"), 1000)},
       servo_load},
      {"servo_limits",
       "Effort limits bound the torque and joint limits the target, and the engine adds none of its own",
       {at_most(0, "torque at the effort limit, off", "N m", "a clamp"),
        rounds_to(400, "speed after ten steps of it, off", "rad/s", "ten equal pushes: rounding"),
        with_rounding(at_most(1e-9, "rests off the joint limit", "rad",
                              "exponential decay over 6 s, to what rounding of the angle keeps moving"),
                      1000)},
       servo_limits},
      {"servo_substeps",
       "Twenty substeps are twenty steps",
       {at_most(0, "another state (1: yes)", "", "bit for bit")},
       servo_substeps},
      {"servo_no_load_speed",
       "A servo cannot turn faster than its no-load speed",
       {at_most(1, "off the first-order lag, over (h / 2) of its first acceleration", "",
                "explicit Euler: h / (2 e lag) of the final speed, and as much again"),
        at_least(4.7, "speed in the end, of 5", "rad/s", "95 % after three lags")},
       servo_no_load_speed},
  };
}

}  // namespace

std::vector<Check> joint_checks() {
  std::vector<Check> all = pendulum_checks();
  for (Check& check : servo_checks()) all.push_back(std::move(check));
  return all;
}

}  // namespace crossgait::conformance
