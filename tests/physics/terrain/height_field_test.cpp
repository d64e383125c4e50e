#include "physics/terrain/height_field.h"

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/physics/core/config_error.h"
#include "tests/support/constants.h"

namespace crossgait {
namespace {

using test::kInfinity;
using test::kNaN;

/// z = height(x, y) at the samples.
template <typename Height>
HeightField make_field(int columns, int rows, double size_x, double size_y, const Height& height) {
  std::vector<float> heights;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const double x = c * size_x / (columns - 1) - size_x / 2;
      const double y = r * size_y / (rows - 1) - size_y / 2;
      heights.push_back(static_cast<float>(height(x, y)));
    }
  }
  return {columns, rows, size_x, size_y, heights};
}

/// Heights of 0 to `amplitude` without any order: the hardest field to walk on.
HeightField random_field(int columns, int rows, double cell, float amplitude, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> height(0, amplitude);
  return make_field(columns, rows, (columns - 1) * cell, (rows - 1) * cell,
                    [&](double, double) { return height(generator); });
}

/// One cell of side 1 with corners a, b (along x), e (along y), f.
HeightField one_cell(float a, float b, float e, float f) { return {2, 2, 1, 1, {a, b, e, f}}; }

TEST(HeightField, StoresRowsAlongXFromTheLowestY) {
  const HeightField field(3, 2, 4, 1, {0, 1, 2, 10, 11, 12});
  EXPECT_EQ(field.at(2, 1), 12);
  EXPECT_EQ(field.height(-2, -0.5), 0);
  EXPECT_EQ(field.height(0, -0.5), 1);
  EXPECT_EQ(field.height(-2, 0.5), 10);
  EXPECT_EQ(field.height(2, 0.5), 12);
  EXPECT_EQ(field.cell_x(), 2);
  EXPECT_EQ(field.cell_y(), 1);
  EXPECT_EQ(field.min(), 0);
  EXPECT_EQ(field.max(), 12);
}

TEST(HeightField, ReproducesPlanesExactly) {
  // Every number is a small multiple of a power of two: no operation rounds.
  const auto plane = [](double x, double y) { return 0.5 * x - 0.25 * y + 0.125; };
  const HeightField field = make_field(9, 5, 4, 2, plane);
  for (int i = -64; i <= 64; ++i) {
    for (int j = -32; j <= 32; ++j) {
      const double x = i / 32.0;
      const double y = j / 32.0;
      ASSERT_EQ(field.height(x, y), plane(x, y)) << x << ' ' << y;
      // A unit vector of three rounded operations.
      ASSERT_LT((field.normal(x, y) - Vector3(-0.5, 0.25, 1).normalized()).norm(), 1e-15);
    }
  }
}

TEST(HeightField, InterpolatesOnTwoTrianglesAndNotBilinearly) {
  const HeightField field = one_cell(1, 2, 4, 8);
  // Below the diagonal a-f: a + u (b-a) + v (f-b). Bilinear interpolation gives 2.8125.
  EXPECT_EQ(field.height(0.25, -0.25), 1 + 0.75 * 1 + 0.25 * 6);
  // Above it: a + v (e-a) + u (f-e). Bilinear: 3.5625.
  EXPECT_EQ(field.height(-0.25, 0.25), 1 + 0.75 * 3 + 0.25 * 4);
  // On the diagonal, the mean of a and f; along the other diagonal it would be that of b and e, 3.
  EXPECT_EQ(field.height(0, 0), 4.5);
  const Vector3 lower = Vector3(-1, -6, 1).normalized();
  const Vector3 upper = Vector3(-4, -3, 1).normalized();
  EXPECT_LT((field.normal(0.25, -0.25) - lower).norm(), 1e-15);  // rounding of a unit vector
  EXPECT_LT((field.normal(-0.25, 0.25) - upper).norm(), 1e-15);
}

TEST(HeightField, IsContinuousAcrossEdges) {
  const HeightField field = random_field(7, 6, 0.1, 0.05F, 1);
  constexpr double kGap = 1e-9;
  // The steepest edge rises 0.05 m in 0.1 m, so no facet slopes more than 0.71: a gap of 2e-9 m hides at
  // most 1.5e-9 m.
  constexpr double kTolerance = 1.5e-9;
  for (int k = 0; k <= 100; ++k) {
    for (int c = 1; c < 6; ++c) {
      const double x = c * 0.1 - 0.3;
      const double y = (k / 100.0 - 0.5) * 0.5;
      EXPECT_NEAR(field.height(x - kGap, y), field.height(x + kGap, y), kTolerance);
    }
    for (int r = 1; r < 5; ++r) {
      const double x = (k / 100.0 - 0.5) * 0.6;
      const double y = r * 0.1 - 0.25;
      EXPECT_NEAR(field.height(x, y - kGap), field.height(x, y + kGap), kTolerance);
    }
    const double t = k / 100.0 * 0.5;  // the diagonals of five cells
    EXPECT_NEAR(field.height(t - 0.3 + kGap, t - 0.25 - kGap), field.height(t - 0.3 - kGap, t - 0.25 + kGap),
                2 * kTolerance);
  }
}

TEST(HeightField, NormalIsTheGradientOfTheHeight) {
  const HeightField field = random_field(6, 6, 0.1, 0.05F, 2);
  constexpr double kStep = 1e-4;
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> inner(0.05, 0.4);
  for (int r = 0; r < 5; ++r) {
    for (int c = 0; c < 5; ++c) {
      for (const bool lower : {true, false}) {
        const double small = inner(generator);
        const double large = small + 0.5;
        const double x = (c + (lower ? large : small)) * 0.1 - 0.25;
        const double y = (r + (lower ? small : large)) * 0.1 - 0.25;
        const double slope_x = (field.height(x + kStep, y) - field.height(x - kStep, y)) / (2 * kStep);
        const double slope_y = (field.height(x, y + kStep) - field.height(x, y - kStep)) / (2 * kStep);
        // A triangle is plane: the difference quotient errs by rounding alone, 1e-17 / 1e-4.
        EXPECT_LT((field.normal(x, y) - Vector3(-slope_x, -slope_y, 1).normalized()).norm(), 1e-12);
      }
    }
  }
}

TEST(HeightField, AnswersOutsideForTheNearestPointAndAlwaysFinitely) {
  const HeightField field(3, 2, 4, 1, {0, 1, 2, 10, 11, 12});
  EXPECT_TRUE(field.contains(2, 0.5));
  EXPECT_TRUE(field.contains(-2, -0.5));
  EXPECT_FALSE(field.contains(std::nextafter(2.0, 3.0), 0));
  EXPECT_FALSE(field.contains(0, -0.51));
  EXPECT_FALSE(field.contains(kNaN, 0));
  EXPECT_EQ(field.height(1e9, -0.5), 2);
  EXPECT_EQ(field.height(1, 7), field.height(1, 0.5));
  EXPECT_EQ(field.height(kInfinity, kInfinity), 12);
  EXPECT_EQ(field.height(-kInfinity, kInfinity), 10);
  EXPECT_EQ(field.height(kNaN, kNaN), 0);
  EXPECT_TRUE(field.normal(kNaN, kNaN).allFinite());
}

TEST(HeightField, RefusesWhatIsNoField) {
  const auto make = [](int columns, int rows, double size_x, double size_y, std::vector<float> heights) {
    return std::string(config_error([&] {
                         HeightField(columns, rows, size_x, size_y, std::move(heights), "map.csv");
                       }).what());
  };
  EXPECT_EQ(make(1, 2, 1, 1, {0, 0}), "map.csv: columns: expected at least 2 samples along x, found 1");
  EXPECT_EQ(make(2, 0, 1, 1, {}), "map.csv: rows: expected at least 2 samples along y, found 0");
  EXPECT_EQ(make(4097, 4096, 1, 1, {}),
            "map.csv: samples: expected at most 16777216, found 4097 x 4096 = 16781312");
  EXPECT_EQ(make(2, 2, 0, 1, {0, 0, 0, 0}), "map.csv: size_x: expected a positive extent in m, found 0");
  EXPECT_EQ(make(2, 2, 1, -3, {0, 0, 0, 0}), "map.csv: size_y: expected a positive extent in m, found -3");
  EXPECT_EQ(make(2, 2, 1, kNaN, {0, 0, 0, 0}), "map.csv: size_y: expected a positive extent in m, found nan");
  EXPECT_EQ(make(2, 2, kInfinity, 1, {0, 0, 0, 0}),
            "map.csv: size_x: expected a positive extent in m, found inf");
  EXPECT_EQ(make(2, 2, 1, 1, {0, 0, 0}), "map.csv: heights: expected 2 x 2 = 4 values, found 3");
  EXPECT_EQ(make(2, 2, 1, 1, {0, 0, 0, std::numeric_limits<float>::quiet_NaN()}),
            "map.csv: height at column 1, row 1: expected a finite number of m, found nan");
  EXPECT_EQ(make(2, 2, 1, 1, {0, std::numeric_limits<float>::infinity(), 0, 0}),
            "map.csv: height at column 1, row 0: expected a finite number of m, found inf");
}

// --- touch_sphere
// ---------------------------------------------------------------------------------------------------

/// Rounding of a few operations on lengths of at most some metres.
constexpr double kRounding = 1e-14;

void expect_contact(const SphereContact& contact, const Vector3& position, const Vector3& normal,
                    double distance) {
  EXPECT_LT((contact.position - position).norm(), kRounding) << contact.position.transpose();
  EXPECT_LT((contact.normal - normal).norm(), kRounding) << contact.normal.transpose();
  EXPECT_NEAR(contact.distance, distance, kRounding);
}

TEST(TouchSphere, RestsOnLevelGround) {
  const HeightField field = make_field(5, 5, 1, 1, [](double, double) { return 0.25; });
  SphereContact contact;
  ASSERT_TRUE(field.touch_sphere({0.1, -0.2, 0.25 + 0.09}, 0.1, contact));
  expect_contact(contact, {0.1, -0.2, 0.25 - 0.005}, Vector3::UnitZ(), -0.01);
}

TEST(TouchSphere, RestsOnASlope) {
  const HeightField field = make_field(9, 9, 4, 4, [](double x, double y) { return 0.5 * x - 0.25 * y; });
  const Vector3 normal = Vector3(-0.5, 0.25, 1).normalized();
  const Vector3 foot(0.3, 0.2, 0.5 * 0.3 - 0.25 * 0.2);
  for (const double length : {0.099, 0.05, 1e-6, 1e-12, 0.0, -1e-12, -1e-3, -0.5}) {
    SphereContact contact;
    ASSERT_TRUE(field.touch_sphere(foot + normal * length, 0.1, contact));
    EXPECT_LT((contact.normal - normal).norm(), kRounding) << length;
    EXPECT_NEAR(contact.distance, length - 0.1, kRounding);
    EXPECT_LT((contact.position - (foot + normal * ((length - 0.1) / 2))).norm(), kRounding) << length;
  }
}

TEST(TouchSphere, BalancesOnARidge) {
  // A roof along y, of slope 1.
  const HeightField field(3, 2, 2, 1, {0, 1, 0, 0, 1, 0});
  SphereContact contact;
  ASSERT_TRUE(field.touch_sphere({0, 0.1, 1.4}, 0.5, contact));
  expect_contact(contact, {0, 0.1, 0.95}, Vector3::UnitZ(), -0.1);
  // Within 45 degrees of the vertical the ridge itself is the closest.
  ASSERT_TRUE(field.touch_sphere({0.3, 0.1, 1.4}, 1, contact));
  const Vector3 normal(0.6, 0, 0.8);
  expect_contact(contact, Vector3(0, 0.1, 1) - normal * 0.25, normal, -0.5);
  // Beyond, the face is.
  ASSERT_TRUE(field.touch_sphere({0.5, 0.1, 0.7}, 0.5, contact));
  const Vector3 face = Vector3(1, 0, 1).normalized();
  const double length = 0.2 / std::sqrt(2.0);
  expect_contact(contact, Vector3(0.5, 0.1, 0.7) - face * ((length + 0.5) / 2), face, length - 0.5);
}

TEST(TouchSphere, BalancesOnAPeak) {
  const HeightField field(3, 3, 2, 2, {0, 0, 0, 0, 1, 0, 0, 0, 0});
  SphereContact contact;
  const Vector3 normal(2.0 / 15, 2.0 / 15 * std::sqrt(2.0), 0);
  const Vector3 direction = (Vector3(0, 0, 1) + normal).normalized();
  ASSERT_TRUE(field.touch_sphere(Vector3(0, 0, 1) + direction * 0.4, 0.5, contact));
  expect_contact(contact, Vector3(0, 0, 1) - direction * 0.05, direction, -0.1);
}

TEST(TouchSphere, GivesTheDeepestContactOfAValley) {
  // A ditch along y, of slope 1: two faces touch, the nearer one counts.
  const HeightField field(3, 2, 2, 1, {1, 0, 1, 1, 0, 1});
  SphereContact contact;
  ASSERT_TRUE(field.touch_sphere({0.05, 0.1, 0.5}, 0.5, contact));
  const double length = 0.45 / std::sqrt(2.0);
  EXPECT_NEAR(contact.distance, length - 0.5, kRounding);
  EXPECT_LT((contact.normal - Vector3(-1, 0, 1).normalized()).norm(), kRounding);
}

TEST(TouchSphere, PushesOutHoweverDeep) {
  const HeightField field = make_field(9, 9, 4, 4, [](double x, double) { return 0.75 * x; });
  const Vector3 normal(-0.6, 0, 0.8);
  SphereContact contact;
  ASSERT_TRUE(field.touch_sphere({1, 0.3, 0.75 - 5}, 0.01, contact));
  // 5 m of vertical depth are 4 m along the normal.
  expect_contact(contact, Vector3(1, 0.3, 0.75 - 5) - normal * ((-4 + 0.01) / 2), normal, -4.01);
}

TEST(TouchSphere, NeedsOverlap) {
  const HeightField field = make_field(3, 3, 1, 1, [](double, double) { return 0; });
  SphereContact contact;
  contact.distance = 77;
  EXPECT_FALSE(field.touch_sphere({0, 0, 0.5}, 0.5, contact));  // distance 0 touches but does not press
  EXPECT_FALSE(field.touch_sphere({0, 0, 0.6}, 0.5, contact));
  EXPECT_EQ(contact.distance, 77);
  EXPECT_TRUE(field.touch_sphere({0, 0, std::nextafter(0.5, 0.0)}, 0.5, contact));
  EXPECT_LT(contact.distance, 0);
}

TEST(TouchSphere, EndsAtTheBorder) {
  const HeightField field = make_field(3, 3, 1, 1, [](double, double) { return 0; });
  SphereContact contact;
  EXPECT_TRUE(field.touch_sphere({0.5, -0.5, 0.05}, 0.1, contact));
  EXPECT_FALSE(field.touch_sphere({0.501, 0, 0.05}, 0.1, contact));
  EXPECT_FALSE(field.touch_sphere({0, -0.501, 0.05}, 0.1, contact));
  EXPECT_FALSE(field.touch_sphere({3, 0, -5}, 0.1, contact));
}

TEST(TouchSphere, IgnoresWhatIsNotFinite) {
  const HeightField field = make_field(3, 3, 1, 1, [](double, double) { return 0; });
  SphereContact contact;
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    EXPECT_FALSE(field.touch_sphere({bad, 0, 0}, 0.1, contact));
    EXPECT_FALSE(field.touch_sphere({0, bad, 0}, 0.1, contact));
    EXPECT_FALSE(field.touch_sphere({0, 0, bad}, 0.1, contact));
  }
  EXPECT_FALSE(field.touch_sphere({0, 0, 0}, kNaN, contact));
}

TEST(TouchSphere, HasAFacesNormalOnItsEdges) {
  const HeightField field = random_field(13, 9, 0.02, 0.03F, 9);
  std::mt19937 generator(10);
  std::uniform_real_distribution<double> y(-0.08, 0.08);
  for (int i = 0; i < 300; ++i) {
    // So near an edge along y that the direction to the closest point is rounding error.
    Vector3 centre((i % 11 - 5) * 0.02, y(generator), 0);
    centre.z() = field.height(centre.x(), centre.y()) + 1e-16;
    SphereContact contact;
    ASSERT_TRUE(field.touch_sphere(centre, 0.008, contact));
    const Vector3 left = field.normal(centre.x() - 1e-9, centre.y());
    const Vector3 right = field.normal(centre.x() + 1e-9, centre.y());
    EXPECT_LT(std::min((contact.normal - left).norm(), (contact.normal - right).norm()), kRounding);
  }
}

using Triangle = std::array<Vector3, 3>;

std::vector<Triangle> triangles(const HeightField& field) {
  const auto vertex = [&](int c, int r) {
    return Vector3(c * field.cell_x() - field.size_x() / 2, r * field.cell_y() - field.size_y() / 2,
                   field.at(c, r));
  };
  std::vector<Triangle> result;
  for (int r = 0; r + 1 < field.rows(); ++r) {
    for (int c = 0; c + 1 < field.columns(); ++c) {
      result.push_back({vertex(c, r), vertex(c + 1, r), vertex(c + 1, r + 1)});
      result.push_back({vertex(c, r), vertex(c + 1, r + 1), vertex(c, r + 1)});
    }
  }
  return result;
}

Vector3 closest_on_segment(const Vector3& p, const Vector3& a, const Vector3& b) {
  const double t = (p - a).dot(b - a) / (b - a).squaredNorm();
  return a + (b - a) * std::clamp(t, 0.0, 1.0);
}

/// Another way than the one under test: the foot on the plane if it lies inside of all edges, else the best
/// of the edges.
Vector3 closest_on(const Vector3& p, const Triangle& triangle) {
  const Vector3 normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).normalized();
  const Vector3 foot = p - normal * normal.dot(p - triangle[0]);
  bool inside = true;
  Vector3 best = triangle[0];
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3& a = triangle[i];
    const Vector3& b = triangle[(i + 1) % 3];
    inside = inside && normal.cross(b - a).dot(foot - a) >= 0;
    const Vector3 candidate = closest_on_segment(p, a, b);
    if ((candidate - p).norm() < (best - p).norm()) best = candidate;
  }
  return inside ? foot : best;
}

TEST(TouchSphere, AgreesWithASearchOverAllTriangles) {
  // Cells of 0.02 m with 0.03 m of noise: steeper than any ground to walk on, spheres smaller and larger than
  // a cell.
  const HeightField field = random_field(13, 9, 0.02, 0.03F, 5);
  const std::vector<Triangle> all = triangles(field);
  std::mt19937 generator(6);
  std::uniform_real_distribution<double> x(-0.12, 0.12);
  std::uniform_real_distribution<double> y(-0.08, 0.08);
  std::uniform_real_distribution<double> above(0, 0.05);
  std::uniform_real_distribution<double> radius(0.002, 0.045);
  int touching = 0;
  for (int i = 0; i < 4000; ++i) {
    Vector3 centre(x(generator), y(generator), 0);
    centre.z() = field.height(centre.x(), centre.y()) + above(generator);
    const double r = radius(generator);
    double nearest = kInfinity;
    Vector3 point = Vector3::Zero();
    for (const Triangle& triangle : all) {
      const Vector3 candidate = closest_on(centre, triangle);
      if ((candidate - centre).norm() < nearest) {
        nearest = (candidate - centre).norm();
        point = candidate;
      }
    }
    SphereContact contact;
    ASSERT_EQ(field.touch_sphere(centre, r, contact), nearest < r) << i;
    if (nearest >= r) continue;
    ++touching;
    ASSERT_NEAR(contact.distance, nearest - r, kRounding) << i;
    // Two triangles may be equally near to rounding, so the contact is checked and not which triangle it is
    // on: its terrain point lies at `nearest` along the normal, and on the surface.
    const Vector3 on_terrain = contact.position - contact.normal * (contact.distance / 2);
    ASSERT_NEAR((centre - on_terrain).norm(), nearest, kRounding) << i;
    ASSERT_NEAR(field.height(on_terrain.x(), on_terrain.y()), on_terrain.z(), 1e-12)
        << i;  // slopes of up to 3
    ASSERT_LT((contact.normal - (centre - on_terrain) / nearest).norm(), 1e-9) << i;
    ASSERT_LT((on_terrain - point).norm(), 1e-7) << i;
  }
  EXPECT_GT(touching, 1000);
  EXPECT_LT(touching, 3500);
}

TEST(TouchSphere, ChangesContinuouslyThroughTheSurface) {
  const HeightField field = random_field(13, 9, 0.02, 0.01F, 7);
  std::mt19937 generator(8);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 500; ++i) {
    const Vector3 foot(0.11 * unit(generator), 0.07 * unit(generator), 0);
    const Vector3 on_surface(foot.x(), foot.y(), field.height(foot.x(), foot.y()));
    SphereContact above;
    SphereContact below;
    ASSERT_TRUE(field.touch_sphere(on_surface + Vector3(0, 0, 1e-8), 0.008, above));
    ASSERT_TRUE(field.touch_sphere(on_surface - Vector3(0, 0, 1e-8), 0.008, below));
    // 2e-8 m of travel; positions move no more, and normals agree to 1e-17 m / 1e-8 m on a face.
    EXPECT_NEAR(above.distance, below.distance, 2.1e-8);
    EXPECT_LT((above.position - below.position).norm(), 2.1e-8);
    EXPECT_LT((above.normal - below.normal).norm(), 1e-8);
  }
}

}  // namespace
}  // namespace crossgait
