#include "scenes/incline.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "physics/engine/lost_engine.h"

namespace crossgait::scenes {

Incline tilted_gravity(double angle, double heading) {
  const Vector3 uphill(std::cos(heading), std::sin(heading), 0);
  Incline incline{world_of(sled()), Vector3::UnitZ(), -uphill};
  incline.spec.gravity = kGravity * Vector3(-std::sin(angle) * uphill - std::cos(angle) * Vector3::UnitZ());
  return incline;
}

Incline inclined_field(double angle, double heading) {
  constexpr double kDegree = std::numbers::pi / 180;
  Incline incline{world_of(sled()), {}, {}};
  incline.spec.terrain =
      make_terrain(fmt::format("slope:angle={},heading={},size_x=4,size_y=4,cell=0.05,flat_radius=0",
                               angle / kDegree, heading / kDegree));
  const Vector3 level(std::cos(heading), std::sin(heading), 0);
  incline.normal = std::cos(angle) * Vector3::UnitZ() - std::sin(angle) * level;
  incline.downhill = -(std::sin(angle) * Vector3::UnitZ() + std::cos(angle) * level);
  return incline;
}

namespace {

constexpr int kHeadings = 8;
constexpr int kSettleSteps = 200, kSlideSteps = 300;  // of 1 ms

/// How the sled moved.
struct Slide {
  double speed = 0;     ///< downhill at the end, m/s
  double distance = 0;  ///< downhill after settling, m
  double sideways = 0;  ///< across the line of fall at the end, m
};

Slide let_go(const Engine& engine, MakeIncline make_incline, double friction_over_tangent, int heading) {
  Incline incline =
      make_incline(incline_angle(friction_over_tangent), 2 * std::numbers::pi * heading / kHeadings);
  incline.spec.contact.friction = kInclineFriction;
  incline.spec.solver.tolerance = 1e-6;
  const auto world = engine.make(incline.spec);
  // Not turned about the normal with the heading: its corners lie in W's axes.
  RobotState start = world->home_state();
  start.q_WB = rotation_of_z_to(incline.normal);
  start.p_WB = incline.normal * kSledRadius;
  world->reset(start);
  const bool settled = world->step({}, kSettleSteps) == StepStatus::kOk;
  const Vector3 from = world->state().p_WB;
  if (!settled || world->step({}, kSlideSteps) != StepStatus::kOk) {
    throw_if_lost(*world);
    throw std::runtime_error(fmt::format("the sled diverged in {}", engine.name()));
  }
  const RobotState& s = world->state();
  const Vector3 across = incline.normal.cross(incline.downhill);
  return {incline.downhill.dot(s.v_WB), incline.downhill.dot(s.p_WB - from), across.dot(s.p_WB)};
}

}  // namespace

double incline_angle(double friction_over_tangent) {
  return std::atan(kInclineFriction / friction_over_tangent);
}

FrictionCone measure_friction_cone(const Engine& engine, MakeIncline make_incline) {
  FrictionCone result;
  const double angle = incline_angle(kJustOutside);
  const double a = kGravity * (std::sin(angle) - kInclineFriction * std::cos(angle));
  const double t0 = kSettleSteps * 1e-3, t1 = (kSettleSteps + kSlideSteps) * 1e-3;
  const double expected = a / 2 * (t1 * t1 - t0 * t0);
  double least = HUGE_VAL, most = -HUGE_VAL;
  for (int heading = 0; heading < kHeadings; ++heading) {
    const Slide inside = let_go(engine, make_incline, kJustInside, heading);
    result.creep_speed = std::max(result.creep_speed, std::abs(inside.speed));
    result.creep_distance = std::max(result.creep_distance, std::abs(inside.distance));
    const Slide outside = let_go(engine, make_incline, kJustOutside, heading);
    result.distance_error = std::max(result.distance_error, std::abs(outside.distance / expected - 1));
    result.off_line = std::max(result.off_line, std::abs(outside.sideways) / expected);
    least = std::min(least, outside.distance);
    most = std::max(most, outside.distance);
  }
  result.range = (most - least) / expected;
  return result;
}

}  // namespace crossgait::scenes
