// Legs make up for what a robot weighs where it stands.
#include "motion/gait_source.h"
#include "motion/walk.h"
#include "tests/motion/motions.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

LegArray<Vector3> under_the_shoulders() {
  LegArray<Vector3> feet;
  feet.fill(Vector3(0, 0, -0.06));
  return feet;
}

WorldSpec under(const Vector3& gravity) {
  WorldSpec spec = scenes::world_of(scenes::quadruped());
  spec.gravity = gravity;
  return spec;
}

JointVector held(const WorldSpec& world, const ServoCompensation& compensation = {}) {
  ControlTargets out;
  make_feet_controller([](double) { return under_the_shoulders(); }, world, compensation)
      ->hold_pose(2e-3, out);
  return out.joints.q;
}

// What standing targets lead by, rad.
JointVector lead(const Vector3& gravity) {
  return held(under(gravity)) - held(under(gravity), ServoCompensation::none());
}

TEST(GravityOfLegs, IsThatOfTheWorld) {
  const JointVector earth = lead({0, 0, -9.81});
  EXPECT_GT(earth.cwiseAbs().maxCoeff(), 1e-3);
  // Differences of angles of about 1 rad, each rounded.
  EXPECT_LT((lead({0, 0, -1.62}) - 1.62 / 9.81 * earth).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_EQ(lead({0, 0, 0}), JointVector::Zero(earth.size()));
}

TEST(GravityOfLegs, IsWhatPressesOnTheGround) {
  EXPECT_EQ(lead({0.5, -0.3, -1.62}), lead({0, 0, -1.62}));
  EXPECT_EQ(weight_per_mass(under({0.5, -0.3, -1.62})), 1.62);
  EXPECT_EQ(weight_per_mass(under({0, 0, 1})), 0);
}

TEST(GravityOfLegs, OfGaitsIsThatOfTheWorldToo) {
  const auto targets = [](const Vector3& gravity) {
    const ControllerPtr trot = make_gait_controller(choose_gait("trot", {}), under(gravity));
    ControlTargets out;
    trot->hold_pose(2e-3, out);
    return JointVector(out.joints.q);
  };
  EXPECT_NE(targets({0, 0, -9.81}), targets({0, 0, -1.62}));
}

class Gravity : public EngineTest {
 protected:
  // Of the base after a second of standing with feet that make up for `felt`, m.
  static double height(const Vector3& gravity, const Vector3& felt) {
    const auto world = make(under(gravity));
    const ControllerPtr feet =
        make_feet_controller([](double) { return under_the_shoulders(); }, under(felt));
    (void)run_walk(*world, feet, {.seconds = 1});
    return world->state().p_WB.z();
  }
};
CROSSGAIT_FOR_EVERY_BACKEND(Gravity);

TEST_P(Gravity, OnTheMoonTheRobotStandsAsHighAsOnEarth) {
  const Vector3 earth(0, 0, -9.81), moon(0, 0, -1.62);
  const double wanted = height(earth, earth);
  // Soft ground and loops give way by what feet carry: 0.33 mm less on the moon by MuJoCo's law, 0.01 mm by
  // hard ones.
  EXPECT_NEAR(height(moon, moon), wanted, 5e-4);
  EXPECT_GT(height(moon, earth), wanted + 4e-3);  // what legs add that expect six times the load
}

}  // namespace
}  // namespace crossgait
