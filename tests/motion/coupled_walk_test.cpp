// A robot whose ankles follow its knees walks in every engine that couples joints, and is refused elsewhere.
#include "gait/scale.h"
#include "motion/gait_source.h"
#include "motion/walk.h"
#include "physics/core/error.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/robot_files/scratch_robot.h"
#include "tests/physics/robot_files/serial_urdf.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

SerialUrdf with_ankles() {
  SerialUrdf urdf;
  urdf.ankle_mimic = R"(joint="{0}_knee" multiplier="-0.5")";
  urdf.foot_at = {0, 0, -0.1};
  return urdf;
}

scenes::RobotPtr load(const SerialUrdf& urdf) {
  const ScratchRobot scratch;
  scratch.write("made.urdf", urdf.text());
  std::filesystem::remove(scratch.path("robot.yaml"));  // of another robot
  return std::make_shared<const RobotDescription>(load_robot(scratch.path("made.urdf")));
}

class CoupledWalk : public EngineTest {};
CROSSGAIT_FOR_EVERY_BACKEND(CoupledWalk);

TEST_P(CoupledWalk, GoesAheadWithItsFollowersInPlace) {
  const WorldSpec spec = scenes::world_of(load(with_ankles()));
  if (find_engine(GetParam()).info.laws.couplings.empty()) {
    const ConfigError error = config_error([&] { (void)make(spec); });
    EXPECT_EQ(error.element(), "couplings");
    EXPECT_EQ(error.found(), "4 of them");
    return;
  }
  const auto world = make(spec);
  double largest = 0;
  const MotionSummary walked =
      run_walk(*world, make_gait_controller(choose_gait("trot", {}, {}, gait_scale(*spec.robot)), spec),
               {.seconds = 5}, [&](const WalkSample& sample) {
                 for (const JointCoupling& coupling : spec.robot->couplings) {
                   const JointVector& q = sample.world.state().q;
                   largest = std::max(
                       largest, std::abs(q[coupling.follower] - coupling.follower_at(q[coupling.leader])));
                 }
                 return true;
               });
  measured("distance, m", walked.distance_m);
  measured("largest violation, rad", largest);
  EXPECT_EQ(walked.outcome, Outcome::kWalked);
  EXPECT_GT(walked.distance_m, 1);  // measured: 3.3 to 3.5 m
  // Measured: 0.6e-3 rad, in impacts.
  EXPECT_LT(largest, 2e-3);
}

TEST(CoupledLegs, WhoseKneesFollowAreNotForFeetThatGoAnywhere) {
  SerialUrdf urdf;
  urdf.knee_mimic = R"(joint="{0}_pitch" multiplier="-2")";
  const WorldSpec spec = scenes::world_of(load(urdf));
  const ConfigError error = config_error(
      [&] { (void)make_gait_controller(choose_gait("trot", {}, {}, gait_scale(*spec.robot)), spec); });
  EXPECT_EQ(error.element(), "legs.FL");
}

}  // namespace
}  // namespace crossgait
