#include "gait/gait_generator.h"

#include <cmath>
#include <limits>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "physics/core/error.h"
#include "tests/gait/test_robot.h"
#include "tests/support/constants.h"

namespace crossgait {
namespace {

using test::kDt;
using test::kNaN;

// The guide's round numbers, with the gait's own duty factor.
GaitGenerator generator(std::string_view gait = "trot:guide",
                        GaitParameters p = guide_adaptive_parameters()) {
  p.duty_factor = find_gait(gait).preferred.duty_factor;
  return {find_gait(gait), p, test::leg_origins()};
}

void run(GaitGenerator& g, double seconds) {
  for (int i = 0; i < std::lround(seconds / kDt); ++i) g.update(kDt);
}

TEST(GaitGenerator, TrotIsTheGuides) {
  const GaitParameters p = guide_parameters();
  GaitGenerator g = generator("trot:guide", p);
  const double s = p.step_length / 2, h = p.body_height, l = h - p.step_height - p.foot_clearance;
  for (int i = 1; i <= 800; ++i) {  // two cycles
    const LegArray<FootTarget>& targets = g.update(kDt);
    double phase = i * kDt / p.cycle_time;
    phase -= std::floor(phase + 1e-12);  // the sum of 400 steps may fall a rounding short of a whole cycle
    for (const Leg leg : kLegs) {
      const bool pair_a = leg == Leg::FL || leg == Leg::RR;
      const bool swing = (phase < 0.5) == pair_a;
      const double u = 2 * (phase < 0.5 ? phase : phase - 0.5), v = 1 - u;
      const double k = p.swing_shape;
      Vector3 expected(s - 2 * s * u, side_sign(leg) * 0.04, -h);
      if (swing) {
        expected.x() = -s * v * v * v - 3 * s * k * v * v * u + 3 * s * k * v * u * u + s * u * u * u;
        expected.z() = -(h * (v * v * v + u * u * u) + 3 * l * v * u);
      }
      // The clock sums 800 steps, 1e-16 of a cycle each; a foot moves 0.2 m in one at most.
      ASSERT_LT((targets[leg].position - expected).norm(), 2e-14) << i << " " << name(leg);
    }
  }
}

TEST(GaitGenerator, StanceMovesAtTheNominalSpeed) {
  for (const Gait& gait : gaits()) {
    GaitGenerator g = generator(gait.name, gait.preferred);
    LegArray<FootTarget> before = g.targets();
    int checked = 0;
    for (int i = 0; i < 2000; ++i) {
      const LegArray<FootTarget>& now = g.update(kDt);
      for (const Leg leg : kLegs) {
        if (!before[leg].swing && !now[leg].swing && now[leg].phase > before[leg].phase) {
          const Vector3 velocity = (now[leg].position - before[leg].position) / kDt;
          const double expected = nominal_speed(gait.preferred);
          // Differences of centimetres over 2 ms: 1e-17 / 2e-3, and 1e-13 of the clock.
          ASSERT_LT((velocity - Vector3(-expected, 0, 0)).norm(), 1e-11) << gait.name;
          ++checked;
        }
      }
      before = now;
    }
    EXPECT_GT(checked, 3000) << gait.name;
  }
}

TEST(GaitGenerator, GoesThroughTheNamedPhasesInOrder) {
  GaitGenerator g = generator("gallop:guide", find_gait("gallop:guide").preferred);
  std::vector<std::string> seen;
  for (int i = 0; i < 300; ++i) {  // one cycle of 0.6 s
    const std::string now(g.current_phase_name());
    if (seen.empty() || seen.back() != now) seen.push_back(now);
    g.update(kDt);
  }
  EXPECT_EQ(seen, (std::vector<std::string>{"front_swing", "front_stance", "rear_swing", "rear_stance"}));
}

TEST(GaitGenerator, GallopsStanceIsOneSweep) {
  GaitGenerator g = generator("gallop:guide");
  double before = g.targets()[Leg::FL].position.x();
  int falls = 0, rises = 0;
  for (int i = 0; i < 400; ++i) {
    const FootTarget& foot = g.update(kDt)[Leg::FL];
    (foot.position.x() < before ? falls : rises) += 1;
    before = foot.position.x();
  }
  EXPECT_EQ(falls, 300);  // three quarters of the cycle backwards,
  EXPECT_EQ(rises, 100);  // one quarter forwards
}

TEST(GaitGenerator, KeepsItsPhaseWhenTheCycleTimeChanges) {
  GaitGenerator g = generator();
  run(g, 0.3);
  const double phase = g.phase();
  const LegArray<FootTarget> before = g.targets();
  GaitParameters p = guide_adaptive_parameters();
  p.cycle_time = 1.5;
  ASSERT_TRUE(g.set_parameters(p));
  EXPECT_EQ(g.phase(), phase);
  g.update(1e-9);
  for (const Leg leg : kLegs) {
    EXPECT_LT((g.targets()[leg].position - before[leg].position).norm(), 1e-9);  // 0.4 m/s for a nanosecond
  }
  g.update(0.15);
  EXPECT_NEAR(g.phase(), phase + 0.1, 1e-8);  // a tenth of the new cycle, at once; a nanosecond was 1e-9
}

TEST(GaitGenerator, ParametersTakeEffectGraduallyAndFully) {
  GaitGenerator g = generator();
  run(g, 0.5);
  GaitParameters p = guide_adaptive_parameters();
  p.body_height = 0.055;
  p.step_length = 0.09;
  p.step_height = 0.03;
  p.stance_width = 0.06;
  p.swing_shape = 0.5;
  ASSERT_TRUE(g.set_parameters(p));
  g.update(kDt);
  EXPECT_LT(g.effective().parameters.body_height,
            0.0505);  // the share of one update is far below a millimetre
  EXPECT_EQ(g.parameters().body_height, 0.055);
  run(g, 1);
  for (const ParameterRow& row : gait_parameters()) {
    EXPECT_EQ(g.effective().parameters.*row.member, p.*row.member) << row.name;
  }
  EXPECT_EQ(g.effective().step[Leg::RL], Vector2(0.09, 0));
}

TEST(GaitGenerator, ChangesCurveWithoutAJump) {
  GaitGenerator g = generator();
  GaitParameters p = guide_adaptive_parameters();
  p.swing = SwingCurve::kMatched;
  const double top = std::max(test::top_foot_speed(p, g.effective().step, SwingCurve::kBezier),
                              test::top_foot_speed(p, g.effective().step, SwingCurve::kMatched));
  run(g, 0.2);  // pair a in mid-swing
  ASSERT_TRUE(g.set_parameters(p));
  double apex = -1;
  LegArray<FootTarget> before = g.targets();
  for (int i = 0; i < 800; ++i) {
    g.update(kDt);
    for (const Leg leg : kLegs) {
      ASSERT_LE((g.targets()[leg].position - before[leg].position).norm(),
                1.001 * top * kDt);  // of the sampled top
    }
    if (i > 400) apex = std::max(apex, g.targets()[Leg::FL].position.z());
    before = g.targets();
  }
  EXPECT_GT(apex, -1e-3);  // the matched curve lifts fully, the Bezier to a quarter of 0.05 m
}

TEST(GaitGenerator, RefusesNonsenseAndStaysAsItWas) {
  GaitGenerator g = generator(), untouched = generator();
  GaitParameters p = guide_adaptive_parameters();
  p.step_length = kNaN;
  EXPECT_FALSE(g.set_parameters(p));
  EXPECT_FALSE(g.set_command({kNaN, 0, 0}));
  EXPECT_FALSE(g.set_command({0, 0, std::numeric_limits<double>::infinity()}));
  for (const double dt : {0.0, -1.0, kNaN, std::numeric_limits<double>::infinity()}) g.update(dt);
  for (int i = 0; i < 100; ++i) {
    g.update(kDt);
    untouched.update(kDt);
    for (const Leg leg : kLegs) ASSERT_EQ(g.targets()[leg].position, untouched.targets()[leg].position);
  }
}

TEST(GaitGenerator, InvalidConfigurationIsAnError) {
  Gait gait = find_gait("trot");
  gait.preferred.duty_factor = 0;
  EXPECT_THROW(GaitGenerator(gait, {}, test::leg_origins()), ConfigError);
  GaitParameters p = guide_adaptive_parameters();
  p.cycle_time = -1;
  EXPECT_THROW(GaitGenerator(find_gait("trot"), p, test::leg_origins()), ConfigError);
  EXPECT_THROW(GaitGenerator(find_gait("trot"), {}, test::leg_origins(), {0, 0.1}), ConfigError);
}

TEST(GaitGenerator, StaysFiniteUnderExtremeCommandsAndTimes) {
  GaitGenerator g = generator();
  for (const double v : {1e300, -1e300, 1e-300}) {
    ASSERT_TRUE(g.set_command({v, -v, v}));
    for (const double dt : {1e-12, 0.002, 5.0, 1e15}) {
      for (const FootTarget& foot : g.update(dt)) ASSERT_TRUE(foot.position.allFinite());
    }
  }
}

TEST(GaitGenerator, ResetPutsEverythingIntoEffect) {
  GaitGenerator g = generator(), fresh = generator("walk:guide", guide_parameters());
  run(g, 0.37);
  ASSERT_TRUE(g.set_parameters(guide_parameters()));
  g.set_gait(find_gait("walk:guide"));
  run(g, 0.1);
  g.reset();
  for (int i = 0; i < 500; ++i) {
    for (const Leg leg : kLegs) ASSERT_EQ(g.targets()[leg].position, fresh.targets()[leg].position);
    g.update(kDt);
    fresh.update(kDt);
  }
}

TEST(GaitChange, KeepsLegsMovingForwardAndEndsInStep) {
  for (const Gait& from : gaits()) {
    for (const Gait& to : gaits()) {
      SCOPED_TRACE(std::string(from.name) + " to " + std::string(to.name));
      GaitGenerator g = generator(from.name);
      run(g, 0.33);
      g.set_gait(to);
      LegArray<FootTarget> before = g.targets();
      int updates = 0;
      while (!(g.in_step() && g.effective().parameters.duty_factor == to.preferred.duty_factor) &&
             updates < 5000) {
        g.update(kDt);
        ++updates;
        for (const Leg leg : kLegs) {
          double ahead = g.targets()[leg].phase - before[leg].phase;
          ahead -= std::floor(ahead);
          // Legs run at 0.8 to 1.2 times the clock. Roundings of phases.
          ASSERT_GE(ahead, (1 - GaitGenerator::kPhaseShare) * kDt / 0.8 - 1e-14);
          ASSERT_LE(ahead, (1 + GaitGenerator::kPhaseShare) * kDt / 0.8 + 1e-14);
        }
        before = g.targets();
      }
      // At most 0.375 of a cycle to catch up (four phases on a circle) at 0.2 per cycle; the duty factor,
      // which waits for slower shifts meanwhile, follows in a cycle.
      EXPECT_LE(updates, 3 * 400 + 1);
      // From here on it is the new gait.
      for (int i = 0; i < 400; ++i) {
        g.update(kDt);
        for (const Leg leg : kLegs) {
          const LegPhase phase = leg_phase(g.phase(), to.offset[leg], to.preferred.duty_factor);
          ASSERT_EQ(g.targets()[leg].swing, phase.swing);
          ASSERT_EQ(g.targets()[leg].phase, phase.phase);
        }
      }
    }
  }
}

TEST(GaitChange, ToTheSameGaitChangesNothing) {
  GaitGenerator g = generator("walk:guide"), same = generator("walk:guide");
  run(g, 0.3);
  run(same, 0.3);
  g.set_gait(find_gait("walk:guide"));
  for (int i = 0; i < 1000; ++i) {
    g.update(kDt);
    same.update(kDt);
    for (const Leg leg : kLegs) {
      // The clock was turned by zero, up to a rounding.
      ASSERT_LT((g.targets()[leg].position - same.targets()[leg].position).norm(), 1e-15);
    }
  }
}

TEST(Command, StepsCarryTheBodyAtTheCommandedVelocity) {
  const LegArray<Vector3> p_BL = test::leg_origins();
  const VelocityCommand command{0.05, -0.02, 0.2};
  GaitGenerator g = generator("walk:guide");
  ASSERT_TRUE(g.set_command(command));
  run(g, 4);
  ASSERT_EQ(g.limit_factor(), 1);
  LegArray<FootTarget> before = g.targets();
  for (int i = 0; i < 400; ++i) {
    g.update(kDt);
    for (const Leg leg : kLegs) {
      const FootTarget& foot = g.targets()[leg];
      if (!foot.swing && !before[leg].swing && foot.phase > before[leg].phase) {
        const Vector2 v = (foot.position - before[leg].position).head<2>() / kDt;
        const double x = p_BL[leg].x(), y = p_BL[leg].y() + side_sign(leg) * 0.04;
        // The ground under a body that moves at v and turns at w passes a foot at -(v + w x p); roundings as
        // above.
        EXPECT_LT((v + Vector2(0.05 - 0.2 * y, -0.02 + 0.2 * x)).norm(), 1e-11);
      }
    }
    before = g.targets();
  }
}

TEST(Steering, TurnsBesidesWhateverTheStepsAre) {
  const LegArray<Vector3> p_BL = test::leg_origins();
  constexpr double kRate = 0.1, kStance = 0.4;  // rad/s, s
  for (const bool commanded : {true, false}) {
    GaitGenerator g = generator();
    if (commanded) {
      ASSERT_TRUE(g.set_command({0.1, 0, 0}));
    }
    g.set_steering(kRate);
    run(g, 3);
    for (const Leg leg : kLegs) {
      const double x = p_BL[leg].x(), y = p_BL[leg].y() + side_sign(leg) * 0.04;
      const Vector2 forward(commanded ? 0.1 * kStance : 0.06, 0);
      EXPECT_LT((g.effective().step[leg] - forward - kStance * kRate * Vector2(-y, x)).norm(), 1e-16);
    }
    g.set_steering(0);
    run(g, 3);
    EXPECT_EQ(g.effective().step[Leg::FL].y(), 0);
  }
}

TEST(Steering, StartsNoWalkAndTakesNoNonsense) {
  GaitGenerator g = generator();
  ASSERT_TRUE(g.set_command({}));
  g.reset(GaitGenerator::Start::kStanding);
  g.set_steering(1);
  run(g, 1);
  EXPECT_TRUE(g.is_standing());
  GaitGenerator plain = generator(), nonsense = generator();
  nonsense.set_steering(kNaN);
  run(plain, 0.5);
  run(nonsense, 0.5);
  for (const Leg leg : kLegs) EXPECT_EQ(nonsense.targets()[leg].position, plain.targets()[leg].position);
}

TEST(Sweep, ShortensThePathOfAFootNotTheStep) {
  GaitGenerator g = generator(), rolling = generator();
  for (GaitGenerator* each : {&g, &rolling}) each->reset(GaitGenerator::Start::kStanding);
  rolling.set_rolling_correction({0.9, 0.5});
  for (int i = 0; i < 1000; ++i) {
    g.update(kDt);
    rolling.update(kDt);
    // Not in step while the strides grow, as far as each may shift its feet.
    if (i < 500) continue;
    EXPECT_EQ(rolling.effective().step[Leg::FL], g.effective().step[Leg::FL]);
    for (const Leg leg : kLegs) {
      const Vector3 &a = g.targets()[leg].position, &b = rolling.targets()[leg].position;
      EXPECT_NEAR(b.x(), 0.9 * a.x(), 1e-16);  // rounding of centimetres
      EXPECT_EQ(b.tail<2>(), a.tail<2>());
    }
  }
}

TEST(Command, IsLimitedAlikeForAllLegsAndSaysSo) {
  GaitGenerator g = generator();
  ASSERT_TRUE(g.set_command({1, 0, 0}));
  run(g, 3);
  // A stance of 0.4 s asks for 0.4 m; 0.13 m are allowed.
  EXPECT_NEAR(g.limit_factor(), 0.13 / 0.4, 1e-15);  // one rounding
  for (const Leg leg : kLegs) EXPECT_NEAR(g.effective().step[leg].x(), 0.13, 1e-15);
  g.clear_command();
  run(g, 3);
  EXPECT_EQ(g.limit_factor(), 1);
  EXPECT_EQ(g.effective().step[Leg::FL], Vector2(0.06, 0));
}

TEST(Command, ZeroStandsAndWalkingResumesFromTheStand) {
  GaitGenerator g = generator();
  run(g, 0.3);
  ASSERT_TRUE(g.set_command({}));
  run(g, 5);
  ASSERT_TRUE(g.is_standing());
  for (const Leg leg : kLegs) {
    EXPECT_EQ(g.targets()[leg].position, Vector3(0, side_sign(leg) * 0.04, -0.05));
    EXPECT_FALSE(g.targets()[leg].swing);
  }
  GaitParameters lower = guide_adaptive_parameters();
  lower.body_height = 0.045;
  ASSERT_TRUE(g.set_parameters(lower));  // standing robots can still crouch
  run(g, 1);
  EXPECT_EQ(g.targets()[Leg::FL].position.z(), -0.045);
  EXPECT_TRUE(g.is_standing());
  ASSERT_TRUE(g.set_command({0.1, 0, 0}));
  g.update(kDt);
  EXPECT_FALSE(g.is_standing());
  run(g, 3);
  EXPECT_EQ(g.effective().lift_scale, 1);
  EXPECT_NEAR(g.effective().step[Leg::FL].x(), 0.1 * 0.4, 1e-16);  // one rounding
}

TEST(Command, FeetAreInPlaceBeforeTheLiftGoes) {
  GaitGenerator g = generator();
  run(g, 0.3);
  ASSERT_TRUE(g.set_command({}));
  while (!g.is_standing()) {
    g.update(kDt);
    if (g.effective().lift_scale < 1) {
      for (const Leg leg : kLegs) ASSERT_EQ(g.effective().step[leg], Vector2(0, 0));
    }
  }
}

TEST(Command, StandingHasHysteresis) {
  GaitGenerator g = generator();
  ASSERT_TRUE(g.set_command({}));
  run(g, 5);
  ASSERT_TRUE(g.set_command({0.007, 0, 0}));
  run(g, 1);
  EXPECT_TRUE(g.is_standing());
  ASSERT_TRUE(g.set_command({0.02, 0, 0}));
  run(g, 5);
  ASSERT_TRUE(g.set_command({0.007, 0, 0}));
  run(g, 5);
  EXPECT_FALSE(g.is_standing());
  ASSERT_TRUE(g.set_command({0.004, 0, 0}));
  run(g, 5);
  EXPECT_TRUE(g.is_standing());
}

TEST(Command, ReversesThroughZeroSteps) {
  GaitGenerator g = generator();
  ASSERT_TRUE(g.set_command({0.1, 0, 0}));
  run(g, 3);
  ASSERT_TRUE(g.set_command({-0.1, 0, 0}));
  run(g, 3);
  for (const Leg leg : kLegs) EXPECT_NEAR(g.effective().step[leg].x(), -0.04, 1e-16);  // one rounding
}

TEST(StandingStart, TakesUpAtOnceWhatMovesNoStandingFoot) {
  GaitGenerator g = generator("walk:guide");
  g.reset(GaitGenerator::Start::kStanding);
  GaitParameters p = guide_adaptive_parameters();
  p.cycle_time = 0.3;
  p.body_height = 0.045;
  g.set_gait(find_gait("trot:guide"));
  ASSERT_TRUE(g.set_parameters(p));
  const LegArray<FootTarget> before = g.targets();
  g.update(kDt);
  EXPECT_EQ(g.effective().parameters.cycle_time, 0.3);
  EXPECT_EQ(g.effective().parameters.duty_factor, p.duty_factor);
  EXPECT_GT(g.effective().parameters.body_height, 0.0495);  // 0.05 m, and on its way
  for (const Leg leg : kLegs) {
    EXPECT_LT((g.targets()[leg].position - before[leg].position).norm(), 1e-3);
  }
  run(g, 1);
  EXPECT_EQ(g.effective().parameters.body_height, 0.045);
}

TEST(StandingStart, BeginsWithAllFeetInPlace) {
  GaitGenerator g = generator();
  g.reset(GaitGenerator::Start::kStanding);
  EXPECT_TRUE(g.is_standing());
  for (const Leg leg : kLegs) EXPECT_EQ(g.targets()[leg].position, Vector3(0, side_sign(leg) * 0.04, -0.05));
  run(g, 2);
  EXPECT_EQ(g.effective().lift_scale, 1);
  EXPECT_EQ(g.effective().step[Leg::FR], Vector2(0.06, 0));
}

}  // namespace
}  // namespace crossgait
