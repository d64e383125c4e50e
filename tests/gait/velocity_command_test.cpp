#include "gait/velocity_command.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "physics/core/error.h"
#include "tests/support/constants.h"

namespace crossgait {
namespace {

using test::kNaN;

LegArray<Vector2> square() {
  LegArray<Vector2> feet;
  for (const Leg leg : kLegs) feet[leg] = {is_front(leg) ? 0.1 : -0.1, side_sign(leg) * 0.08};
  return feet;
}

TEST(FootVelocities, OfATranslationAreTheBodys) {
  for (const Vector2& v : foot_velocities({0.2, -0.1, 0}, square())) EXPECT_EQ(v, Vector2(0.2, -0.1));
}

TEST(FootVelocities, OfATurnAreTangents) {
  const LegArray<Vector2> feet = square();
  const LegArray<Vector2> v = foot_velocities({0, 0, 0.5}, feet);
  for (const Leg leg : kLegs) {
    EXPECT_EQ(v[leg].dot(feet[leg]), 0);
    EXPECT_NEAR(v[leg].norm(), 0.5 * feet[leg].norm(), 1e-17);  // rounding of centimetres per second
  }
  EXPECT_GT(v[Leg::FL].y(), 0);  // turning left the front goes left
  EXPECT_LT(v[Leg::FL].x(), 0);  // and the left side back
}

TEST(PlanSteps, TakesVelocityTimesStanceTime) {
  const StepPlan plan = plan_steps(foot_velocities({0.1, 0.05, 0}, square()), 0.4, {});
  EXPECT_EQ(plan.limit_factor, 1);
  for (const Vector2& step : plan.step) EXPECT_EQ(step, Vector2(0.1 * 0.4, 0.05 * 0.4));
}

TEST(PlanSteps, ScalesAllStepsWhenOneIsTooLong) {
  const LegArray<Vector2> velocity = foot_velocities({0.2, 0, 1}, square());
  const StepLimits limits{0.05, 0.02};
  const StepPlan plan = plan_steps(velocity, 0.4, limits);
  EXPECT_LT(plan.limit_factor, 1);
  double longest = 0;
  for (const Leg leg : kLegs) {
    EXPECT_LT((plan.step[leg] - plan.limit_factor * 0.4 * velocity[leg]).norm(),
              1e-17);  // rounding of centimetres
    longest = std::max(longest, std::hypot(plan.step[leg].x() / 0.05, plan.step[leg].y() / 0.02));
  }
  EXPECT_NEAR(longest, 1, 1e-15);  // exactly on the ellipse, but for rounding
}

TEST(PlanSteps, OfNothingIsNothing) {
  const StepPlan plan = plan_steps(foot_velocities({}, square()), 0.4, {});
  EXPECT_EQ(plan.limit_factor, 1);
  for (const Vector2& step : plan.step) EXPECT_EQ(step, Vector2(0, 0));
}

TEST(VelocityCommand, KnowsWhetherItIsFinite) {
  EXPECT_TRUE(VelocityCommand().is_finite());
  EXPECT_FALSE((VelocityCommand{kNaN, 0, 0}.is_finite()));
  EXPECT_FALSE((VelocityCommand{0, std::numeric_limits<double>::infinity(), 0}.is_finite()));
  EXPECT_FALSE((VelocityCommand{0, 0, kNaN}.is_finite()));
}

TEST(StepLimits, MustBePositive) {
  EXPECT_NO_THROW(validate(StepLimits{}, "here"));
  for (const StepLimits& bad : {StepLimits{0, 0.1}, StepLimits{0.1, -1}, StepLimits{kNaN, 0.1}}) {
    EXPECT_THROW(validate(bad, "here"), ConfigError);
  }
}

}  // namespace
}  // namespace crossgait
