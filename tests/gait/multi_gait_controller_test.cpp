#include "gait/multi_gait_controller.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "physics/core/error.h"
#include "tests/gait/test_robot.h"

namespace crossgait {
namespace {

using test::kDt;

// The guide's numbers are round.
MultiGaitController by_speed(const MultiGaitOptions& options = guide_multi_gait_options()) {
  return {options, test::leg_origins()};
}

void run(MultiGaitController& c, double seconds) {
  for (int i = 0; i < std::lround(seconds / kDt); ++i) c.update(kDt);
}

/// Name of the gait after `speed` was set.
std::string_view gait_at(MultiGaitController& c, double speed) {
  EXPECT_TRUE(c.set_speed(speed));
  return c.generator().gait().name;
}

TEST(MultiGait, StandsUntilCommanded) {
  MultiGaitController c = by_speed();
  run(c, 2);
  EXPECT_TRUE(c.generator().is_standing());
  for (const FootTarget& foot : c.generator().targets()) {
    EXPECT_EQ(foot.position.x(), 0);
    EXPECT_FALSE(foot.swing);
  }
}

TEST(MultiGait, WalksSlowlyAndTrotsOtherwise) {
  MultiGaitController c = by_speed(MultiGaitOptions());
  EXPECT_EQ(gait_at(c, 0.07), "walk");
  EXPECT_EQ(c.generator().parameters().cycle_time, find_gait("walk").preferred.cycle_time);
  EXPECT_EQ(gait_at(c, 0.08), "trot");
  EXPECT_EQ(gait_at(c, 0.75), "trot");
  EXPECT_EQ(c.generator().parameters().duty_factor, find_gait("trot").preferred.duty_factor);
}

TEST(MultiGait, HasTheGuidesThresholdsAndCycleTimes) {
  for (const auto& [speed, gait, cycle] :
       {std::tuple(0.05, "walk:guide", 1.2), std::tuple(0.1, "trot:guide", 0.8),
        std::tuple(0.2, "trot:guide", 0.8)}) {
    MultiGaitController c = by_speed();
    EXPECT_EQ(gait_at(c, speed), gait);
    EXPECT_EQ(c.generator().parameters().cycle_time, cycle);
  }
  MultiGaitController c = by_speed();
  EXPECT_EQ(gait_at(c, 0.3), "gallop:guide");
  EXPECT_LE(c.generator().parameters().cycle_time, 0.6);
}

TEST(MultiGait, ChangesBackOnlyPastTheHysteresis) {
  MultiGaitController c = by_speed();
  EXPECT_EQ(gait_at(c, 0.09), "walk:guide");
  EXPECT_EQ(gait_at(c, 0.11), "trot:guide");
  EXPECT_EQ(gait_at(c, 0.09), "trot:guide");
  EXPECT_EQ(gait_at(c, 0.079), "walk:guide");
  EXPECT_EQ(gait_at(c, 0.09), "walk:guide");
  EXPECT_EQ(gait_at(c, 0.35), "gallop:guide");
  EXPECT_EQ(gait_at(c, 0.29), "gallop:guide");
  EXPECT_EQ(gait_at(c, 0.27), "trot:guide");
  EXPECT_EQ(gait_at(c, 0.35), "gallop:guide");
  EXPECT_EQ(gait_at(c, 0.01), "walk:guide");  // from the fastest to the slowest at once
}

TEST(MultiGait, FollowsTheCommandedSpeedInEveryGait) {
  for (const double speed : {0.05, -0.05, 0.2, -0.2, 0.31}) {
    MultiGaitController c = by_speed();
    ASSERT_TRUE(c.set_speed(speed));
    run(c, 6);
    ASSERT_TRUE(c.generator().in_step());
    ASSERT_EQ(c.generator().limit_factor(), 1) << speed;
    LegArray<FootTarget> before = c.generator().targets();
    int checked = 0;
    for (int i = 0; i < 500; ++i) {
      c.update(kDt);
      for (const Leg leg : kLegs) {
        const FootTarget& foot = c.generator().targets()[leg];
        if (!foot.swing && !before[leg].swing && foot.phase > before[leg].phase) {
          // Differences of centimetres over 2 ms.
          EXPECT_NEAR((foot.position.x() - before[leg].position.x()) / kDt, -speed, 1e-11);
          ++checked;
        }
      }
      before = c.generator().targets();
    }
    EXPECT_GT(checked, 500);
  }
}

TEST(MultiGait, ShortensTheCycleBeforeItLimitsTheSpeed) {
  MultiGaitController c = by_speed();
  // Gallop stands 0.75 of 0.6 s: at 0.3 m/s steps of 0.135 m, longer than 0.10 m unless the cycle shrinks to
  // 0.444 s.
  ASSERT_TRUE(c.set_speed(0.3));
  run(c, 5);
  EXPECT_NEAR(c.generator().parameters().cycle_time, 0.10 / (0.75 * 0.3), 1e-12);  // and a hair less
  EXPECT_EQ(c.generator().limit_factor(), 1);
  // At 1 m/s not even the shortest cycle will do: 0.75 * 0.4 s * 1 m/s is beyond the limit.
  ASSERT_TRUE(c.set_speed(1));
  run(c, 5);
  EXPECT_EQ(c.generator().parameters().cycle_time, 0.4);
  EXPECT_NEAR(c.generator().limit_factor(), 0.13 / 0.3, 1e-15);  // roundings of a number below one
}

TEST(MultiGait, ShortensTheCycleWhereStepsGetLong) {
  MultiGaitOptions options;
  MultiGaitController c = by_speed(options);
  const GaitParameters trot = find_gait("trot").preferred;
  const auto cycle_at = [&](double speed) {
    EXPECT_TRUE(c.set_speed(speed));
    return c.generator().parameters().cycle_time;
  };
  const double from = options.longest_step / (trot.duty_factor * trot.cycle_time);
  EXPECT_EQ(cycle_at(0.99 * from), trot.cycle_time);
  EXPECT_NEAR(cycle_at(1.25 * from), trot.cycle_time / 1.25, 1e-12);  // and a hair less
  EXPECT_EQ(cycle_at(10 * from), options.shortest_cycle);
}

TEST(MultiGait, TurnsInPlaceWithTheGaitForItsFeet) {
  MultiGaitController c = by_speed();
  ASSERT_TRUE(c.set_command({0, 0, 0.4}));
  // The feet stand (0.075, 0.102) from the middle: 0.127 m at 0.4 rad/s are 0.05 m/s.
  EXPECT_EQ(c.generator().gait().name, "walk:guide");
  run(c, 4);
  const LegArray<Vector2>& step = c.generator().effective().step;
  EXPECT_LT((step[Leg::FL] + step[Leg::RR]).norm(), 1e-17);  // opposite corners go opposite ways; rounding
  EXPECT_LT(step[Leg::FL].x(), 0);
  EXPECT_GT(step[Leg::FL].y(), 0);
  ASSERT_TRUE(c.set_command({0, 0, 1.5}));
  EXPECT_EQ(c.generator().gait().name, "trot:guide");
}

TEST(MultiGait, StopsAndStands) {
  MultiGaitController c = by_speed();
  ASSERT_TRUE(c.set_speed(0.4));
  run(c, 3);
  ASSERT_TRUE(c.set_speed(0));
  run(c, 3);
  EXPECT_TRUE(c.generator().is_standing());
}

TEST(MultiGait, CanBeForced) {
  MultiGaitController c = by_speed();
  c.force_gait(find_gait("pace"));
  EXPECT_EQ(gait_at(c, 0.05), "pace");
  EXPECT_EQ(gait_at(c, 0.25), "pace");
  c.choose_gait_by_speed();
  EXPECT_EQ(c.generator().gait().name, "trot:guide");
  Gait own_trot = find_gait("trot:guide");  // a gait is what it does, not what it is called
  own_trot.preferred.duty_factor = 0.6;
  c.force_gait(own_trot);
  EXPECT_EQ(c.generator().parameters().duty_factor, 0.6);
}

TEST(MultiGait, UsesItsParametersButTheGaitsCycleTime) {
  MultiGaitOptions options = guide_multi_gait_options();
  options.parameters = guide_adaptive_parameters();
  options.parameters->body_height = 0.045;
  MultiGaitController c = by_speed(options);
  ASSERT_TRUE(c.set_speed(0.05));
  EXPECT_EQ(c.generator().parameters().body_height, 0.045);
  EXPECT_EQ(c.generator().parameters().cycle_time, 1.2);
  GaitParameters p = guide_adaptive_parameters();
  p.body_height = 0.04;
  ASSERT_TRUE(c.set_parameters(p));
  EXPECT_EQ(c.generator().parameters().body_height, 0.04);
  p.body_height = -1;
  EXPECT_FALSE(c.set_parameters(p));
  EXPECT_EQ(c.generator().parameters().body_height, 0.04);
}

TEST(MultiGait, WithoutParametersUsesEveryGaitsPreferred) {
  MultiGaitOptions options = guide_multi_gait_options();
  options.bands[1].gait.preferred.body_height = 0.042;
  MultiGaitController c = by_speed(options);
  ASSERT_TRUE(c.set_speed(0.2));
  EXPECT_EQ(c.generator().parameters().body_height, 0.042);
  ASSERT_TRUE(c.set_speed(0.05));
  EXPECT_EQ(c.generator().parameters().body_height, options.bands[0].gait.preferred.body_height);
}

TEST(MultiGait, ResetStandsAgain) {
  MultiGaitController c = by_speed();
  ASSERT_TRUE(c.set_speed(0.4));
  c.force_gait(find_gait("bound"));
  run(c, 1);
  c.reset();
  EXPECT_TRUE(c.generator().is_standing());
  EXPECT_EQ(c.command().vx, 0);
  EXPECT_EQ(c.generator().gait().name, "walk:guide");
  EXPECT_EQ(gait_at(c, 0.2), "trot:guide");
}

TEST(MultiGait, RefusesNonsenseCommands) {
  MultiGaitController c = by_speed();
  ASSERT_TRUE(c.set_speed(0.2));
  EXPECT_FALSE(c.set_speed(std::nan("")));
  EXPECT_FALSE(c.set_command({0, std::numeric_limits<double>::infinity(), 0}));
  EXPECT_EQ(c.command().vx, 0.2);
  EXPECT_EQ(c.generator().gait().name, "trot:guide");
}

TEST(MultiGait, BadOptionsAreErrors) {
  const auto with = [](const auto& change) {
    MultiGaitOptions options = guide_multi_gait_options();
    change(options);
    by_speed(options);
  };
  EXPECT_THROW(with([](MultiGaitOptions& o) { o.bands.clear(); }), ConfigError);
  EXPECT_THROW(with([](MultiGaitOptions& o) { o.bands[1].below = 0.05; }), ConfigError);
  EXPECT_THROW(with([](MultiGaitOptions& o) { o.bands[0].gait.preferred.duty_factor = 0; }), ConfigError);
  EXPECT_THROW(with([](MultiGaitOptions& o) { o.hysteresis = -0.1; }), ConfigError);
  EXPECT_THROW(with([](MultiGaitOptions& o) { o.longest_step = 0; }), ConfigError);
  EXPECT_THROW(with([](MultiGaitOptions& o) { o.longest_step = 2 * o.limits.max_x; }), ConfigError);
  EXPECT_THROW(with([](MultiGaitOptions& o) { o.shortest_cycle = 0; }), ConfigError);
  EXPECT_THROW(with([](MultiGaitOptions& o) { o.limits.max_x = 0; }), ConfigError);
  EXPECT_THROW(with([](MultiGaitOptions& o) { o.parameters = GaitParameters{.cycle_time = 0}; }),
               ConfigError);
}

}  // namespace
}  // namespace crossgait
