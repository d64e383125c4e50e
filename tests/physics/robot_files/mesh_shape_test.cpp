// Convex hulls, and what stands for a mesh.
#include "physics/robot_files/mesh/mesh_shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "physics/core/read_budget.h"
#include "physics/robot_files/mesh/convex_hull.h"
#include "physics/robot_files/mesh/robot_meshes.h"
#include "tests/physics/core/config_error.h"

namespace crossgait {
namespace {

constexpr double kPi = std::numbers::pi;

/// Corners of a box and, on and within it, points of a grid.
std::vector<Vector3> box_points(const Vector3& half, int cells) {
  std::vector<Vector3> points;
  for (int i = 0; i <= cells; ++i) {
    for (int j = 0; j <= cells; ++j) {
      for (int k = 0; k <= cells; ++k) {
        points.push_back(
            half.cwiseProduct(Vector3(2.0 * i / cells - 1, 2.0 * j / cells - 1, 2.0 * k / cells - 1)));
      }
    }
  }
  return points;
}

/// Rings of a body that turns about z: pairs of height and radius.
std::vector<Vector3> turned(const std::vector<std::pair<double, double>>& rings, int sides) {
  std::vector<Vector3> points;
  for (const auto& [z, r] : rings) {
    for (int i = 0; i < sides; ++i) {
      const double angle = 2 * kPi * i / sides;
      points.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
    }
  }
  return points;
}

std::vector<Vector3> capsule_points(double radius, double half_length) {
  std::vector<std::pair<double, double>> rings;
  for (int i = -8; i <= 8; ++i) {
    const double angle = i * kPi / 16, side = i < 0 ? -half_length : half_length;
    rings.emplace_back(radius * std::sin(angle) + side, radius * std::cos(angle));
    if (i == 0) rings.emplace_back(-half_length, radius);
  }
  return turned(rings, 32);
}

std::vector<Vector3> rotated(std::vector<Vector3> points, const Quaternion& q,
                             const Vector3& p = Vector3::Zero()) {
  for (Vector3& point : points) point = q * point + p;
  return points;
}

TEST(ConvexHull, OfABoxFullOfPointsIsItsCorners) {
  for (const Quaternion& q : {Quaternion::Identity(), from_roll_pitch_yaw(0.3, -1, 2)}) {
    const ConvexHull hull = convex_hull(rotated(box_points({0.3, 0.2, 0.1}, 6), q, {5, 6, 7}), 100);
    EXPECT_EQ(hull.vertices.size(), 8U);
    EXPECT_NEAR(hull.volume, 0.6 * 0.4 * 0.2, 1e-12);  // flat to 1e-9 of its size
    EXPECT_LT(hull.error, 1e-9);
  }
}

TEST(ConvexHull, OfManyPointsHoldsThemAll) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::vector<Vector3> ball;
  for (int i = 0; i < 3000; ++i)
    ball.push_back(Vector3(normal(random), normal(random), normal(random)).normalized());
  const ConvexHull hull = convex_hull(ball, 5000);
  EXPECT_EQ(hull.vertices.size(), ball.size()) << "all of them are corners";
  EXPECT_EQ(hull.error, 0);
  EXPECT_NEAR(hull.volume, 4 * kPi / 3, 0.02);
  EXPECT_LT(hull.volume, 4 * kPi / 3);
}

TEST(ConvexHull, OfFewVerticesGrowsFromTheFarthest) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::vector<Vector3> ball;
  for (int i = 0; i < 3000; ++i)
    ball.push_back(Vector3(normal(random), normal(random), normal(random)).normalized());
  const ConvexHull whole = convex_hull(ball, 200);
  double volume = 0, error = 2;
  for (const int most : {4, 8, 16, 32, 64, 128}) {
    const ConvexHull hull = convex_hull(ball, most);
    ASSERT_EQ(hull.vertices.size(), static_cast<std::size_t>(most));
    EXPECT_TRUE(std::equal(hull.vertices.begin(), hull.vertices.end(), whole.vertices.begin()));
    EXPECT_GT(hull.volume, volume);
    EXPECT_LT(hull.error, error);
    volume = hull.volume;
    error = hull.error;
  }
  // What no reader of 32 vertices of a ball should be surprised by.
  EXPECT_LT(convex_hull(ball, kMaxHullVertices).error, 0.2);
}

TEST(ConvexHull, OfPointsInAPlaneHasNoVolume) {
  for (const Quaternion& q : {Quaternion::Identity(), from_roll_pitch_yaw(0.3, -1, 2)}) {
    EXPECT_EQ(convex_hull(rotated(turned({{0, 1}}, 12), q), 100).volume, 0);
    EXPECT_EQ(convex_hull(rotated({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}, q), 100).volume, 0);
    EXPECT_EQ(convex_hull(rotated({{1, 2, 3}, {1, 2, 3}}, q), 100).volume, 0);
    EXPECT_EQ(convex_hull(rotated({{1, 2, 3}}, q), 100).volume, 0);
  }
}

// Every kind of flat side, edge and repeated point: volumes of lattice hulls, shifted and scaled, are those
// of the same points without what is inside.
TEST(ConvexHull, OfPointsOnALatticeIsExact) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<Vector3> points;
    for (int i = 0; i < 40; ++i)
      points.emplace_back(static_cast<double>(random() % 4), static_cast<double>(random() % 4),
                          static_cast<double>(random() % 4));
    const ConvexHull hull = convex_hull(points, 1000);
    EXPECT_LT(hull.error, 1e-8);
    std::shuffle(points.begin(), points.end(), random);
    EXPECT_NEAR(convex_hull(points, 1000).volume, hull.volume, 1e-9) << trial;
    EXPECT_NEAR(convex_hull(hull.vertices, 1000).volume, hull.volume, 1e-9) << trial;
    // Six times a lattice polyhedron's volume is whole.
    EXPECT_NEAR(6 * hull.volume, std::round(6 * hull.volume), 1e-8) << trial;
    EXPECT_GT(hull.volume, 1);
  }
}

CollisionShape fitted(const std::vector<Vector3>& vertices, const Pose& X_BG = Pose::Identity()) {
  CollisionShape shape;
  shape.X_BG = X_BG;
  fit_mesh(vertices, shape);
  return shape;
}

TEST(MeshShape, OfABoxIsTheBox) {
  Pose X_BM = make_pose(from_roll_pitch_yaw(0.1, 0.2, 0.3), {1, 2, 3});
  const CollisionShape shape =
      fitted(rotated(box_points({0.3, 0.2, 0.1}, 2), Quaternion::Identity(), {1, 0, 0}), X_BM);
  EXPECT_EQ(shape.type, ShapeType::kBox);
  EXPECT_LT((shape.size - Vector3(0.3, 0.2, 0.1)).norm(), 1e-15);
  EXPECT_LT((shape.X_BG.translation() - X_BM * Vector3(1, 0, 0)).norm(), 1e-15);
}

TEST(MeshShape, OfAPlateIsAThinBox) {
  const CollisionShape shape = fitted(turned({{0.5, 1}}, 12));
  EXPECT_EQ(shape.type, ShapeType::kBox);
  EXPECT_EQ(shape.size.z(), 1e-4);
}

TEST(MeshShape, OfACapsuleIsTheCapsuleAlongAnyAxis) {
  // z, y and x: the capsule's axis z goes there.
  for (const Quaternion& q :
       {Quaternion::Identity(), from_roll_pitch_yaw(kPi / 2, 0, 0), from_roll_pitch_yaw(0, kPi / 2, 0)}) {
    const CollisionShape shape = fitted(rotated(capsule_points(0.02, 0.1), q, {1, 2, 3}));
    ASSERT_EQ(shape.type, ShapeType::kCapsule);
    EXPECT_NEAR(shape.size[0], 0.02, 1e-12);
    EXPECT_NEAR(shape.size[1], 0.1, 1e-9);  // a ring of the mesh on either end's equator
    EXPECT_LT((shape.X_BG.translation() - Vector3(1, 2, 3)).norm(), 1e-12);
    EXPECT_NEAR(std::abs((q * Vector3::UnitZ()).dot(shape.X_BG.linear().col(2))), 1, 1e-12);
    EXPECT_NEAR(shape.X_BG.linear().determinant(), 1, 1e-12);
  }
}

TEST(MeshShape, OfAThinRodIsACapsuleAroundIt) {
  const auto rod = turned({{-0.1, 0.01}, {0.1, 0.01}}, 24);
  const CollisionShape shape = fitted(rod);
  ASSERT_EQ(shape.type, ShapeType::kCapsule) << "7 % larger than the rod, a box 27 %";
  for (const Vector3& v : rod) {
    const Vector3 p = shape.X_BG.inverse() * v;
    const double beyond = std::max(0.0, std::abs(p.z()) - shape.size[1]);
    EXPECT_LE(std::hypot(p.head<2>().norm(), beyond), shape.size[0] * (1 + 1e-12));
  }
}

TEST(MeshShape, OfAnythingElseIsItsHull) {
  // A disc: a capsule around it is far too large, a box by 27 %.
  const auto disc = turned({{-0.02, 0.05}, {0.02, 0.05}}, 16);
  const CollisionShape shape = fitted(rotated(disc, Quaternion::Identity(), {1, 0, 0}));
  ASSERT_EQ(shape.type, ShapeType::kHull);
  EXPECT_EQ(shape.vertices.size(), disc.size());
  for (const Vector3& vertex : disc) {
    EXPECT_TRUE(std::any_of(shape.vertices.begin(), shape.vertices.end(), [&](const Vector3& v) {
      return (shape.X_BG * v - (vertex + Vector3(1, 0, 0))).norm() < 1e-15;
    }));
  }
  // Of finer ones no more than may be.
  const CollisionShape fine = fitted(turned({{-0.02, 0.05}, {0.02, 0.05}}, 64));
  ASSERT_EQ(fine.type, ShapeType::kHull);
  EXPECT_EQ(fine.vertices.size(), static_cast<std::size_t>(kMaxHullVertices));
}

TEST(MeshShape, IsTheSameForTheSameVertices) {
  const auto points = turned({{-0.02, 0.05}, {0, 0.055}, {0.02, 0.03}}, 40);
  const CollisionShape a = fitted(points), b = fitted(points);
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_FALSE(a.vertices.empty());
}

// A file may be named thousands of times: what is fitted to it is fitted once, and is what each would get.
TEST(RobotMeshesFits, AreOneForAllUsesOfTheSameVertices) {
  const auto points = turned({{-0.02, 0.05}, {0, 0.055}, {0.02, 0.03}}, 40);
  ReaderWarnings warnings;
  const std::string path = "robot.urdf";
  RobotMeshes meshes(path, warnings);
  const std::size_t uses = kMaxRobotMeshVertices / points.size();
  ASSERT_GT(uses, kMaxFittedMeshes);
  for (std::size_t i = 0; i < uses; ++i) {
    CollisionShape shape;
    shape.X_BG = Eigen::Translation3d(0.1, 0.2, 0.001 * static_cast<double>(i)) *
                 Quaternion(Eigen::AngleAxisd(0.01 * static_cast<double>(i), Vector3::UnitX()));
    CollisionShape alone = shape;
    meshes.set_vertices(points, "here", shape);
    if (i % 1000 != 0) continue;
    fit_mesh(points, alone);
    EXPECT_EQ(shape.type, alone.type);
    EXPECT_EQ(shape.vertices, alone.vertices);
    EXPECT_EQ(shape.X_BG.matrix(), alone.X_BG.matrix()) << "to the last bit";
  }
}

TEST(RobotMeshesFits, AreBounded) {
  ReaderWarnings warnings;
  const std::string path = "robot.urdf";
  RobotMeshes meshes(path, warnings);
  const auto points = turned({{-0.02, 0.05}, {0.02, 0.03}}, 4);
  for (std::size_t i = 0; i <= kMaxFittedMeshes; ++i) {
    std::vector<Vector3> scaled = points;
    for (Vector3& point : scaled) point *= 1 + 1e-3 * static_cast<double>(i);
    CollisionShape shape;
    if (i < kMaxFittedMeshes) {
      meshes.set_vertices(std::move(scaled), "here", shape);
      continue;
    }
    const ConfigError error =
        config_error([&] { meshes.set_vertices(std::move(scaled), "link 'a'", shape); });
    EXPECT_EQ(error.element(), "link 'a'");
    EXPECT_EQ(error.expected(), "at most 1000 collision meshes that differ");
  }
}

}  // namespace
}  // namespace crossgait
