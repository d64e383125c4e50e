// Collision shapes of every kind on every engine: what they carry, how they roll. Where they touch:
// conformance/shapes.cpp.
#include <cmath>
#include <numbers>

#include "conformance/contact_forces.h"
#include "scenes/incline.h"
#include "tests/support/constants.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

constexpr const char* kFlatField = "slope:angle=0,size_x=1,size_y=1,cell=0.05";
constexpr double kQuarterTurn = std::numbers::pi / 2;

CollisionShape shape_of(ShapeType type, const Vector3& size) {
  CollisionShape shape;
  shape.name = "shape";
  shape.type = type;
  shape.size = size;
  return shape;
}

/// A regular tetrahedron of edge `edge` on one of its faces, about its centre.
CollisionShape tetrahedron(double edge) {
  CollisionShape hull = shape_of(ShapeType::kHull, Vector3::Zero());
  const double height = edge * std::sqrt(2.0 / 3), around = edge / std::numbers::sqrt3;
  for (int i = 0; i < 3; ++i) {
    const double angle = 2 * std::numbers::pi * i / 3;
    hull.vertices.emplace_back(around * std::cos(angle), around * std::sin(angle), -height / 4);
  }
  hull.vertices.emplace_back(0, 0, 3 * height / 4);
  return hull;
}

class Shapes : public EngineTest {
 protected:
  /// Drops a block from just above the ground, and looks at it two seconds later.
  /// @param height  of its centre at rest, m  @param roll  that lays it on the side it rests on
  static void rests(const CollisionShape& shape, double height, const char* terrain, double roll = 0) {
    WorldSpec spec = scenes::world_of(scenes::block(shape));
    spec.terrain = make_terrain(terrain);
    const auto world = make(spec);
    RobotState start = world->home_state();
    start.p_WB.z() = height + 1e-3;
    start.q_WB = from_roll_pitch_yaw(roll, 0, 0);
    world->reset(start);
    ASSERT_EQ(world->step({}, 1800), StepStatus::kOk);
    double force = 0;
    for (int i = 0; i < 200; ++i) {
      ASSERT_EQ(world->step({}), StepStatus::kOk);
      for (const Contact& c : world->contacts()) force += c.force.dot(c.normal) / 200;
    }
    const double weight = world->robot().total_mass() * kGravity;
    measured("force over weight - 1", force / weight - 1);
    measured("sinks in, m", height - world->state().p_WB.z());
    EXPECT_NEAR(force / weight, 1, 1e-3);
    // No deeper than the contact law has the whole weight sink on one point; Bullet keeps a margin of 1 mm.
    const double bound = std::max(1e-3, conformance::sinking(weight, 1 / world->robot().total_mass()));
    EXPECT_NEAR(world->state().p_WB.z(), height, bound);
    EXPECT_LT(world->state().q_WB.angularDistance(start.q_WB), 1e-2);
    EXPECT_LT(world->state().v_WB.norm(), 1e-3);
    ASSERT_GT(world->contacts().count, 0);
    for (const Contact& c : world->contacts()) EXPECT_EQ(c.leg, -1);
  }

  /// Something round whose axis lies across a slope of 5 degrees rolls down it: a = g sin / (1 + I / (m
  /// r^2)).
  static void rolls(ShapeType type, const Vector3& size, scenes::MakeIncline make_incline) {
    constexpr double kAngle = 5 * std::numbers::pi / 180;
    scenes::Incline incline = make_incline(kAngle, 0);
    incline.spec.robot = scenes::block(type, size);
    const auto world = make(incline.spec);
    const double radius = size.x();
    RobotState start = world->home_state();
    // Its axis z along W's y, level.
    start.q_WB = rotation_of_z_to(incline.normal) * from_roll_pitch_yaw(kQuarterTurn, 0, 0);
    start.p_WB = incline.normal * radius;
    world->reset(start);
    const auto speed_after = [&](int steps) {
      EXPECT_EQ(world->step({}, steps), StepStatus::kOk);
      return world->state().v_WB.dot(incline.downhill);
    };
    const double first = speed_after(200), then = speed_after(600);
    const SpatialInertia& inertia = incline.spec.robot->bodies[0].inertia;
    const double ratio = inertia.I_C(2, 2) / (inertia.mass * radius * radius);
    const double expected = kGravity * std::sin(kAngle) / (1 + ratio);
    const double turning = world->state().w_WB.norm();
    measured("acceleration, relative error", (then - first) / 0.6 / expected - 1);
    measured("slip over speed", then / (turning * radius) - 1);
    // A soft contact sinks by 0.2 mm of 50, and acts midway: it turns as if it were 0.2 % smaller, and creeps
    // a little.
    EXPECT_NEAR((then - first) / 0.6 / expected, 1, 0.004);
    EXPECT_NEAR(then / (turning * radius), 1, 0.004);
    EXPECT_LT(std::abs(world->state().v_WB.y()), 1e-3 * then + conformance::residual_speed(world->info()))
        << "straight down";
  }
};
CROSSGAIT_FOR_EVERY_BACKEND(Shapes);

const CollisionShape kBox = shape_of(ShapeType::kBox, {0.06, 0.04, 0.03});
const CollisionShape kCylinder = shape_of(ShapeType::kCylinder, {0.05, 0.04, 0});
const CollisionShape kCapsule = shape_of(ShapeType::kCapsule, {0.03, 0.05, 0});

TEST_P(Shapes, ASphereRestsOnThePlane) { rests(shape_of(ShapeType::kSphere, {0.05, 0, 0}), 0.05, "flat"); }
TEST_P(Shapes, ABoxRestsOnThePlane) { rests(kBox, 0.03, "flat"); }
TEST_P(Shapes, ABoxRestsOnAField) { rests(kBox, 0.03, kFlatField); }
TEST_P(Shapes, ACylinderStandsOnThePlane) { rests(kCylinder, 0.04, "flat"); }
TEST_P(Shapes, ACylinderStandsOnAField) { rests(kCylinder, 0.04, kFlatField); }
TEST_P(Shapes, ACylinderLiesOnThePlane) { rests(kCylinder, 0.05, "flat", kQuarterTurn); }
TEST_P(Shapes, ACylinderLiesOnAField) { rests(kCylinder, 0.05, kFlatField, kQuarterTurn); }
TEST_P(Shapes, ACapsuleLiesOnThePlane) { rests(kCapsule, 0.03, "flat", kQuarterTurn); }
TEST_P(Shapes, ACapsuleLiesOnAField) { rests(kCapsule, 0.03, kFlatField, kQuarterTurn); }
TEST_P(Shapes, AHullRestsOnThePlane) { rests(tetrahedron(0.1), 0.1 * std::sqrt(2.0 / 3) / 4, "flat"); }
TEST_P(Shapes, AHullRestsOnAField) { rests(tetrahedron(0.1), 0.1 * std::sqrt(2.0 / 3) / 4, kFlatField); }

TEST_P(Shapes, ACylinderRollsDownThePlane) {
  rolls(ShapeType::kCylinder, {0.05, 0.06, 0}, scenes::tilted_gravity);
}
TEST_P(Shapes, ACylinderRollsDownAField) {
  rolls(ShapeType::kCylinder, {0.05, 0.06, 0}, scenes::inclined_field);
}
TEST_P(Shapes, ACapsuleRollsDownThePlane) {
  rolls(ShapeType::kCapsule, {0.05, 0.06, 0}, scenes::tilted_gravity);
}
TEST_P(Shapes, ACapsuleRollsDownAField) {
  rolls(ShapeType::kCapsule, {0.05, 0.06, 0}, scenes::inclined_field);
}

}  // namespace
}  // namespace crossgait
