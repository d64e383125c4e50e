// Robots on many points: what one solver does in sweeps over contacts and another in the robot's velocities
// has one solution.
#include "tests/parity/matched_pair.h"

namespace crossgait {
namespace {

class MatchedCrowd : public MatchedPair {
 protected:
  static Difference hold(const WorldSpec& spec, const RobotState* start, double seconds) {
    return run(
        spec, start, [home = scenes::home_targets(*spec.robot)](double) { return home; }, seconds);
  }
  // Thirty kilogrammes that land push with thousands of newtons: measured up to 6.5e-9 N apart.
  static void expect_same_of_heavy(Difference d, int contacts) {
    EXPECT_LT(d.force, 1e-6);
    d.force = 0;
    expect_same(d, contacts);
  }
};
INSTANTIATE_TEST_SUITE_P(Engines, MatchedCrowd, ::testing::ValuesIn(matched_pairs()), pair_name);

TEST_P(MatchedCrowd, StandsOnAsManyPointsAsThereMayBe) {
  expect_same(hold(scenes::world_of(scenes::millipede(kMaxJoints, 2)), nullptr, 0.5), kMaxContacts);
}

TEST_P(MatchedCrowd, StandsStifflyWithDryJoints) {
  WorldSpec spec = scenes::world_of(scenes::with_joint_friction(scenes::millipede(16, 2), 0.02));
  spec.contact.softness.time_constant = 0.004;
  spec.contact.impratio = 10;
  expect_same(hold(spec, nullptr, 0.5), 32);
}

TEST_P(MatchedCrowd, AHeavyTrunkSlidesOnItsBelly) {
  for (const double friction : {0.0, 2.0}) {
    WorldSpec spec = scenes::world_of(scenes::with_joint_friction(scenes::heavy_sledge(60), friction));
    RobotState start = home_of(spec);
    start.v_WB = {1.5, 0.3, 0};
    start.w_WB = {0, 0, 0.8};
    expect_same_of_heavy(hold(spec, &start, 1), 60);
  }
}

TEST_P(MatchedCrowd, AHeavyTrunkFalls) {
  WorldSpec spec = scenes::world_of(scenes::heavy_sledge(60));
  for (const char* terrain : {"flat", "rough:seed=3,flat_radius=0,size_x=6,size_y=6"}) {
    spec.terrain = make_terrain(terrain);
    RobotState start = home_of(spec);
    start.p_WB.z() += 0.4;
    start.q_WB = from_roll_pitch_yaw(0.4, 0.3, 0.2);
    start.v_WB = {0.8, 0.4, 0};
    start.w_WB = {1, -1, 0.5};
    expect_same_of_heavy(hold(spec, &start, 1.5), 10);
  }
}

TEST_P(MatchedCrowd, AHeavyTrunkRattlesDownASlope) {
  WorldSpec spec = scenes::world_of(scenes::heavy_sledge(60));
  spec.gravity = {6.94, 0.5, -6.94};  // of 45 degrees: sliding contacts lift
  expect_same_of_heavy(hold(spec, nullptr, 1), 2);
}

}  // namespace
}  // namespace crossgait
