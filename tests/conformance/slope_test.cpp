// Coulomb friction on inclines: a sled sticks on one side of the friction cone and slides on the other, in
// every heading alike.
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "crossgait/tests/support/backend_test.h"

namespace crossgait {
namespace {

constexpr double kGravity = 9.81;
constexpr double kFriction = 0.6;
constexpr int kHeadings = 8;

/// A world with an incline that climbs towards `heading`, and how its surface lies in W.
struct Incline {
  WorldSpec spec;
  Vector3 normal, downhill;
};

double heading_of(int k) { return 2 * std::numbers::pi * k / kHeadings; }

/// The plane, under tilted gravity.
Incline tilted_gravity(double angle, double heading) {
  const Vector3 uphill(std::cos(heading), std::sin(heading), 0);
  Incline incline{scenes::world_of(scenes::sled()), Vector3::UnitZ(), -uphill};
  incline.spec.gravity = kGravity * Vector3(-std::sin(angle) * uphill - std::cos(angle) * Vector3::UnitZ());
  return incline;
}

/// A height field of plane triangles, under upright gravity.
Incline height_field(double angle, double heading) {
  constexpr double kDegree = std::numbers::pi / 180;
  Incline incline{scenes::world_of(scenes::sled()), {}, {}};
  incline.spec.terrain =
      make_terrain(fmt::format("slope:angle={},heading={},size_x=4,size_y=4,cell=0.05,flat_radius=0",
                               angle / kDegree, heading / kDegree));
  const Vector3 level(std::cos(heading), std::sin(heading), 0);
  incline.normal = std::cos(angle) * Vector3::UnitZ() - std::sin(angle) * level;
  incline.downhill = -(std::sin(angle) * Vector3::UnitZ() + std::cos(angle) * level);
  return incline;
}

/// The sled at rest on the incline, not turned about the normal with the heading: its corners lie in W's
/// axes.
RobotState on(const Incline& incline, const PhysicsBackend& backend) {
  RobotState state = backend.home_state();
  state.q_WB = Quaternion::FromTwoVectors(Vector3::UnitZ(), incline.normal);
  state.p_WB = incline.normal * scenes::kSledRadius;
  return state;
}

using MakeIncline = Incline (*)(double angle, double heading);

/// How a sled moved on an incline whose angle puts the friction coefficient at `friction_over_tangent` times
/// tan(angle).
struct Slide {
  double speed = 0;     ///< downhill at the end, m/s
  double distance = 0;  ///< downhill from kSettle to the end, m
  double sideways = 0;  ///< across the line of fall at the end, m
};
constexpr int kSettle = 200, kSteps = 300;  // of 1 ms

double angle_of(double friction_over_tangent) { return std::atan(kFriction / friction_over_tangent); }

class Slope : public BackendTest {
 protected:
  static Slide let_go(const MakeIncline& make_incline, double friction_over_tangent, int k) {
    Incline incline = make_incline(angle_of(friction_over_tangent), heading_of(k));
    incline.spec.contact.friction = kFriction;
    incline.spec.solver.tolerance = 1e-6;
    const auto backend = make(incline.spec);
    backend->reset(on(incline, *backend));
    EXPECT_EQ(backend->step({}, kSettle), StepStatus::kOk);
    const RobotState settled = backend->state();
    EXPECT_EQ(backend->step({}, kSteps), StepStatus::kOk);
    const RobotState& s = backend->state();
    const Vector3 across = incline.normal.cross(incline.downhill);
    return {incline.downhill.dot(s.v_WB), incline.downhill.dot(s.p_WB - settled.p_WB), across.dot(s.p_WB)};
  }

  /// Speed at which a soft contact gives way under the load that friction holds, m/s. In MuJoCo's law a
  /// friction row at rest balances R f = B v, with R at most (1 - d_min) / d_min / m and B = 2 / (d_max t_c):
  /// the creep of a body whose four runners carry a quarter of its weight each.
  static double creep(double angle) {
    const Softness soft;
    const double load = kGravity * std::sin(angle) / 4;  // per mass
    const double R = (1 - soft.impedance_min) / soft.impedance_min,
                 B = 2 / (soft.impedance_max * soft.time_constant);
    // The runners uphill carry less than that, reach the edge of their cones and leave a little more to the
    // others.
    return 1.05 * R * load / B;
  }

  static void sticks(const MakeIncline& make_incline) {
    // Hard contact does not creep: what is left is the tolerance that its solver stops at.
    const double bound = capabilities().soft_contact ? creep(angle_of(1.1)) : 1e-5;
    double fastest = 0, farthest = 0;
    for (int k = 0; k < kHeadings; ++k) {
      const Slide slide = let_go(make_incline, 1.1, k);
      fastest = std::max(fastest, std::abs(slide.speed));
      farthest = std::max(farthest, std::abs(slide.distance));
    }
    measured("speed of creep, m/s", fastest);
    measured("bound on the creep, m/s", bound);
    EXPECT_LT(fastest, bound);
    EXPECT_LT(farthest, bound * kSteps * 1e-3);
  }

  static void slides(const MakeIncline& make_incline) {
    const double angle = angle_of(0.9);
    const double a = kGravity * (std::sin(angle) - kFriction * std::cos(angle));
    const double t0 = kSettle * 1e-3, t1 = (kSettle + kSteps) * 1e-3;
    const double expected = a / 2 * (t1 * t1 - t0 * t0);
    double worst = 0, least = 1, most = 0, off_line = 0;
    for (int k = 0; k < kHeadings; ++k) {
      const Slide slide = let_go(make_incline, 0.9, k);
      worst = std::max(worst, std::abs(slide.distance / expected - 1));
      least = std::min(least, slide.distance);
      most = std::max(most, slide.distance);
      off_line = std::max(off_line, std::abs(slide.sideways));
    }
    measured("distance against a t^2 / 2, relative", worst);
    measured("spread over headings, relative", (most - least) / expected);
    measured("off the line of fall, share of the distance", off_line / expected);
    // Integration is half a step late (2 h / (t0 + t1) = 0.3 %), and a soft contact under way hops within a
    // fraction of a millimetre instead of settling, which tells when its path is cut off.
    EXPECT_LT(worst, 0.01);
    EXPECT_LT(most - least, 0.01 * expected);
    EXPECT_LT(off_line, 1e-3 * expected);
  }
};
CROSSGAIT_FOR_EVERY_BACKEND(Slope);

TEST_P(Slope, SticksJustInsideTheFrictionConeOnThePlane) { sticks(tilted_gravity); }
TEST_P(Slope, SticksJustInsideTheFrictionConeOnAField) { sticks(height_field); }
TEST_P(Slope, SlidesJustOutsideTheFrictionConeOnThePlane) { slides(tilted_gravity); }
TEST_P(Slope, SlidesJustOutsideTheFrictionConeOnAField) { slides(height_field); }

}  // namespace
}  // namespace crossgait
