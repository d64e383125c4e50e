// Runs against the gait library as parameter_and_gait.patch extends it: everything but those lines follows by
// itself.

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "env/observation.h"
#include "gait/adaptive_gait_controller.h"
#include "gait/cycle_check.h"
#include "physics/core/error.h"

namespace crossgait {
namespace {

constexpr double kDt = 0.002;

LegArray<Vector3> leg_origins() {
  LegArray<Vector3> p_BL;
  for (const Leg leg : kLegs) p_BL[leg] = {is_front(leg) ? 0.075 : -0.075, side_sign(leg) * 0.062, 0.0025};
  return p_BL;
}

AdaptiveGaitOptions with_swing_outward() {
  AdaptiveGaitOptions options;
  options.initial = guide_adaptive_parameters();  // round numbers
  options.parameters.emplace_back("swing_outward");
  return options;
}

TEST(NewParameter, IsSetByNameAndChecked) {
  GaitParameters p;
  assign(p, "swing_outward=.02");
  EXPECT_EQ(p.swing_outward, 0.02);
  EXPECT_THROW(assign(p, "swing_outward=1e4"), ConfigError);
  p.swing_outward = std::nan("");
  EXPECT_FALSE(is_valid(p));
}

TEST(NewParameter, IsInTheTable) {
  EXPECT_EQ(gait_parameters().back().name, "swing_outward");
  EXPECT_EQ(gait_parameters().back().default_value(), 0);
}

TEST(NewParameter, WidensActionsAndObservations) {
  AdaptiveGaitController c(find_gait("trot:guide"), with_swing_outward(), leg_origins());
  EXPECT_EQ(c.action_size(), 17u);
  std::vector<double> action(c.action_size(), 0.0);
  action[4] = 1;
  c.apply_action(action);
  EXPECT_EQ(c.parameters().swing_outward, 0.002);
  std::vector<double> observed(5);
  c.normalised_parameters(observed);
  EXPECT_NEAR(observed[4], 2 * 0.002 / 0.03 - 1, 1e-15);  // roundings of numbers near one
  for (int i = 0; i < 100; ++i) c.apply_action(action);
  EXPECT_EQ(c.parameters().swing_outward, 0.03);  // clipped
}

TEST(NewParameter, IsInTheEnvironmentsLayouts) {
  AdaptiveGaitController c(find_gait("trot:guide"), with_swing_outward(), leg_origins());
  const Layout action = action_layout(c.adapted());
  ASSERT_EQ(action.size(), 17u);
  EXPECT_EQ(action.entries[4].name, "delta.swing_outward");
  Layout observation;
  find_observation_block("parameters")
      .describe({.actuated_joints = {}, .home = {}, .parameters = c.adapted(), .action = action},
                observation);
  ASSERT_EQ(observation.size(), 5u);
  EXPECT_EQ(observation.entries[4].name, "param.swing_outward");
}

TEST(NewParameter, MovesFeetGraduallyAndOnlyInSwing) {
  AdaptiveGaitController c(find_gait("trot:guide"), with_swing_outward(), leg_origins());
  for (int i = 0; i < 90; ++i) c.update(kDt);  // near mid-swing, where it matters most
  c.add_deltas(std::vector<double>{0, 0, 0, 0, 0.03});
  LegArray<FootTarget> before = c.targets();
  double widest = 0;
  for (int i = 0; i < 1000; ++i) {
    c.update(kDt);
    for (const Leg leg : kLegs) {
      const FootTarget& foot = c.targets()[leg];
      // 1.5 times the top speed of this gait: it rises by 3 * .0499 m per .4 s of swing, slower forward and
      // outward.
      EXPECT_LE((foot.position - before[leg].position).norm(), 1.5 * 0.45 * kDt);
      if (!foot.swing) {
        EXPECT_EQ(foot.position.y(), side_sign(leg) * 0.04);
      }
      widest = std::max(widest, std::abs(foot.position.y()));
    }
    before = c.targets();
  }
  EXPECT_NEAR(widest, 0.04 + 0.75 * 0.03, 1e-5);  // the Bezier's apex; sampled every .005 of a swing
}

TEST(NewParameter, TakesTheBlameForTargetsOutOfReach) {
  GaitParameters p = guide_adaptive_parameters();
  p.swing_outward = 0.03;
  p.step_length = 0.08;
  const TargetCheck narrow = [](Leg, const Vector3& target) { return std::abs(target.y()) < 0.05; };
  const CycleCheck result = check_cycle(find_gait("trot:guide"), p, narrow);
  EXPECT_FALSE(result.ok());
  EXPECT_EQ(result.offending, (std::vector<std::string_view>{"swing_outward"}));
}

TEST(NewGait, IsFoundAndWalks) {
  const Gait& amble = find_gait("amble");
  EXPECT_NO_THROW(validate(amble));
  EXPECT_EQ(phase_name(amble, 0.3), "fl_lift");
  GaitParameters slow = amble.preferred;
  slow.cycle_time = 0.8;
  GaitGenerator generator(amble, slow, leg_origins());
  LegArray<int> swinging = {};
  for (int i = 0; i < 400; ++i) {  // one cycle
    generator.update(kDt);
    for (const Leg leg : kLegs) swinging[leg] += generator.targets()[leg].swing;
  }
  for (const Leg leg : kLegs) EXPECT_NEAR(swinging[leg], 150, 1);  // three eighths, to a step
}

}  // namespace
}  // namespace crossgait
