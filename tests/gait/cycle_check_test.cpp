#include "gait/cycle_check.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "gait/multi_gait_controller.h"
#include "ik/leg_kinematics.h"
#include "physics/core/error.h"
#include "physics/robot_files/data_path.h"

namespace crossgait {
namespace {

/// Asks the kinematics of the robot file, joint limits and all.
class WithLegs : public testing::Test {
 protected:
  bool reaches(Leg leg, const Vector3& target) const {
    return legs_[leg].inverse(target).status == IkStatus::kOk;
  }
  TargetCheck check() const {
    return [this](Leg leg, const Vector3& target) { return reaches(leg, target); };
  }

  const LegArray<LegKinematics> legs_ = make_leg_kinematics(load_robot(find_robot("scara_quadruped")));
};

using CycleCheckTest = WithLegs;

TEST_F(CycleCheckTest, EveryGaitIsReachableAsItPrefersToWalk) {
  for (const SwingCurve curve : {SwingCurve::kBezier, SwingCurve::kMatched}) {
    for (const Gait& gait : gaits()) {
      GaitParameters p = gait.preferred;
      p.swing = curve;
      const CycleCheck result = check_cycle(gait, p, check());
      EXPECT_TRUE(result.ok()) << gait.name << " " << name(curve);
      EXPECT_EQ(result.targets, 1600);
      EXPECT_TRUE(result.offending.empty());
      EXPECT_FALSE(result.first);
    }
  }
}

TEST_F(CycleCheckTest, EveryGaitStaysReachableForAThousandSeconds) {
  for (const Gait& gait : gaits()) {
    GaitGenerator generator(gait, gait.preferred, leg_origins(legs_));
    int unreachable = 0;
    // A step that shares no factor with any cycle time: 1000 s visit each phase anew.
    constexpr double kStep = 0.0107;
    for (double t = 0; t < 1000; t += kStep) {
      const LegArray<FootTarget>& targets = generator.update(kStep);
      for (const Leg leg : kLegs) unreachable += !reaches(leg, targets[leg].position);
    }
    EXPECT_EQ(unreachable, 0) << gait.name;
  }
}

TEST_F(CycleCheckTest, TheWholeBoxIsReachableOrBlamedOnAParameter) {
  std::mt19937 random(1);
  int reachable = 0, blamed = 0;
  for (const Gait& gait : gaits()) {
    for (int i = 0; i < 60; ++i) {
      GaitParameters p;
      for (const ParameterRow& row : gait_parameters()) {
        p.*row.member = std::uniform_real_distribution<double>(row.min, row.max)(random);
      }
      constexpr int kSamples = 60;
      const CycleCheck result = check_cycle(gait, p, check(), kSamples);
      EXPECT_EQ(result.ok(), result.offending.empty());
      (result.ok() ? reachable : blamed) += 1;
      // Taking the blame means that the preferred values mend it, all but the last alone do not.
      GaitParameters mended = p;
      for (const std::string_view name : result.offending) {
        EXPECT_FALSE(check_cycle(gait, mended, check(), kSamples).ok());
        const ParameterRow& row = find_parameter(name);
        mended.*row.member = gait.preferred.*row.member;
      }
      EXPECT_TRUE(check_cycle(gait, mended, check(), kSamples).ok());
    }
  }
  EXPECT_GT(reachable, 100);
  EXPECT_GT(blamed, 100);
}

TEST_F(CycleCheckTest, NamesTheCulpritAndTheFirstFailure) {
  GaitParameters p = find_gait("trot").preferred;
  p.body_height = 0.2;
  const CycleCheck result = check_cycle(find_gait("trot"), p, check());
  ASSERT_TRUE(result.first);
  EXPECT_EQ(result.offending, (std::vector<std::string_view>{"body_height"}));
  EXPECT_FALSE(reaches(result.first->leg, result.first->target));
  EXPECT_EQ(result.first->phase, 0);
}

TEST_F(CycleCheckTest, BlamesAllThatDiffersIfNothingHelps) {
  GaitParameters p = find_gait("walk").preferred;
  p.step_length = 0.07;
  p.swing_shape = 0.5;
  const CycleCheck result = check_cycle(find_gait("walk"), p, [](Leg, const Vector3&) { return false; });
  EXPECT_EQ(result.unreachable, result.targets);
  EXPECT_EQ(result.offending.size(), 2u);
}

TEST_F(CycleCheckTest, NonsenseIsAnError) {
  EXPECT_THROW(check_cycle(find_gait("trot"), {}, check(), 1), ConfigError);
  EXPECT_THROW(check_cycle(find_gait("trot"), {.cycle_time = 0}, check()), ConfigError);
}

using ReachableSteps = WithLegs;

TEST_F(ReachableSteps, HoldTheDefaultLimits) {
  // What StepLimits says of itself.
  for (const SwingCurve curve : {SwingCurve::kBezier, SwingCurve::kMatched}) {
    for (const char* gait : {"trot", "walk"}) {
      GaitParameters p;
      p.step_height = 0.03;
      p.swing = curve;
      const StepLimits limits = reachable_steps(find_gait(gait), p, check(), 100);
      EXPECT_GE(limits.max_x, StepLimits{}.max_x) << gait << " " << name(curve);
      EXPECT_GE(limits.max_y, StepLimits{}.max_y) << gait << " " << name(curve);
      EXPECT_LT(limits.max_x, 0.2);  // no leg of 0.105 m steps further
    }
  }
}

TEST_F(ReachableSteps, AreFoundForAMadeUpWorkspace) {
  // A box of +-20 mm by +-10 mm around each foot: an ellipse through its sides' middles fits inside.
  const TargetCheck box = [](Leg leg, const Vector3& target) {
    return std::abs(target.x()) <= 0.02 && std::abs(target.y() - side_sign(leg) * 0.04) <= 0.01;
  };
  const StepLimits limits = reachable_steps(find_gait("trot"), guide_adaptive_parameters(), box);
  EXPECT_NEAR(limits.max_x, 0.04, 1e-4);  // found to a tenth of a millimetre
  EXPECT_NEAR(limits.max_y, 0.02, 1e-4);
  // A diamond inside that box holds only the ellipse scaled by cos 45 degrees.
  const TargetCheck diamond = [](Leg leg, const Vector3& target) {
    return std::abs(target.x()) / 0.02 + std::abs(target.y() - side_sign(leg) * 0.04) / 0.01 <= 1;
  };
  const StepLimits inside = reachable_steps(find_gait("trot"), guide_adaptive_parameters(), diamond);
  EXPECT_NEAR(inside.max_x, 0.04 * std::sqrt(0.5), 0.04 * 0.02);               // shrunk by steps of 2 %
  EXPECT_LE(std::sqrt(0.5) * (inside.max_x / 0.04 + inside.max_y / 0.02), 1);  // the step at 45 degrees
}

TEST_F(ReachableSteps, OnTheSpotMustBeReachable) {
  EXPECT_THROW(reachable_steps(find_gait("trot"), {.body_height = 0.2}, check()), ConfigError);
}

TEST_F(ReachableSteps, KeepCommandedWalksInReach) {
  MultiGaitOptions options;
  MultiGaitController controller(options, leg_origins(legs_));
  std::mt19937 random(2);
  const auto uniform = [&](double most) {
    return std::uniform_real_distribution<double>(-most, most)(random);
  };
  int unreachable = 0;
  for (int i = 0; i < 100000; ++i) {  // 200 s
    if (i % 1500 == 0) {
      ASSERT_TRUE(controller.set_command({uniform(0.5), uniform(0.2), uniform(1.0)}));
    }
    const LegArray<FootTarget>& targets = controller.update(0.002);
    for (const Leg leg : kLegs) unreachable += !reaches(leg, targets[leg].position);
  }
  EXPECT_EQ(unreachable, 0);
}

}  // namespace
}  // namespace crossgait
