#include "ik/five_bar.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "tests/ik/test_leg.h"
#include "tests/support/constants.h"

namespace crossgait {
namespace {

using test::hand_made_leg;

constexpr double kPi = std::numbers::pi;
using test::kInfinity;
using test::kNaN;
constexpr double kUpper = 0.045, kLower = 0.060;
using test::kModes;

Vector2 link(double length, double angle) { return length * Vector2(std::cos(angle), std::sin(angle)); }
Vector2 tip(const TwoLinkSolution& s) { return link(kUpper, s.upper) + link(kLower, s.upper + s.elbow); }

Vector2 tip_a(const FiveBarSolution& s) { return Vector2(-0.010, 0) + tip(s.a); }
Vector2 tip_b(const FiveBarSolution& s) { return Vector2(0.010, 0) + tip(s.b); }

TEST(TwoLink, IsTheLawOfCosines) {
  for (const double sign : {1.0, -1.0}) {
    const TwoLinkSolution s = solve_two_link(kUpper, kLower, 0.02, 0.07, sign);
    const double r2 = 0.02 * 0.02 + 0.07 * 0.07;
    const double elbow = sign * std::acos((r2 - kUpper * kUpper - kLower * kLower) / (2 * kUpper * kLower));
    EXPECT_EQ(s.status, IkStatus::kOk);
    EXPECT_NEAR(s.elbow, elbow, 1e-14);  // a few roundings of an angle near 2
    const double upper =
        std::atan2(0.07, 0.02) - std::atan2(kLower * std::sin(elbow), kUpper + kLower * std::cos(elbow));
    EXPECT_NEAR(s.upper, upper, 1e-14);  // as above
  }
}

TEST(TwoLink, ReachesWhereTheCosineRuleIsExact) {
  // A 3-4-5 triangle: links 0.03 and 0.04 at a right angle, tip 0.05 away.
  const TwoLinkSolution s = solve_two_link(0.03, 0.04, 0, 0.05, 1);
  EXPECT_NEAR(s.elbow, kPi / 2, 1e-15);                     // rounding of an angle
  EXPECT_NEAR(s.upper, kPi / 2 - std::atan2(4, 3), 1e-15);  // as above
}

TEST(TwoLink, ClampsAlongTheRay) {
  const TwoLinkSolution far = solve_two_link(kUpper, kLower, 0.3, 0.4, 1);
  EXPECT_EQ(far.status, IkStatus::kClampedTooFar);
  // The straight chain's bend is the root of a rounding error: 1e-8 rad, which moves the tip by its square.
  EXPECT_LT((tip(far) - (kUpper + kLower) * Vector2(0.6, 0.8)).norm(), 1e-15);
  const TwoLinkSolution near = solve_two_link(kUpper, kLower, 0.003, 0.004, -1);
  EXPECT_EQ(near.status, IkStatus::kClampedTooNear);
  EXPECT_LT((tip(near) - (kLower - kUpper) * Vector2(0.6, 0.8)).norm(), 1e-15);  // as above
}

TEST(TwoLink, EqualLinksFoldAlmostToAPoint) {
  const TwoLinkSolution s = solve_two_link(0.05, 0.05, 0, 0, 1);
  EXPECT_EQ(s.status, IkStatus::kClampedTooNear);
  EXPECT_TRUE(std::isfinite(s.upper) && std::isfinite(s.elbow));
}

TEST(TwoLink, NonsenseIsReportedAndFinite) {
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    for (const TwoLinkSolution& s :
         {solve_two_link(kUpper, kLower, bad, 0.05, 1), solve_two_link(kUpper, kLower, 0.05, bad, -1)}) {
      EXPECT_EQ(s.status, IkStatus::kInvalidTarget);
      EXPECT_TRUE(std::isfinite(s.upper) && std::isfinite(s.elbow));
    }
  }
  const TwoLinkSolution huge = solve_two_link(kUpper, kLower, 1e308, -1e308, 1);
  EXPECT_EQ(huge.status, IkStatus::kClampedTooFar);
  EXPECT_TRUE(std::isfinite(huge.upper) && std::isfinite(huge.elbow));
}

TEST(FiveBar, ModesBendTheKneesAsNamed) {
  // Straight below, knees measured forward (+x) of the line from each shoulder to the foot.
  const auto forward_knees = [](WorkingMode mode) {
    const FiveBarSolution s = solve_five_bar(hand_made_leg(), 0, 0.07, mode);
    const auto side = [](const TwoLinkSolution& chain, double shoulder_x) {
      return cross(link(kUpper, chain.upper), Vector2(-shoulder_x, 0.07)) > 0;
    };
    return std::pair(side(s.a, -0.010), side(s.b, 0.010));
  };
  EXPECT_EQ(forward_knees(WorkingMode::kUpDown), std::pair(true, false));
  EXPECT_EQ(forward_knees(WorkingMode::kDownUp), std::pair(false, true));  // the default: knees outward
  EXPECT_EQ(forward_knees(WorkingMode::kBothUp), std::pair(true, true));
  EXPECT_EQ(forward_knees(WorkingMode::kBothDown), std::pair(false, false));
}

TEST(FiveBar, BothTipsMeetAtTheTargetInEveryMode) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> x(-0.09, 0.09), depth(0, 0.105);
  int reachable = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vector2 target(x(random), depth(random));
    for (const WorkingMode mode : kModes) {
      const FiveBarSolution s = solve_five_bar(hand_made_leg(), target.x(), target.y(), mode);
      if (s.status != IkStatus::kOk) continue;
      ++reachable;
      // A dozen roundings of lengths of 0.1 m (1e-17 each); next to a straight chain the root magnifies them.
      ASSERT_LT((tip_a(s) - target).norm(), 1e-13) << target.transpose();
      ASSERT_LT((tip_b(s) - target).norm(), 1e-13) << target.transpose();
      const ElbowSigns signs = elbow_signs(mode);
      ASSERT_GE(signs.a * s.a.elbow, 0);
      ASSERT_GE(signs.b * s.b.elbow, 0);
    }
  }
  EXPECT_GT(reachable, 40000);  // the sampled box is mostly workspace
}

TEST(FiveBar, OutOfReachGoesToTheNearestReachablePoint) {
  // Against brute force over the boundary of the two reaches (lower half), for targets all around.
  const double reach = kUpper + kLower;
  for (double angle = 0.01; angle < kPi; angle += 0.05) {
    const Vector2 target = link(0.2, angle);
    Vector2 p = target;
    ASSERT_EQ(clamp_to_workspace(hand_made_leg(), p), IkStatus::kClampedTooFar);
    double nearest = kInfinity;
    for (double t = 0; t <= kPi; t += 1e-4) {
      for (const double centre : {-0.010, 0.010}) {
        const Vector2 candidate = Vector2(centre, 0) + link(reach, t);
        if ((candidate - Vector2(-centre, 0)).norm() <= reach) {
          nearest = std::min(nearest, (candidate - target).norm());
        }
      }
    }
    // The boundary was sampled every 1e-5 m, and its corner may fall between two samples.
    EXPECT_NEAR((p - target).norm(), nearest, 1e-5) << target.transpose();
    // Never beyond the true nearest point.
    EXPECT_LE((p - target).norm(), nearest + 1e-15);
  }
}

TEST(FiveBar, TooNearGoesDownToTheFold) {
  Vector2 p(0.002, 0.001);
  EXPECT_EQ(clamp_to_workspace(hand_made_leg(), p), IkStatus::kClampedTooNear);
  const double fold = kLower - kUpper;
  EXPECT_EQ(p.x(), 0.002);
  EXPECT_NEAR(p.y(), std::sqrt(fold * fold - 0.008 * 0.008), 1e-15);  // the nearer shoulder is at 0.010
  Vector2 above(0.03, -0.02);
  EXPECT_EQ(clamp_to_workspace(hand_made_leg(), above), IkStatus::kClampedTooNear);
  EXPECT_EQ(above, Vector2(0.03, 0));
}

TEST(FiveBar, ClampingIsContinuous) {
  // Moving the request by 1e-7 m moves the answer by at most a bounded multiple: 1 for projections, and less
  // than 1000 where the fold's boundary is steep (the root of 1e-7 is 3e-4, hence the bound on steps across
  // its ends).
  std::mt19937 random(2);
  std::uniform_real_distribution<double> coordinate(-0.2, 0.2), angle(0, 2 * kPi);
  for (int i = 0; i < 50000; ++i) {
    Vector2 p(coordinate(random), coordinate(random));
    Vector2 q = p + link(1e-7, angle(random));
    static_cast<void>(clamp_to_workspace(hand_made_leg(), p));
    static_cast<void>(clamp_to_workspace(hand_made_leg(), q));
    ASSERT_LT((p - q).norm(), 1e-4) << p.transpose();
  }
}

TEST(FiveBar, ClampedPointsAreReachable) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> coordinate(-0.3, 0.3);
  for (int i = 0; i < 20000; ++i) {
    Vector2 p(coordinate(random), coordinate(random));
    static_cast<void>(clamp_to_workspace(hand_made_leg(), p));
    const FiveBarSolution s = solve_five_bar(hand_made_leg(), p.x(), p.y(), kDefaultMode);
    ASSERT_LT((tip_a(s) - p).norm(), 1e-13);  // as for reachable targets
    ASSERT_LT((tip_b(s) - p).norm(), 1e-13);
  }
}

TEST(FiveBar, NonsenseIsReportedAndFinite) {
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    const FiveBarSolution s = solve_five_bar(hand_made_leg(), 0, bad, kDefaultMode);
    EXPECT_EQ(s.status, IkStatus::kInvalidTarget);
    EXPECT_TRUE(tip_a(s).allFinite() && tip_b(s).allFinite());
  }
}

TEST(FiveBar, ElbowsTooFarApartDoNotClose) {
  FiveBarGeometry g = hand_made_leg();
  g.a.lower = g.b.lower = 0.050;
  // Knees straight out: 0.110 apart, lower links 0.050 each.
  const FiveBarClosure open = close_five_bar(g, {-0.045, 0}, {0.045, 0}, kDefaultMode);
  EXPECT_FALSE(open.closed);
  EXPECT_TRUE(open.foot.allFinite());
  const FiveBarClosure closed = close_five_bar(hand_made_leg(), {-0.045, 0}, {0.045, 0}, kDefaultMode);
  EXPECT_TRUE(closed.closed);
  EXPECT_NEAR(closed.foot.y(), std::sqrt(0.060 * 0.060 - 0.055 * 0.055), 1e-16);  // Pythagoras
  EXPECT_FALSE(close_five_bar(hand_made_leg(), {0.010, 0.03}, {-0.010, 0.03}, kDefaultMode)
                   .closed);  // elbows in one point
}

TEST(WorkingModes, AreNumberedOneToFour) {
  EXPECT_EQ(working_mode(2), WorkingMode::kDownUp);
  EXPECT_FALSE(working_mode(0));
  EXPECT_FALSE(working_mode(5));
}

TEST(IkStatusNames, AreStable) {
  EXPECT_EQ(name(IkStatus::kOk), "ok");
  EXPECT_EQ(name(IkStatus::kClampedTooFar), "clamped_too_far");
  EXPECT_EQ(name(IkStatus::kClampedTooNear), "clamped_too_near");
  EXPECT_EQ(name(IkStatus::kClampedJointLimit), "clamped_joint_limit");
  EXPECT_EQ(name(IkStatus::kInvalidTarget), "invalid_target");
}

}  // namespace
}  // namespace crossgait
