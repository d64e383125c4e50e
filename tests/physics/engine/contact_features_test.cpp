#include "physics/engine/contact_features.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "physics/robot/state.h"
#include "scenes/robots.h"

namespace crossgait {
namespace {

std::vector<ContactFeature> features_of(ShapeType type, const Vector3& size) {
  return contact_features(*scenes::block(type, size), false);
}

TEST(ContactFeatures, OfEveryShape) {
  const auto sphere = features_of(ShapeType::kSphere, {0.1, 0, 0});
  ASSERT_EQ(sphere.size(), 1U);
  EXPECT_EQ(sphere[0].radius, 0.1);
  EXPECT_EQ(sphere[0].rim, 0);

  const auto box = features_of(ShapeType::kBox, {1, 2, 3});
  ASSERT_EQ(box.size(), 8U);
  for (const ContactFeature& corner : box) {
    EXPECT_EQ(corner.p_GC.cwiseAbs(), Vector3(1, 2, 3));
    EXPECT_EQ(corner.radius + corner.rim, 0);
  }

  const auto capsule = features_of(ShapeType::kCapsule, {0.1, 0.3, 0});
  ASSERT_EQ(capsule.size(), 2U);
  EXPECT_EQ(capsule[0].p_GC, Vector3(0, 0, -0.3));
  EXPECT_EQ(capsule[1].p_GC, Vector3(0, 0, 0.3));
  EXPECT_EQ(capsule[1].radius, 0.1);
  EXPECT_EQ(capsule[1].rim, 0);

  const auto cylinder = features_of(ShapeType::kCylinder, {0.1, 0.3, 0});
  ASSERT_EQ(cylinder.size(), 2U);
  EXPECT_EQ(cylinder[0].p_GC, Vector3(0, 0, -0.3));
  EXPECT_EQ(cylinder[0].rim, 0.1);
  EXPECT_EQ(cylinder[0].radius, 0);

  const CollisionShape gem = scenes::gem();
  const auto hull = contact_features(*scenes::block(gem), false);
  ASSERT_EQ(hull.size(), gem.vertices.size());
  for (std::size_t i = 0; i < hull.size(); ++i) EXPECT_EQ(hull[i].p_GC, gem.vertices[i]);
}

TEST(ContactFeatures, SayWhoseTheyAre) {
  const scenes::RobotPtr robot = scenes::quadruped();
  const auto features = contact_features(*robot, false);
  int feet = 0;
  for (const ContactFeature& feature : features) {
    EXPECT_EQ(feature.leg, leg_of_shape(*robot, feature.body, feature.shape));
    if (feature.leg >= 0) ++feet;
  }
  EXPECT_EQ(feet, 4);
  for (const ContactFeature& feature : contact_features(*robot, true)) EXPECT_GT(feature.body, 0);
  EXPECT_LT(contact_features(*robot, true).size(), features.size()) << "a fixed base touches nothing";
}

class Rim : public ::testing::Test {
 protected:
  /// Sorted by height.
  static std::vector<Vector3> points(const Vector3& centre, const Vector3& axis, const Terrain& terrain = {},
                                     double margin = 0) {
    ContactFeature rim;
    rim.rim = 0.1;
    const SphereCentres centres = sphere_centres(rim, centre, axis.normalized(), terrain, margin);
    std::vector<Vector3> result(centres.points.begin(), centres.points.begin() + centres.count);
    for (const Vector3& p : result) {
      EXPECT_NEAR((p - centre).norm(), 0.1, 1e-15);  // rounding, here and below
      EXPECT_NEAR((p - centre).dot(axis.normalized()), 0, 1e-15);
    }
    std::sort(result.begin(), result.end(), [](const auto& a, const auto& b) { return a.z() < b.z(); });
    return result;
  }
};

TEST_F(Rim, LyingTouchesAtItsLowestPoint) {
  const auto found = points({1, 2, 0.09}, {0, 1, 0});
  ASSERT_EQ(found.size(), 3U);
  EXPECT_LT((found[0] - Vector3(1, 2, -0.01)).norm(), 1e-15);
  for (const std::size_t i : {1, 2}) EXPECT_NEAR(found[i].z(), 0.09 + 0.05, 1e-15) << "a third of a turn on";
}

TEST_F(Rim, TiltedAlwaysHasItsExactLowestPoint) {
  for (int k = 0; k < 100; ++k) {
    const Vector3 axis = Vector3(std::cos(0.7 * k), std::sin(0.7 * k), std::sin(1.0 * k)).normalized();
    const double drop = 0.1 * std::hypot(axis.x(), axis.y());
    const auto found = points({0, 0, drop - 1e-3}, axis);
    ASSERT_EQ(found.size(), 3U) << k;
    EXPECT_NEAR(found[0].z(), -1e-3, 1e-15) << k;
  }
}

TEST_F(Rim, UprightHasThreeLevelPoints) {
  for (const double tilt : {0.0, 1e-12, 1e-6}) {
    const auto found = points({0, 0, -1e-3}, {tilt, 0, 1});
    ASSERT_EQ(found.size(), 3U);
    EXPECT_NEAR(found[2].z() - found[0].z(), 0.15 * tilt, 1e-11);  // where it begins is free below 1e-9
    EXPECT_NEAR((found[0] - found[1]).norm(), 0.1 * std::numbers::sqrt3, 1e-15);
    EXPECT_NEAR((found[1] - found[2]).norm(), 0.1 * std::numbers::sqrt3, 1e-15);
  }
}

TEST_F(Rim, OnASlopeItsPointNearestToTheSlope) {
  const Terrain slope = make_terrain("slope:angle=20,size_x=2,size_y=2,cell=0.05,flat_radius=0");
  const Vector3 normal = slope.normal(0.3, 0.2);
  const Vector3 ground(0.3, 0.2, slope.height(0.3, 0.2));
  const auto found = points(ground + 0.09 * normal, {0, 1, 0}, slope);
  ASSERT_EQ(found.size(), 3U);
  // Heights are floats: neighbouring triangles tilt by 1e-6.
  EXPECT_LT((found[0] - (ground - 0.01 * normal)).norm(), 1e-6);
}

TEST_F(Rim, OutOfReachHasNone) {
  EXPECT_TRUE(points({0, 0, 0.1 + 1e-9}, {0, 1, 0}).empty());
  EXPECT_EQ(points({0, 0, 0.1 + 1e-9}, {0, 1, 0}, {}, 1e-3).size(), 3U) << "within the margin";
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(points({0, 0, 1}, {0, 0, 1}).empty());
  ContactFeature rim;
  rim.rim = 0.1;
  EXPECT_EQ(sphere_centres(rim, {nan, 0, 0}, Vector3::UnitZ(), {}, 0).count, 0);
}

TEST(DeepestPoints, AreKeptInTheOrderOfTheirAdding) {
  ContactList list;
  const auto add = [&](double distance) {
    Contact contact;
    contact.distance = distance;
    list.add(contact);
  };
  for (int i = 0; i < kMaxContacts; ++i) add(-(i % 8) - 1.0);  // depths 1 to 8, eight of each
  EXPECT_EQ(list.count, kMaxContacts);
  EXPECT_EQ(list.dropped, 0);
  add(-1);
  EXPECT_EQ(list.dropped, 1) << "as deep as the shallowest: the earlier stays";
  EXPECT_EQ(list.points[kMaxContacts - 1].distance, -8);
  add(-20);  // in the place of the latest of depth 1, at 56
  EXPECT_EQ(list.count, kMaxContacts);
  EXPECT_EQ(list.dropped, 2);
  EXPECT_EQ(list.points[55].distance, -8);
  EXPECT_EQ(list.points[56].distance, -2);
  EXPECT_EQ(list.points[kMaxContacts - 2].distance, -8);
  EXPECT_EQ(list.points[kMaxContacts - 1].distance, -20);
  list.clear();
  EXPECT_EQ(list.begin(), list.end());
  EXPECT_EQ(list.dropped, 0);
}

}  // namespace
}  // namespace crossgait
