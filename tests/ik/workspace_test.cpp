#include "ik/workspace.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "physics/core/error.h"
#include "tests/ik/test_leg.h"

namespace crossgait {
namespace {

using test::hand_made_leg;

constexpr RequiredMargins kNoMargins{-10, 0, 0};

TEST(Workspace, SamplesLieOnTheGridXFirst) {
  const TargetBox box{{-0.02, 0, -0.09}, {0.02, 0.01, -0.03}};
  const WorkspaceMap map = sample_workspace(hand_made_leg(), LegBranch{}, box, {3, 2, 4});
  ASSERT_EQ(map.samples.size(), 24u);
  EXPECT_EQ(map.target(0, 0, 0), box.min);
  EXPECT_EQ(map.target(2, 1, 3), box.max);
  EXPECT_EQ(&map.at(1, 0, 0), &map.samples[1]);
  EXPECT_EQ(&map.at(0, 1, 0), &map.samples[3]);
  EXPECT_EQ(&map.at(0, 0, 1), &map.samples[6]);
  for (int iz = 0; iz < 4; ++iz) {
    EXPECT_EQ(map.at(1, 1, iz).status, solve_leg(hand_made_leg(), map.target(1, 1, iz)).status);
  }
}

TEST(Workspace, ReachableFractionIsTheAreaOfTheLens) {
  // At y = 0 without tilt offsets the reachable set of the plane is two discs' lower common half minus the
  // folds.
  FiveBarGeometry g = hand_made_leg();
  const double R = 0.105, r = 0.015, c = 0.010;
  const WorkspaceMap map =
      sample_workspace(g, LegBranch{}, {{-0.1, 0, -0.11}, {0.1, 1e-9, 0}}, {801, 2, 441});
  const auto common = [&](double radius) {  // half the intersection of two discs whose centres are 2 c apart
    return radius * radius * std::acos(c / radius) - c * std::sqrt(radius * radius - c * c);
  };
  const auto whole = [&](double radius) { return std::acos(-1) / 2 * radius * radius; };
  const double fold = 2 * whole(r) - common(r);
  const double area = common(R) - fold;
  // Cells of 0.25 mm: an error of half a cell along a boundary of 0.5 m, over 0.022 m^2.
  EXPECT_NEAR(map.reachable_fraction() * 0.2 * 0.11, area, 0.5 * 0.125e-3);
}

TEST(Workspace, BoundsHoldEverythingReachable) {
  for (const Leg which : {Leg::FL, Leg::RR}) {
    const FiveBarGeometry g = hand_made_leg(which);
    const TargetBox bounds = reach_bounds(g);
    const WorkspaceMap map =
        sample_workspace(g, LegBranch{}, {{-0.2, -0.2, -0.2}, {0.2, 0.2, 0}}, {41, 41, 41});
    for (int iz = 0; iz < 41; ++iz) {
      for (int iy = 0; iy < 41; ++iy) {
        for (int ix = 0; ix < 41; ++ix) {
          const Vector3 p = map.target(ix, iy, iz);
          if (map.at(ix, iy, iz).status != IkStatus::kOk) continue;
          EXPECT_TRUE((p.array() >= bounds.min.array()).all() && (p.array() <= bounds.max.array()).all())
              << p.transpose();
        }
      }
    }
  }
}

TEST(Workspace, NonsenseGridsAreErrors) {
  const TargetBox box{{-0.02, 0, -0.09}, {0.02, 0.01, -0.03}};
  EXPECT_THROW(sample_workspace(hand_made_leg(), LegBranch{}, box, {3, 1, 4}), ConfigError);
  EXPECT_THROW(sample_workspace(hand_made_leg(), LegBranch{}, {box.max, box.min}, {3, 3, 4}), ConfigError);
  const TargetBox nan{{std::numeric_limits<double>::quiet_NaN(), 0, 0}, {1, 1, 1}};
  EXPECT_THROW(sample_workspace(hand_made_leg(), LegBranch{}, nan, {3, 3, 4}), ConfigError);
  EXPECT_THROW(sample_workspace(hand_made_leg(), LegBranch{}, box, {600, 600, 600}), ConfigError);
}

TEST(SafeDistance, IsPythagorasToTheReach) {
  // From (0, 0, -0.05) forward, chain a stretches first: 0.050 below its shoulder and 0.010 + x in front of
  // it.
  const double reach = std::sqrt(0.105 * 0.105 - 0.05 * 0.05) - 0.010;
  // Found to 1 um.
  EXPECT_NEAR(safe_distance(hand_made_leg(), {0, 0, -0.05}, {1, 0, 0}, LegBranch{}, kNoMargins), reach,
              1.1e-6);
  EXPECT_NEAR(safe_distance(hand_made_leg(), {0, 0, -0.05}, {-1, 0, 0}, LegBranch{}, kNoMargins), reach,
              1.1e-6);
  EXPECT_EQ(safe_distance(hand_made_leg(), {0, 0, -0.2}, {1, 0, 0}, LegBranch{}, kNoMargins), 0);
}

TEST(SafeDistance, ShrinksWithTheMargins) {
  const double reach = safe_distance(hand_made_leg(), {0, 0, -0.05}, {1, 0, 0}, LegBranch{}, kNoMargins);
  RequiredMargins bend = kNoMargins;
  bend.serial = 0.5;
  const double bent = safe_distance(hand_made_leg(), {0, 0, -0.05}, {1, 0, 0}, LegBranch{}, bend);
  // Chain a may stretch to sqrt(L1^2 + L2^2 + 2 L1 L2 cos 0.5) only.
  const double r2 = 0.045 * 0.045 + 0.06 * 0.06 + 2 * 0.045 * 0.06 * std::cos(0.5);
  EXPECT_NEAR(bent, std::sqrt(r2 - 0.05 * 0.05) - 0.010, 1.1e-6);  // found to 1 um
  EXPECT_LT(bent, reach);
}

TEST(SafeBox, HoldsOnlySafeTargetsAndCannotGrow) {
  const RequiredMargins required;
  const Vector3 centre(0, 0.03, -0.05);
  const TargetBox box = safe_box(hand_made_leg(), centre, LegBranch{});
  EXPECT_TRUE((box.min.array() < centre.array()).all() && (box.max.array() > centre.array()).all());
  const WorkspaceMap map = sample_workspace(hand_made_leg(), LegBranch{}, box, {23, 23, 23});
  ASSERT_EQ(map.samples.size(), 23U * 23U * 23U);
  for (const WorkspaceSample& sample : map.samples) EXPECT_TRUE(is_safe(sample, required));
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      TargetBox face = box;
      face.min[axis] = face.max[axis] = (sign > 0 ? box.max : box.min)[axis] + sign * 1e-3;
      const WorkspaceMap beyond = sample_workspace(hand_made_leg(), LegBranch{}, face, {81, 81, 81});
      EXPECT_TRUE(std::any_of(beyond.samples.begin(), beyond.samples.end(),
                              [&](const WorkspaceSample& s) { return !is_safe(s, required); }))
          << "axis " << axis << " sign " << sign;
    }
  }
}

TEST(SafeBox, IsMirroredForTheOtherSide) {
  const TargetBox left = safe_box(hand_made_leg(Leg::FL), {0, 0.03, -0.05}, LegBranch{}),
                  right = safe_box(hand_made_leg(Leg::FR), {0, -0.03, -0.05}, LegBranch{});
  // Faces move by whole millimetres; the sums differ by rounding.
  EXPECT_NEAR(left.min.x(), right.min.x(), 1e-3 + 1e-12);
  EXPECT_NEAR(left.max.z(), right.max.z(), 1e-3 + 1e-12);
  EXPECT_NEAR(left.max.y(), -right.min.y(), 1e-3 + 1e-12);
}

TEST(SafeBox, OfAnUnsafeCentreIsEmpty) {
  const TargetBox box = safe_box(hand_made_leg(), {0, 0, -0.2}, LegBranch{});
  EXPECT_EQ(box.min, box.max);
}

}  // namespace
}  // namespace crossgait
