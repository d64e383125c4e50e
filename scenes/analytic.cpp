#include "scenes/analytic.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "physics/engine/lost_engine.h"
#include "scenes/scenes.h"

namespace crossgait::scenes {
namespace {

void step(PhysicsBackend& world) {
  if (world.step({}) != StepStatus::kOk) {
    throw_if_lost(world);
    throw std::runtime_error(fmt::format("{} diverged in {}", world.robot().name, world.info().name));
  }
}

Vector3 angular_momentum(const SpatialInertia& inertia, const RobotState& s) {
  return s.q_WB * (inertia.I_C * (s.q_WB.conjugate() * s.w_WB));
}

double spin_energy(const SpatialInertia& inertia, const RobotState& s) {
  return 0.5 * s.w_WB.dot(angular_momentum(inertia, s));
}

Vector3 velocity_of_mass(const SpatialInertia& inertia, const RobotState& s) {
  return s.v_WB + s.w_WB.cross(s.q_WB * inertia.p_BC);
}

/// What an explicit Euler step of w' = I^-1 (-w x I w) adds to the energy: (h^2 / 2) tau . I^-1 tau.
double euler_gain(const SpatialInertia& inertia, const RobotState& s, double h) {
  const Vector3 w_B = s.q_WB.conjugate() * s.w_WB;
  const Vector3 tau = w_B.cross(inertia.I_C * w_B);
  return h * h / 2 * tau.dot(inertia.I_C.inverse() * tau);
}

}  // namespace

TumblingDrift measure_tumbling(const Engine& engine, double h) {
  WorldSpec spec = world_of(tumbling_body());
  spec.physics_dt = h;
  spec.gravity.setZero();
  const auto world = engine.make(spec);
  const SpatialInertia& inertia = world->robot().bodies[0].inertia;
  RobotState start = world->home_state();
  start.p_WB.z() = 2;
  start.v_WB = {0.4, -0.3, 0.2};
  start.w_WB = {3, 6, 9};
  world->reset(start);
  const Vector3 L0 = angular_momentum(inertia, start), c0 = start.X_WB() * inertia.p_BC,
                v0 = velocity_of_mass(inertia, start);
  const double E0 = spin_energy(inertia, start);
  TumblingDrift result;
  for (long i = 0; i < std::lround(1 / h); ++i) {
    step(*world);
    const RobotState& s = world->state();
    const Vector3 straight = c0 + v0 * s.time;
    result.momentum = std::max(result.momentum, (angular_momentum(inertia, s) - L0).norm() / L0.norm());
    result.velocity = std::max(result.velocity, (velocity_of_mass(inertia, s) - v0).norm());
    result.position = std::max(result.position, (s.X_WB() * inertia.p_BC - straight).norm());
    result.predicted_energy += euler_gain(inertia, s, h) / E0;
  }
  result.energy = spin_energy(inertia, world->state()) / E0 - 1;
  return result;
}

double free_fall_error(const Engine& engine, double h) {
  WorldSpec spec = world_of(tumbling_body());
  spec.physics_dt = h;
  const auto world = engine.make(spec);
  RobotState start = world->home_state();
  start.p_WB.z() = 30;
  start.v_WB = {0.3, 0.2, 1};
  world->reset(start);
  const long steps = std::lround(1 / h);
  for (long i = 0; i < steps; ++i) step(*world);
  const double t = static_cast<double>(steps) * h;
  return (world->state().p_WB - (start.p_WB + start.v_WB * t + spec.gravity * (t * t / 2))).norm();
}

double pendulum_period(const Engine& engine, const ArmLink& link, double amplitude, double h, int swings) {
  WorldSpec spec = world_of(arm({link}));
  spec.fixed_base = true;
  spec.physics_dt = h;
  const auto world = engine.make(spec);
  RobotState start = world->home_state();
  start.q[0] = amplitude;
  world->reset(start);
  constexpr double kLongest = 60;  // s
  double first = 0, last = 0;
  int crossings = 0;
  for (int i = 0; crossings <= swings; ++i) {
    if (i * h > kLongest)
      throw std::runtime_error(fmt::format("the pendulum does not swing in {}", engine.name()));
    const double before = world->state().q[0];
    step(*world);
    const double after = world->state().q[0];
    if (before > 0 && after <= 0) {
      // The angle is almost straight at the bottom (no acceleration there): linear interpolation is third
      // order.
      last = h * (i + before / (before - after));
      if (crossings++ == 0) first = last;
    }
  }
  return (last - first) / swings;
}

double pendulum_error(const Engine& engine, double h) {
  constexpr double kAmplitude = 2.5;  // rad: twice the period of small swings
  const ArmLink link{};
  const double w = std::sqrt(link.mass * kGravity * link.length / link.joint_inertia());
  const double exact = 4 / w * std::comp_ellint_1(std::sin(kAmplitude / 2));
  return pendulum_period(engine, link, kAmplitude, h, 3) / exact - 1;
}

double rebound(const Engine& engine, double h) {
  constexpr double kRadius = 0.05, kSpeed = 1, kSeconds = 0.3;  // soft contact holds a ball for some 0.05 s
  constexpr int kStarts = 8;
  WorldSpec spec = world_of(block(ShapeType::kSphere, {kRadius, 0, 0}));
  spec.physics_dt = h;
  spec.gravity.setZero();
  const auto world = engine.make(spec);
  double fastest = 0;
  for (int i = 0; i < kStarts; ++i) {
    RobotState start = world->home_state();
    start.p_WB = {0, 0, kRadius + (10 + static_cast<double>(i) / kStarts) * kSpeed * h};
    start.v_WB = {0, 0, -kSpeed};
    world->reset(start);
    for (long k = 0; k < std::lround(kSeconds / h); ++k) step(*world);
    fastest = std::max(fastest, world->state().v_WB.z());
  }
  return fastest / kSpeed;
}

}  // namespace crossgait::scenes
