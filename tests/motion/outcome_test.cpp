#include "motion/outcome.h"

#include <functional>

#include <gtest/gtest.h>

#include "motion/closed_loop.h"
#include "motion/motion_statistics.h"
#include "physics/core/error.h"
#include "physics/robot/hips.h"
#include "scenes/scenes.h"
#include "tests/support/constants.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

TEST(Outcomes, TheTableIsInTheOrderOfTheEnumeration) {
  ASSERT_EQ(outcome_rows().size(), kOutcomes);
  for (std::size_t i = 0; i < kOutcomes; ++i) {
    const OutcomeRow& row = outcome_rows()[i];
    EXPECT_EQ(static_cast<std::size_t>(row.outcome), i);
    EXPECT_EQ(name(row.outcome), row.name);
    EXPECT_EQ(find_outcome(row.name), row.outcome);
  }
  try {
    (void)find_outcome("stumbled");
    FAIL() << "an unknown outcome was found";
  } catch (const ConfigError& error) {
    for (const OutcomeRow& row : outcome_rows())
      EXPECT_NE(std::string(error.what()).find(row.name), std::string::npos) << row.name;
  }
}

TEST(Outcomes, WalksEndWithTheirTerrainAndEpisodesByAllThatIsKnownAtOnce) {
  for (const OutcomeRow& row : outcome_rows()) {
    EXPECT_EQ(OutcomeSet::of_walks().has(row.outcome),
              row.outcome == Outcome::kDiverged || row.outcome == Outcome::kLeftTerrain)
        << row.name;
    // What the user's own terminations say is known to them alone.
    const bool at_once = row.outcome < Outcome::kSlid && row.outcome != Outcome::kTerminated;
    EXPECT_EQ(row.at_once, at_once) << row.name;
    EXPECT_EQ(OutcomeSet::of_episodes().has(row.outcome), at_once) << row.name;
  }
}

TEST(OutcomeLimits, AreCheckedByName) {
  EXPECT_NO_THROW(OutcomeLimits{}.validate("limits"));
  using test::kNaN;
  using L = OutcomeLimits;
  const std::vector<std::pair<const char*, double L::*>> limits{
      {"tilt_limit_deg", &L::tilt_deg},
      {"low_height", &L::low_height},
      {"nonfoot_contact_load", &L::nonfoot_contact_load},
      {"low_seconds", &L::low_seconds},
      {"load_smoothing", &L::load_smoothing},
      {"loop_gap", &L::loop_gap},
      {"slip", &L::slip},
      {"slip_path", &L::slip_path},
      {"commanded_path", &L::commanded_path},
      {"commanded_turn", &L::commanded_turn},
      {"no_progress", &L::no_progress},
      {"no_progress_speed", &L::no_progress_speed},
      {"strayed_deg", &L::strayed_deg},
      {"too_slow", &L::too_slow}};
  for (const auto& [element, member] : limits) {
    for (const double bad : {0.0, -1.0, kNaN, 1e9}) {
      OutcomeLimits wrong;
      wrong.*member = bad;
      try {
        wrong.validate("limits");
        ADD_FAILURE() << element << " may be " << bad;
      } catch (const ConfigError& error) {
        EXPECT_NE(std::string(error.what()).find(element), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find("limits"), std::string::npos) << error.what();
      }
    }
  }
  const std::vector<std::pair<double L::*, double>> most{{&L::tilt_deg, 180},           {&L::low_height, 1},
                                                         {&L::nonfoot_contact_load, 1}, {&L::no_progress, 1},
                                                         {&L::strayed_deg, 90},         {&L::too_slow, 1}};
  for (const auto& [member, value] : most) {
    OutcomeLimits edge;
    edge.*member = value;
    EXPECT_NO_THROW(edge.validate("limits"));
    edge.*member = value * 1.001;
    EXPECT_THROW(edge.validate("limits"), ConfigError);
  }
}

TEST(MotionStatistics, OfSeveralOutcomesTheFirstOfTheListIsTheOutcome) {
  const auto world = make_world(available_engines().front(), scenes::world_of(scenes::quadruped()));
  MotionStatistics statistics(world->robot());
  for (const OutcomeRow& worse : outcome_rows()) {
    if (!worse.at_once) continue;
    for (const OutcomeRow& better : outcome_rows()) {
      if (!better.at_once || better.outcome < worse.outcome) continue;
      for (const bool worse_first : {true, false}) {
        statistics.begin(*world, 0.07);
        EXPECT_EQ(statistics.summary(*world).outcome, Outcome::kWalked);
        statistics.note(worse_first ? worse.outcome : better.outcome);
        EXPECT_EQ(statistics.summary(*world).outcome, (worse_first ? worse : better).outcome);
        statistics.note(worse_first ? better.outcome : worse.outcome);
        EXPECT_EQ(statistics.summary(*world).outcome, worse.outcome) << worse.name << ", " << better.name;
        EXPECT_TRUE(statistics.any(OutcomeSet().add(better.outcome)));
      }
    }
  }
  statistics.begin(*world, 0.07);
  EXPECT_FALSE(statistics.any(OutcomeSet::of_episodes()));
}

/// A world in which a motion is made up of states that a test puts the robot into.
class MadeUpMotion : public ::testing::Test {
 protected:
  static constexpr double kStanding = 0.07, kDt = 2e-3;  // m, s

  /// Control steps at that height of the hips' middle, m.
  void hold(double height, int steps) {
    RobotState state = world_->home_state();
    state.p_WB.z() = height - hips_;
    world_->reset(state);
    for (int i = 0; i < steps; ++i) statistics_.add_control_step(*world_, {}, kDt);
  }
  bool collapsed() const { return statistics_.has(Outcome::kCollapsed); }

  std::unique_ptr<PhysicsBackend> world_ =
      make_world(available_engines().front(), scenes::world_of(scenes::quadruped()));
  MotionStatistics statistics_{world_->robot()};
  double hips_ = hip_middle(world_->robot()).z();  // over the base's origin, m
};

TEST_F(MadeUpMotion, IsDownOnlyAfterHalfASecondWithoutABreak) {
  statistics_.begin(*world_, kStanding - hips_);
  hold(0.51 * kStanding, 1000);
  hold(0.49 * kStanding, 249);
  EXPECT_FALSE(collapsed());
  hold(0.51 * kStanding, 1);
  hold(0.49 * kStanding, 249);
  EXPECT_FALSE(collapsed());
  hold(0.49 * kStanding, 1);
  EXPECT_TRUE(collapsed());
  const MotionSummary m = statistics_.summary(*world_);
  EXPECT_DOUBLE_EQ(*m.first_at_s[static_cast<std::size_t>(Outcome::kCollapsed)], 1500 * kDt);
  EXPECT_DOUBLE_EQ(m.simulated_seconds, 1500 * kDt);
}

TEST_F(MadeUpMotion, CountsItsTimeInSteps) {
  // A time that is a sum of ten thousand decimals would be off by 1e-11 s.
  statistics_.begin(*world_, kStanding);
  hold(kStanding, 10'000);
  EXPECT_EQ(statistics_.summary(*world_).simulated_seconds, 10'000 * kDt);
}

/// Motions along straight lines, of a robot that faces `yaw` at the start, asked for 0.5 m/s in a direction.
class AskedMotion : public MadeUpMotion {
 protected:
  struct Made {
    double off = 0;      // of its way from the command's direction, rad
    double speed = 0.5;  // m/s
    double turning = 0;  // rad/s
    double asked = 0.5;  // m/s
    double asked_turning = 0;
  };

  /// The outcome of 4 s.
  Outcome of(const Made& made, double yaw = 0.7, double side = 0) {
    constexpr double kSlow = 0.01, kSeconds = 4;  // s
    RobotState state = world_->home_state();
    const auto put = [&](double heading) {
      state.q_WB = from_roll_pitch_yaw(0, 0, heading);
      world_->reset(state);
    };
    put(yaw);
    statistics_.begin(*world_, kStanding);
    ControlTargets targets;
    targets.velocity =
        VelocityCommand{made.asked * std::cos(side), made.asked * std::sin(side), made.asked_turning};
    const double direction = yaw + side + made.off;
    for (int i = 1; i <= kSeconds / kSlow; ++i) {
      // Where it turns as it is asked to, the way turns with it; else it goes straight on, whatever it faces.
      const double along = direction + (made.asked_turning != 0 ? made.turning * (i - 0.5) * kSlow : 0);
      state.p_WB += made.speed * kSlow * Vector3(std::cos(along), std::sin(along), 0);
      put(yaw + made.turning * i * kSlow);
      statistics_.add_control_step(*world_, targets, kSlow);
    }
    return statistics_.summary(*world_).outcome;
  }
};

TEST_F(AskedMotion, IsJudgedAlongItsCommand) {
  const double degree = M_PI / 180;
  const std::vector<std::pair<Made, Outcome>> cases{
      {{}, Outcome::kWalked},
      {{.speed = 1.5}, Outcome::kWalked},
      {{.speed = 0.51 * 0.5}, Outcome::kWalked},
      {{.speed = 0.49 * 0.5}, Outcome::kTooSlow},
      {{.speed = 0.11 * 0.5}, Outcome::kTooSlow},
      {{.speed = 0.05 * 0.5}, Outcome::kNoProgress},
      {{.off = 90 * degree, .speed = 0.05 * 0.5}, Outcome::kNoProgress},
      {{.off = M_PI, .speed = 0.05 * 0.5}, Outcome::kNoProgress},
      {{.speed = 0.75, .asked = 8}, Outcome::kTooSlow},  // less than a tenth of it, but not next to nothing
      {{.off = 44 * degree}, Outcome::kWalked},
      {{.off = 46 * degree}, Outcome::kStrayed},
      {{.off = 90 * degree}, Outcome::kStrayed},
      {{.off = 134 * degree}, Outcome::kStrayed},
      {{.off = 136 * degree}, Outcome::kBackward},
      {{.off = M_PI}, Outcome::kBackward},
      // Facing elsewhere is no matter while it goes where it should, and no excuse where it does not.
      {{.turning = 0.5}, Outcome::kWalked},
      {{.off = 90 * degree, .turning = 0.4}, Outcome::kStrayed},
      // Where a turn is asked for, the way is the one that the robot faces.
      {{.turning = 0.4, .asked_turning = 0.4}, Outcome::kWalked},
      {{.turning = 0.21, .asked_turning = 0.4}, Outcome::kWalked},
      {{.turning = 0.19, .asked_turning = 0.4}, Outcome::kTooSlow},
      {{.turning = -0.4, .asked_turning = 0.4}, Outcome::kTooSlow},
      {{.off = 90 * degree, .turning = -0.4, .asked_turning = 0.4}, Outcome::kStrayed},
      {{.turning = -0.1, .asked_turning = 0.1}, Outcome::kWalked},  // 0.4 rad are too few to judge
      // A turn alone.
      {{.speed = 0, .turning = 0.4, .asked = 0, .asked_turning = 0.4}, Outcome::kWalked},
      {{.speed = 0, .turning = 0.19, .asked = 0, .asked_turning = 0.4}, Outcome::kTooSlow},
      {{.speed = 0, .turning = 0.03, .asked = 0, .asked_turning = 0.4}, Outcome::kNoProgress},
      {{.speed = 0, .turning = -0.03, .asked = 0, .asked_turning = 0.4}, Outcome::kNoProgress},
      {{.speed = 0, .turning = -0.05, .asked = 0, .asked_turning = 0.4}, Outcome::kBackward},
      // Less than a leg length, or nothing, was asked for.
      {{.off = M_PI, .asked = 0.01}, Outcome::kWalked},
      {{.off = M_PI, .asked = 0}, Outcome::kWalked},
  };
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const auto& [made, outcome] = cases[i];
    for (const double yaw : {0.0, 0.7, 3.1}) {
      for (const double side : {0.0, 1.9, -2.5}) EXPECT_EQ(name(of(made, yaw, side)), name(outcome)) << i;
    }
    Made mirrored = made;
    mirrored.off *= -1;
    mirrored.turning *= -1;
    mirrored.asked_turning *= -1;
    EXPECT_EQ(name(of(mirrored)), name(outcome)) << i << ", mirrored";
  }
}

TEST(MotionSummary, FailsByFallingDownOrComingApartAndNotByStayingBehind) {
  for (const OutcomeRow& row : outcome_rows()) {
    if (!row.at_once) continue;
    MotionSummary motion;
    EXPECT_FALSE(motion.failed());
    motion.first_at_s[static_cast<std::size_t>(row.outcome)] = 1;
    EXPECT_EQ(motion.failed(), row.outcome != Outcome::kLeftTerrain) << row.name;
  }
}

}  // namespace
}  // namespace crossgait
