// Engines of the same laws of which one rounds to float32: what is smooth stays together to its rounding, and
// what walks until a foot lands a step earlier.
#include <random>

#include "tests/parity/matched_pair.h"

namespace crossgait {
namespace {

class Float32Pair : public MatchedPair {
 protected:
  /// Ten times what was measured of `physx:matched` in motion that nothing interrupts (5.9e-8 m, 1.1e-6 rad
  /// through a dozen stops at hard limits, 0.02 N of 7 N that stand).
  static void expect_smooth(const Difference& d) {
    EXPECT_LT(d.position, 6e-7);
    EXPECT_LT(d.joints, 1e-5);
    EXPECT_LT(d.attitude, 1e-5);
    EXPECT_LT(d.force, 0.2);
  }
  /// Five times what was measured of it in trots of up to 5 s (7.8e-4 m and 2.6e-3 rad with dry friction in
  /// joints, 9.9e-5 m without): soft contact begins with a jump of its damper's force, and friction of a
  /// joint that stops with one of torque, so that 1e-8 m decide on a step.
  static void expect_walk(const Difference& d) {
    EXPECT_LT(d.position, 4e-3);
    EXPECT_LT(d.joints, 1.3e-2);
    EXPECT_LT(d.attitude, 1e-2);
    EXPECT_GE(d.most_contacts, 4);
  }
};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Float32Pair);
INSTANTIATE_TEST_SUITE_P(Engines, Float32Pair, ::testing::ValuesIn(matched_pairs(true)), pair_name);

TEST_P(Float32Pair, HangAndTumbleTheSame) {
  for (const bool fixed : {true, false}) {
    WorldSpec spec = scenes::world_of(scenes::quadruped());
    spec.fixed_base = fixed;
    RobotState start = home_of(spec);
    start.p_WB.z() = 2;
    if (!fixed) start.w_WB = {3, 6, 9};
    const scenes::Swing swing(*spec.robot);
    expect_smooth(run(
        spec, &start, [&](double t) { return swing.targets(t); }, 0.5));
  }
}

TEST_P(Float32Pair, DropAndStandTheSame) {
  const WorldSpec spec = scenes::world_of(scenes::quadruped());
  RobotState start = home_of(spec);
  start.p_WB.z() += 0.03;
  const JointTargets home = scenes::home_targets(*spec.robot);
  expect_smooth(run(
      spec, &start, [&](double) { return JointTargets(home); }, 2));
}

TEST_P(Float32Pair, StopAtLimitsAndByFrictionTheSame) {
  for (const double friction : {0.0, 0.02}) {
    SCOPED_TRACE(friction);
    const scenes::ArmLink link{.friction = friction, .limit = 0.3, .limited = true};
    WorldSpec spec = scenes::world_of(scenes::arm({link, link}));
    spec.fixed_base = true;
    RobotState start = home_of(spec);
    start.q.setConstant(-0.25);
    start.qd.setConstant(3);
    expect_smooth(run(
        spec, &start, [](double) { return JointTargets{}; }, 2));
  }
}

TEST_P(Float32Pair, TrotTheSame) {
  for (const char* terrain : {"flat", "rough:seed=1,size_x=4,size_y=2"}) {
    SCOPED_TRACE(terrain);
    WorldSpec spec = scenes::world_of(scenes::quadruped());
    spec.terrain = make_terrain(terrain);
    expect_walk(trot(spec, 5));
  }
  expect_walk(trot(scenes::world_of(scenes::long_quadruped()), 2));
  expect_walk(trot(scenes::world_of(scenes::serial_quadruped()), 5));
  expect_walk(trot(scenes::world_of(scenes::with_joint_friction(scenes::quadruped(), 0.1)), 5));
}

TEST_P(Float32Pair, FollowTheSettingsOfContact) {
  for (const char* settings : {"impratio=100", "solref=0.005:1,solimp=0.8:0.99:0.002:0.3:3",
                               "condim=6,torsional_friction=0.02,rolling_friction=0.01", "erp=0.8,cfm=0.1"}) {
    SCOPED_TRACE(settings);
    WorldSpec spec = scenes::world_of(scenes::quadruped());
    parse_contact_settings(settings, "test").apply(spec.contact);
    expect_walk(trot(spec, 1));
  }
}

TEST_P(Float32Pair, CountFarFromTheOriginAsAtIt) {
  const WorldSpec spec = scenes::world_of(scenes::quadruped());
  RobotState start = home_of(spec);
  start.p_WB += Vector3(1000, -2000, 0.01);
  const JointTargets home = scenes::home_targets(*spec.robot);
  // A float32 of 2000 m has steps of a tenth of a millimetre.
  expect_smooth(run(
      spec, &start, [&](double) { return JointTargets(home); }, 1));
}

TEST_P(Float32Pair, HaveTheSameMassMatrix) {
  std::mt19937 random(1);
  for (const scenes::RobotPtr& robot : {scenes::quadruped(), scenes::awkward_robot()}) {
    const WorldSpec spec = scenes::world_of(robot);
    const auto a = make_world(GetParam().a, spec), b = make_world(GetParam().b, spec);
    const RobotState state = scenes::random_state(*robot, random);
    a->reset(state);
    b->reset(state);
    const Eigen::MatrixXd M = a->mass_matrix();
    // Measured 3.5e-8 kg, kg m^2 of 0.74 kg: of 20 rotations one behind the other, rounded.
    EXPECT_LT((b->mass_matrix() - M).cwiseAbs().maxCoeff(), 20 * epsilon(Precision::kFloat32) * M(0, 0));
  }
}

}  // namespace
}  // namespace crossgait
