// Collision shapes of every kind on every engine: where they touch, what they carry, how they roll.
#include <cmath>
#include <numbers>

#include "crossgait/benchmarks/incline.h"
#include "crossgait/physics/contact_features.h"
#include "crossgait/physics/multibody.h"
#include "crossgait/tests/conformance/contact_forces.h"
#include "crossgait/tests/support/backend_test.h"
#include "crossgait/tests/support/constants.h"

namespace crossgait {
namespace {

using test::kGravity;

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

class Shapes : public BackendTest {
 protected:
  /// Drops a block from just above the ground, and looks at it two seconds later.
  /// @param height  of its centre at rest, m  @param roll  that lays it on the side it rests on
  static void rests(const CollisionShape& shape, double height, const char* terrain, double roll = 0) {
    WorldSpec spec = scenes::world_of(scenes::block(shape));
    spec.terrain = make_terrain(terrain);
    const auto backend = make(spec);
    RobotState start = backend->home_state();
    start.p_WB.z() = height + 1e-3;
    start.q_WB = from_roll_pitch_yaw(roll, 0, 0);
    backend->reset(start);
    ASSERT_EQ(backend->step({}, 1800), StepStatus::kOk);
    double force = 0;
    for (int i = 0; i < 200; ++i) {
      ASSERT_EQ(backend->step({}), StepStatus::kOk);
      for (const Contact& c : backend->contacts()) force += c.force.dot(c.normal) / 200;
    }
    const double weight = backend->robot().total_mass() * kGravity;
    measured("force over weight - 1", force / weight - 1);
    measured("sinks in, m", height - backend->state().p_WB.z());
    EXPECT_NEAR(force / weight, 1, 1e-3);
    // No deeper than the contact law has the whole weight sink on one point; Bullet keeps a margin of 1 mm.
    const double bound = std::max(1e-3, sinking(weight, 1 / backend->robot().total_mass()));
    EXPECT_NEAR(backend->state().p_WB.z(), height, bound);
    EXPECT_LT(backend->state().q_WB.angularDistance(start.q_WB), 1e-2);
    EXPECT_LT(backend->state().v_WB.norm(), 1e-3);
    ASSERT_GT(backend->contacts().count, 0);
    for (const Contact& c : backend->contacts()) EXPECT_EQ(c.leg, -1);
  }

  /// Something round whose axis lies across a slope of 5 degrees rolls down it: a = g sin / (1 + I / (m
  /// r^2)).
  static void rolls(ShapeType type, const Vector3& size, scenes::MakeIncline make_incline) {
    constexpr double kAngle = 5 * std::numbers::pi / 180;
    scenes::Incline incline = make_incline(kAngle, 0);
    incline.spec.robot = scenes::block(type, size);
    const auto backend = make(incline.spec);
    const double radius = size.x();
    RobotState start = backend->home_state();
    // Its axis z along W's y, level.
    start.q_WB = Quaternion::FromTwoVectors(Vector3::UnitZ(), incline.normal) *
                 from_roll_pitch_yaw(kQuarterTurn, 0, 0);
    start.p_WB = incline.normal * radius;
    backend->reset(start);
    const auto speed_after = [&](int steps) {
      EXPECT_EQ(backend->step({}, steps), StepStatus::kOk);
      return backend->state().v_WB.dot(incline.downhill);
    };
    const double first = speed_after(200), then = speed_after(600);
    const SpatialInertia& inertia = incline.spec.robot->bodies[0].inertia;
    const double ratio = inertia.I_C(2, 2) / (inertia.mass * radius * radius);
    const double expected = kGravity * std::sin(kAngle) / (1 + ratio);
    const double turning = backend->state().w_WB.norm();
    measured("acceleration, relative error", (then - first) / 0.6 / expected - 1);
    measured("slip over speed", then / (turning * radius) - 1);
    // A soft contact sinks by .2 mm of 50, and acts midway: it turns as if it were .2 % smaller, and creeps a
    // little.
    EXPECT_NEAR((then - first) / 0.6 / expected, 1, 0.004);
    EXPECT_NEAR(then / (turning * radius), 1, 0.004);
    EXPECT_LT(std::abs(backend->state().v_WB.y()), 1e-3 * then) << "straight down";
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

// What contact_features.h says touches, no more and no less, on every engine.
TEST_P(Shapes, TouchWhereTheirFeaturesAre) {
  for (const char* terrain : {"flat", "rough:seed=5,flat_radius=0,size_x=2,size_y=2"}) {
    WorldSpec spec = scenes::world_of(scenes::assortment());
    spec.terrain = make_terrain(terrain);
    const auto backend = make(spec);
    const RobotDescription& robot = backend->robot();
    const std::vector<ContactFeature> features = contact_features(robot, false);
    int found = 0;
    for (int k = 0; k < 40; ++k) {
      RobotState state = backend->home_state();
      state.q_WB = from_roll_pitch_yaw(0.7 * k, std::sin(1.0 * k), 2.0 * k);
      std::vector<Pose> poses;
      forward_kinematics(robot, state, poses);
      double lowest = 0;
      for (const ContactFeature& feature : features) {
        const auto b = static_cast<std::size_t>(feature.body);
        const Pose& X_BG = robot.bodies[b].shapes[static_cast<std::size_t>(feature.shape)].X_BG;
        lowest = std::min(lowest, (poses[b] * X_BG * feature.p_GC).z() - state.p_WB.z());
      }
      state.p_WB.z() = spec.terrain.height(0, 0) - lowest - 0.05 * (k % 2 + 0.2);
      backend->reset(state);
      ASSERT_EQ(backend->step(scenes::home_targets(robot)), StepStatus::kOk);
      forward_kinematics(robot, state, poses);
      int expected = 0;
      for (const ContactFeature& feature : features) {
        const auto b = static_cast<std::size_t>(feature.body);
        const Pose X_WG = poses[b] * robot.bodies[b].shapes[static_cast<std::size_t>(feature.shape)].X_BG;
        const SphereCentres centres =
            sphere_centres(feature, X_WG * feature.p_GC, X_WG.linear() * feature.axis_G, spec.terrain, 0);
        for (int i = 0; i < centres.count; ++i) {
          SphereContact touch;
          if (!spec.terrain.touch_sphere(centres.points[static_cast<std::size_t>(i)], feature.radius, touch))
            continue;
          ++expected;
          const auto is_it = [&](const Contact& c) {  // rounding of poses
            return c.body == feature.body && std::abs(c.distance - touch.distance) < 1e-9 &&
                   (c.p_WP - touch.position).norm() < 1e-9 && (c.normal - touch.normal).norm() < 1e-6;
          };
          EXPECT_TRUE(std::any_of(backend->contacts().begin(), backend->contacts().end(), is_it))
              << terrain << ", pose " << k << ", body " << robot.bodies[b].name;
        }
      }
      const auto below = std::count_if(backend->contacts().begin(), backend->contacts().end(),
                                       [](const Contact& c) { return c.distance <= 0; });
      EXPECT_EQ(below, expected) << terrain << ", pose " << k;
      found += expected;
    }
    EXPECT_GT(found, 100);
  }
}

// Three hulls of 32 vertices each, all under the ground: 96 points.
TEST_P(Shapes, OfTooManyPointsTheDeepestCount) {
  RobotDescription robot;
  robot.name = "prisms";
  Body body;
  body.name = "trunk";
  body.inertia = scenes::solid_box(3, {0.2, 0.1, 0.1});
  for (int k = 0; k < 3; ++k) {
    CollisionShape hull = shape_of(ShapeType::kHull, Vector3::Zero());
    hull.name = "hull" + std::to_string(k);
    hull.X_BG.translation().x() = 0.2 * (k - 1);
    for (int i = 0; i < kMaxHullVertices; ++i) {
      const double angle = 2 * std::numbers::pi * i / kMaxHullVertices;
      hull.vertices.emplace_back(0.05 * std::cos(angle), 0.05 * std::sin(angle), 0.003 * i + 0.0001 * k);
    }
    body.shapes.push_back(hull);
  }
  robot.bodies.push_back(body);
  const auto backend = make(scenes::finished(robot));
  RobotState start = backend->home_state();
  start.p_WB.z() = -0.12;
  backend->reset(start);
  ASSERT_EQ(backend->step({}), StepStatus::kOk);
  const ContactList& contacts = backend->contacts();
  EXPECT_EQ(contacts.count, kMaxContacts);
  EXPECT_EQ(contacts.dropped, 3 * kMaxHullVertices - kMaxContacts);
  double shallowest = -1;
  for (const Contact& c : contacts) shallowest = std::max(shallowest, c.distance);
  // Sorted by depth they go hull by hull, vertex by vertex: the 64th is vertex 21 of the first hull.
  EXPECT_NEAR(shallowest, -0.12 + 0.003 * 21, 1e-12);
}

}  // namespace
}  // namespace crossgait
