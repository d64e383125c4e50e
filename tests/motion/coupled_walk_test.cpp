// A robot whose ankles follow its knees walks in every engine that couples joints, and is refused elsewhere.
#include "gait/scale.h"
#include "motion/foot_target_tracker.h"
#include "motion/gait_source.h"
#include "motion/walk.h"
#include "physics/core/error.h"
#include "physics/robot/multibody.h"
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

/// Abduction and hip move the foot of such a leg aside and up: where along x it is follows.
TEST(CoupledLegs, WhoseKneesFollowAreAsHighAndAsFarAsideAsAskedFor) {
  SerialUrdf urdf;
  urdf.knee_mimic = R"(joint="{0}_pitch" multiplier="-1.6")";
  const scenes::RobotPtr robot = load(urdf);
  FootTargetTracker tracker(robot, ServoCompensation::none());
  LegArray<Vector3> feet;
  for (const Leg leg : kLegs)
    feet[leg] = {0.05, 0.03 * side_sign(leg),
                 -robot->standing_height + 0.02 * static_cast<double>(index(leg))};
  const JointTargets& targets = tracker.update(feet, 0);
  EXPECT_EQ(tracker.clamped(), 0);
  RobotState state;
  state.q = robot->home;
  const std::vector<int> servos = robot->actuated_joints();
  for (std::size_t k = 0; k < servos.size(); ++k)
    state.q[servos[k]] = targets.q[static_cast<Eigen::Index>(k)];
  robot->place_followers(state.q);
  std::vector<Pose> poses;
  forward_kinematics(*robot, state, poses);
  for (const Leg leg : kLegs) {
    const Vector3 foot = foot_position(*robot, leg, poses) - tracker.kinematics()[leg].origin();
    EXPECT_LT((foot - feet[leg]).tail<2>().norm(), 1e-9) << name(leg);  // ten times kConverged
  }
  feet[Leg::FL].z() = -1;
  (void)tracker.update(feet, 0);
  EXPECT_EQ(tracker.status()[Leg::FL], IkStatus::kClampedTooFar);
  EXPECT_EQ(tracker.status()[Leg::FR], IkStatus::kOk);
}

}  // namespace
}  // namespace crossgait
