// The measurements against what is known of them, in every engine. Nothing here looks at a clock's reading.
#include <algorithm>
#include <cmath>
#include <set>

#include "benchmarks/accuracy.h"
#include "benchmarks/convergence.h"
#include "benchmarks/feet.h"
#include "benchmarks/scaling.h"
#include "benchmarks/speed.h"
#include "scenes/analytic.h"
#include "tests/support/engine_test.h"

namespace crossgait::benchmarks {
namespace {

const Progress kSilent = [](double) {};

class Analytic : public EngineTest {};
CROSSGAIT_FOR_EVERY_BACKEND(Analytic);

TEST_P(Analytic, FreeFallIsLateByHalfAStep) {
  // Up to 1000 additions to a number of size 30, each rounded by up to 16 eps.
  for (const double h : {4e-3, 1e-3})
    EXPECT_NEAR(scenes::free_fall_error(find_engine(GetParam()), h), 9.81 * h / 2, 16000 * eps());
}

TEST_P(Analytic, OrdersAreThoseOfSemiImplicitEuler) {
  double last = 0;
  const auto results = measure_convergence({GetParam()}, [&last](double share) {
    EXPECT_GE(share, last);
    last = share;
  });
  EXPECT_NEAR(last, 1, 1e-12);
  ASSERT_EQ(results.size(), 4U);
  for (const Convergence& c : results) {
    ASSERT_EQ(c.error.size(), c.step_s.size());
    const int order = c.quantity == "pendulum_period" ? 2 : 1;
    // Errors of second order that are no larger than what rounding of a thousand steps comes to show none.
    const double rounding = 1000 * eps();
    if (order == 2 && *std::ranges::min_element(c.error) < rounding) {
      EXPECT_LT(*std::ranges::max_element(c.error), 2 * rounding);
      continue;
    }
    // At 4 ms a body that turns by 11 rad/s is 4 % of a radian further: so much of the next order shows.
    EXPECT_NEAR(c.order, order, 0.05) << c.quantity;
  }
}

TEST_P(Analytic, ABallLeavesSoftContactAsItsDamperLetsItAndHardContactNotAtAll) {
  constexpr double kStep = 1e-4;
  const double share = scenes::rebound(find_engine(GetParam()), kStep);
  if (!capabilities().soft_contact) {
    // Rigid contact has no restitution: what is left is a share of the way into the ground of one step,
    // undone.
    EXPECT_LT(share, 1e-3);
    return;
  }
  // x'' + 2 x' / t + x / (d t^2) = 0 (MuJoCo's law at a damping ratio of 1 and impedance d), until the force
  // on the ball, which cannot pull, is zero.
  const double d = ContactSpec{}.softness.impedance_max, ratio = std::sqrt(d),
               s = std::sqrt(1 - ratio * ratio);
  const double expected = std::exp(-ratio / s * std::atan2(2 * ratio * s, 2 * ratio * ratio - 1));
  // A step is 0.5 % of the time constant, and over the first 1 mm of 7 the impedance is less than d.
  EXPECT_NEAR(share / expected, 1, 0.05);
}

class Scenes : public EngineTest {};
CROSSGAIT_FOR_EVERY_BACKEND(Scenes);

TEST_P(Scenes, TouchTheGroundAsTheyShould) {
  std::set<std::string> names;
  for (const SpeedScene& scene : speed_scenes()) {
    EXPECT_TRUE(names.insert(scene.name).second);
    const double contacts = SceneRunner(scene, find_engine(GetParam())).count_contacts();
    if (scene.name.starts_with("trot")) {
      EXPECT_GT(contacts, 2);  // a pair stands, and the other one lands
      EXPECT_LT(contacts, 4);
    } else {
      EXPECT_EQ(contacts, scene.name == "swing" ? 0 : scene.name == "stand" ? 4 : 8 * 4) << scene.name;
    }
  }
  EXPECT_EQ(names, (std::set<std::string>{"swing", "stand", "trot_flat", "trot_rough", "pile"}));
}

TEST_P(Scenes, AreThoseOfTheRobotThatIsAskedFor) {
  const scenes::RobotPtr robot = scenes::serial_quadruped();
  for (const SpeedScene& scene : speed_scenes(robot)) {
    if (scene.name == "pile") continue;
    EXPECT_EQ(scene.spec.robot, robot) << scene.name;
    const double contacts = SceneRunner(scene, find_engine(GetParam())).count_contacts();
    EXPECT_GE(contacts, scene.name == "swing" ? 0 : 2) << scene.name;
    EXPECT_LE(contacts, scene.name == "swing" ? 0 : 4) << scene.name;
  }
  // A walk of another size would be out of reach of its legs.
  const OverheadSettings walk{.engines = {GetParam()}, .rounds = 1, .seconds = 0.2, .robot = robot};
  EXPECT_EQ(measure_overhead(walk, kSilent).size(), 2U);
}

TEST_P(Scenes, AreMeasuredInEveryRound) {
  const auto results = measure_speed({.engines = {GetParam()}, .rounds = 1}, kSilent);
  ASSERT_EQ(results.size(), speed_scenes().size());
  for (const SceneSpeed& s : results) {
    EXPECT_GT(s.us_per_step.median, 0);
    EXPECT_EQ(s.ratio.median, 1);  // to itself
  }
}

TEST_P(Scenes, TheWalkIsFollowedToTheBit) {
  // Throws if the recorded targets lead elsewhere.
  const auto results = measure_overhead({.engines = {GetParam()}, .rounds = 1, .seconds = 0.2}, kSilent);
  ASSERT_EQ(results.size(), 2U);
  for (const Overhead& o : results) EXPECT_GT(o.eta.median, 0);
}

TEST_P(Scenes, RunOnSeveralThreads) {
  const auto results =
      measure_scaling({.engines = {GetParam()}, .max_threads = 3, .rounds = 1, .repeats = 1}, kSilent);
  ASSERT_EQ(results.size(), 3U);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(results[static_cast<std::size_t>(i)].threads, i + 1);
  EXPECT_EQ(results[0].efficiency.median, 1);
}

class SelfConsistency : public EngineTest {};
CROSSGAIT_FOR_EVERY_BACKEND(SelfConsistency);

TEST_P(SelfConsistency, ErrorsShrinkWithTheStep) {
  const Accuracy a = measure_accuracy(
      {.engines = {GetParam()}, .terrains = {"flat"}, .steps_s = {4e-3, 1e-3, kReferenceStep}, .rounds = 1},
      kSilent);
  ASSERT_EQ(a.points.size(), 3U);
  // The trot's legs obey equations of first order in the step: a quarter, give or take the next order.
  ASSERT_TRUE(a.points[0].joint_error_rad && a.points[1].joint_error_rad);
  EXPECT_NEAR(*a.points[0].joint_error_rad / *a.points[1].joint_error_rad, 4, 1);
  EXPECT_GT(*a.points[0].position_error_m, 2 * *a.points[1].position_error_m);
  // The reference against itself.
  EXPECT_EQ(a.points[2].position_error_m, 0.0);
  EXPECT_EQ(a.points[2].joint_error_rad, 0.0);
  ASSERT_EQ(a.stable.size(), 1U);
  ASSERT_TRUE(a.stable[0].largest_s);
  EXPECT_TRUE(std::is_sorted(a.stable[0].tried_s.begin(), a.stable[0].tried_s.end()));
}

TEST_P(SelfConsistency, AnExplicitServoHasALargestStableStep) {
  EXPECT_TRUE(trot_survives(GetParam(), "flat", 1e-3));
  // Explicit damping d on a rotor of inertia I is stable up to 2 I / d = 20 ms.
  EXPECT_FALSE(trot_survives(GetParam(), "flat", 40e-3));
}

class Feet : public EngineTest {};
CROSSGAIT_FOR_EVERY_BACKEND(Feet);

TEST_P(Feet, StandAndStep) {
  const auto cards = measure_feet(
      {.engines = {GetParam()}, .terrains = {"flat"}, .stand_seconds = 2, .strides = 2}, kSilent);
  ASSERT_EQ(cards.size(), 1U);
  const FootCard& card = cards[0];
  EXPECT_EQ(card.stand_seconds, 2);
  EXPECT_LT(std::abs(card.force_error), 1e-3);  // as the conformance test of standing
  EXPECT_LT(card.creep_mps, 1e-3);
  if (capabilities().soft_contact) {  // what carries has given way; hard contact may be met exactly
    EXPECT_GT(card.penetration_m, 0);
  }
  EXPECT_LT(card.penetration_m, 2e-3);
  EXPECT_GT(card.touchdowns, 0);
  EXPECT_LE(card.touchdowns, 2 * kLegCount + 2);  // one per leg and stride, give or take one at either end
  EXPECT_GT(card.touchdown_impulse, 0);
  // The mean force of 10 ms cannot exceed the peak: impulse <= peak * 10 ms.
  EXPECT_LE(card.touchdown_impulse, card.touchdown_peak * scenes::quadruped()->total_mass() * 9.81 * 0.0101);
  EXPECT_GT(card.slip_per_stride_m, 0);
  EXPECT_LT(card.slip_per_stride_m, scenes::Trot::kStepLength);
}

}  // namespace
}  // namespace crossgait::benchmarks
