#include "physics/robot/robot.h"

#include <functional>

#include <gtest/gtest.h>

#include "tests/physics/core/config_error.h"
#include "tests/physics/robot_files/scratch_robot.h"
#include "tests/support/constants.h"

namespace crossgait {
namespace {

using test::kNaN;

TEST(Robot, ActuatedJointsKeepTheOrderOfTheLegs) {
  const RobotDescription robot = load_robot(kRobotFolder + "robot.yaml");
  EXPECT_EQ(robot.actuated_joints(), (std::vector<int>{0, 1, 2, 5, 6, 7, 10, 11, 12, 15, 16, 17}));
  EXPECT_EQ(robot.joint(5).name, "FR_tilt");
}

TEST(Robot, TotalMassAddsAllBodies) {
  RobotDescription robot = pendulum_chain(3);
  robot.bodies[2].inertia.mass = 2.5;
  EXPECT_DOUBLE_EQ(robot.total_mass(), 5.5);
}

TEST(Robot, ValidatesRobotsBuiltInCode) {
  EXPECT_NO_THROW(pendulum_chain(0).validate());
  EXPECT_NO_THROW(pendulum_chain(kMaxJoints).validate());
  EXPECT_NO_THROW(load_robot(kRobotFolder + "robot.yaml").validate());
}

TEST(Robot, FlatBodiesAreReal) {
  RobotDescription robot = pendulum_chain(1);
  // A thin disc: its largest moment is exactly the sum of the other two.
  robot.bodies[1].inertia.I_C = Vector3(0.1, 0.1, 0.2).asDiagonal();
  EXPECT_NO_THROW(robot.validate());
}

struct Corruption {
  const char* name;
  std::function<void(RobotDescription&)> apply;
  const char* element;
  const char* expected;
};

void PrintTo(const Corruption& corruption, std::ostream* stream) { *stream << corruption.name; }

class CorruptRobot : public ::testing::TestWithParam<Corruption> {};

TEST_P(CorruptRobot, IsRejected) {
  RobotDescription robot = load_robot(kRobotFolder + "robot.yaml");
  GetParam().apply(robot);
  const ConfigError error = config_error([&] { robot.validate(); });
  EXPECT_EQ(error.source(), robot.source);
  EXPECT_EQ(error.element(), GetParam().element);
  EXPECT_NE(error.expected().find(GetParam().expected), std::string::npos) << error.what();
}

TEST(Robot, SaysWhichBodiesALoopWouldJoin) {
  RobotDescription robot = load_robot(kRobotFolder + "robot.yaml");
  robot.legs.reset();
  robot.loops[1].body_a = 9;
  robot.loops[1].body_b = 21;
  EXPECT_EQ(config_error([&] { robot.validate(); }).found(), "link 'FR_lower_left' and no link");
}

// NOLINTNEXTLINE(readability-function-size): a table, a row for each member.
std::vector<Corruption> body_corruptions() {
  return {
      {"NoBodies",
       [](auto& r) {
         r.legs.reset();
         r.bodies.clear();
       },
       "robot", "at least one body"},
      {"TooManyJoints",
       [](auto& r) {
         while (r.joint_count() <= kMaxJoints) r.bodies.push_back(r.bodies.back());
       },
       "robot", "at most 32 moving joints"},
      {"DuplicateBody", [](auto& r) { r.bodies[2].name = "trunk"; }, "body 'trunk'", "a unique name"},
      {"DuplicateJoint", [](auto& r) { r.bodies[2].joint.name = "FL_tilt"; }, "body 'FL_upper_left'",
       "a unique joint name"},
      {"DuplicateShape", [](auto& r) { r.bodies[2].shapes[0].name = "trunk_front_left"; },
       "collision shape 'trunk_front_left'", "a unique name"},
      {"ParentOfBase", [](auto& r) { r.bodies[0].parent = 0; }, "body 'trunk'", "no parent"},
      {"StrangeParentOfBase", [](auto& r) { r.bodies[0].parent = -2; }, "body 'trunk'", "no parent"},
      {"NoParent",
       [](auto& r) {
         r.legs.reset();
         r.bodies[2].parent = -1;
       },
       "body 'FL_upper_left'", "a parent in 0..1"},
      {"LaterParent",
       [](auto& r) {
         r.legs.reset();
         r.bodies[2].parent = 2;
       },
       "body 'FL_upper_left'", "a parent in 0..1"},
      {"NaNPose", [](auto& r) { r.bodies[1].X_PB.translation().y() = kNaN; }, "body 'FL_tilt_link'",
       "finite the pose in the parent"},
      {"ScaledPose", [](auto& r) { r.bodies[1].X_PB.linear() *= 1.01; }, "body 'FL_tilt_link'", "a rotation"},
      {"MirroredPose", [](auto& r) { r.bodies[1].X_PB.linear()(1, 1) = -1; }, "body 'FL_tilt_link'",
       "a rotation"},
      {"ZeroMass", [](auto& r) { r.bodies[1].inertia.mass = 0; }, "body 'FL_tilt_link'", "mass (kg) > 0"},
      {"HugeMass", [](auto& r) { r.bodies[1].inertia.mass = 1e300; }, "body 'FL_tilt_link'",
       "mass (kg) of at most 1e+06"},
      {"TinyMass", [](auto& r) { r.bodies[1].inertia.mass = 1e-300; }, "body 'FL_tilt_link'",
       "mass (kg) of at least 1e-09"},
      {"HugeInertia", [](auto& r) { r.bodies[1].inertia.I_C *= 1e300; }, "body 'FL_tilt_link'",
       "inertia (kg m^2) of at most 1e+09"},
      {"FarCentreOfMass", [](auto& r) { r.bodies[1].inertia.p_BC.z() = -1e4; }, "body 'FL_tilt_link'",
       "centre of mass (m) of at most 1000"},
      {"FarPose", [](auto& r) { r.bodies[1].X_PB.translation().y() = 1e300; }, "body 'FL_tilt_link'",
       "the pose in the parent of at most 1000"},
      {"HugeShape", [](auto& r) { r.bodies[0].shapes[0].size[0] = 1e9; },
       "collision shape 'trunk_front_left'", "size (m) of at most 1000"},
      {"HugeDamping", [](auto& r) { r.bodies[1].joint.damping = 1e12; }, "joint 'FL_tilt'",
       "damping (N m s/rad) of at most 1e+09"},
      {"HugeStiffness", [](auto& r) { r.bodies[1].joint.kp = 1e300; }, "joint 'FL_tilt'",
       "kp (N m/rad) of at most 1e+09"},
      {"HugeEffort", [](auto& r) { r.bodies[1].joint.effort_limit = 1e10; }, "joint 'FL_tilt'",
       "effort limit (N m) of a servo of at most 1e+09"},
      {"HugeLimit", [](auto& r) { r.bodies[1].joint.upper = 1e7; }, "joint 'FL_tilt'",
       "limits (rad) of at most 1e+06"},
      {"NaNCentreOfMass", [](auto& r) { r.bodies[1].inertia.p_BC.z() = kNaN; }, "body 'FL_tilt_link'",
       "finite centre of mass"},
      {"NaNInertia", [](auto& r) { r.bodies[1].inertia.I_C(0, 0) = kNaN; }, "body 'FL_tilt_link'",
       "finite inertia"},
      {"AsymmetricInertia", [](auto& r) { r.bodies[1].inertia.I_C(0, 1) += 1e-7; }, "body 'FL_tilt_link'",
       "symmetric inertia"},
      {"IndefiniteInertia", [](auto& r) { r.bodies[1].inertia.I_C(0, 0) *= -1; }, "body 'FL_tilt_link'",
       "positive definite inertia"},
      {"ImpossibleInertia", [](auto& r) { r.bodies[1].inertia.I_C(0, 0) *= 10; }, "body 'FL_tilt_link'",
       "inertia of a real body"},
  };
}

std::vector<Corruption> shape_corruptions() {
  return {
      {"ZeroRadius", [](auto& r) { r.bodies[0].shapes[0].size[0] = 0; }, "collision shape 'trunk_front_left'",
       "size (m) > 0"},
      {"FlatBox", [](auto& r) { r.bodies[0].shapes[0].type = ShapeType::kBox; },
       "collision shape 'trunk_front_left'", "size (m) > 0"},
      {"FlatCapsule", [](auto& r) { r.bodies[0].shapes[0].type = ShapeType::kCapsule; },
       "collision shape 'trunk_front_left'", "size (m) > 0"},
      {"EmptyHull", [](auto& r) { r.bodies[0].shapes[0].type = ShapeType::kHull; },
       "collision shape 'trunk_front_left'", "4 to 32 vertices"},
      {"RichHull",
       [](auto& r) {
         r.bodies[0].shapes[0].type = ShapeType::kHull;
         r.bodies[0].shapes[0].vertices.assign(33, Vector3::Zero());
       },
       "collision shape 'trunk_front_left'", "4 to 32 vertices"},
      {"NaNVertex",
       [](auto& r) {
         r.bodies[0].shapes[0].type = ShapeType::kHull;
         r.bodies[0].shapes[0].vertices.assign(4, Vector3(0, kNaN, 0));
       },
       "collision shape 'trunk_front_left'", "finite vertices (m)"},
      {"FlatCylinder", [](auto& r) { r.bodies[0].shapes[0].type = ShapeType::kCylinder; },
       "collision shape 'trunk_front_left'", "size (m) > 0"},
  };
}

std::vector<Corruption> joint_corruptions() {
  return {
      {"ZeroAxis", [](auto& r) { r.bodies[1].joint.axis.setZero(); }, "joint 'FL_tilt'", "a unit axis"},
      {"LongAxis", [](auto& r) { r.bodies[1].joint.axis *= 1.001; }, "joint 'FL_tilt'", "a unit axis"},
      {"ReversedLimits", [](auto& r) { r.bodies[1].joint.upper = -2; }, "joint 'FL_tilt'", "lower < upper"},
      {"NegativeDamping", [](auto& r) { r.bodies[1].joint.damping = -0.1; }, "joint 'FL_tilt'", "damping"},
      {"NegativeArmature", [](auto& r) { r.bodies[1].joint.armature = -1e-4; }, "joint 'FL_tilt'",
       "armature"},
      {"NegativeKp", [](auto& r) { r.bodies[1].joint.kp = -1; }, "joint 'FL_tilt'", "kp"},
      {"NaNKd", [](auto& r) { r.bodies[1].joint.kd = kNaN; }, "joint 'FL_tilt'", "kd"},
      {"NoEffort", [](auto& r) { r.bodies[1].joint.effort_limit = 0; }, "joint 'FL_tilt'", "effort limit"},
  };
}

std::vector<Corruption> whole_robot_corruptions() {
  return {
      {"LoopToNowhere",
       [](auto& r) {
         r.legs.reset();
         r.loops[1].body_b = 21;
       },
       "loop 'FR_tip'", "two bodies"},
      {"LoopOnOneBody",
       [](auto& r) {
         r.legs.reset();
         r.loops[1].body_b = r.loops[1].body_a;
       },
       "loop 'FR_tip'", "two bodies"},
      {"DuplicateLoop", [](auto& r) { r.loops[1].name = "FL_tip"; }, "loop 'FL_tip'", "a unique name"},
      {"NaNLoop", [](auto& r) { r.loops[1].p_AP.x() = kNaN; }, "loop 'FR_tip'", "finite point on body a"},
      {"ZeroTimeConstant", [](auto& r) { r.loop_softness.time_constant = 0; }, "loop_softness.time_constant",
       "a time in (0, 10] s"},
      {"HardImpedance", [](auto& r) { r.loop_softness.impedance_max = 1.5; }, "loop_softness.impedance_max",
       "[impedance_min, 1]"},
      {"SoftLimit", [](auto& r) { r.bodies[2].joint.limit_softness.damping_ratio = 0; },
       "joint 'FL_shoulder_left': limit_softness.damping_ratio", "(0, 100]"},
      {"MissingRole", [](auto& r) { (*r.legs)[Leg::FR].servos[0] = -1; }, "legs.FR.tilt",
       "the index of a joint"},
      {"RoleTwice", [](auto& r) { (*r.legs)[Leg::FR].servos[0] = 0; }, "legs.FR.tilt", "each joint once"},
      {"WrongParent",
       [](auto& r) { std::swap((*r.legs)[Leg::FR].passive[0], (*r.legs)[Leg::FR].passive[1]); },
       "legs.FR.elbow_left", "a joint on link 'FR_upper_left'"},
      {"PassiveShoulder", [](auto& r) { r.bodies[2].joint.actuated = false; }, "legs.FL.shoulder_left",
       "a servo"},
      {"DrivenElbow", [](auto& r) { r.bodies[4].joint.actuated = true; }, "legs.FL.elbow_left",
       "a passive joint"},
      {"LegOfOneJoint", [](auto& r) { (*r.legs)[Leg::RL].servos.resize(1); }, "legs.RL", "5 joints"},
      {"FootOfAnotherLeg", [](auto& r) { (*r.legs)[Leg::RL].foot_body = 4; }, "legs.RL.foot",
       "a foot on a lower link of its leg"},
      {"NoFootRadius", [](auto& r) { (*r.legs)[Leg::RL].foot_radius = 0; }, "legs.RL.foot",
       "foot radius (m) > 0"},
      {"LegWithoutLoop", [](auto& r) { r.loops.erase(r.loops.begin() + 2); }, "legs.RL", "a loop between"},
      {"ShortHome", [](auto& r) { r.home.conservativeResize(19); }, "home", "20 joint angles"},
      {"NaNHome", [](auto& r) { r.home[3] = kNaN; }, "home", "joint 'FL_elbow_left' in -3.1..3.1 rad"},
      {"HomeBeyondLimit", [](auto& r) { r.home[0] = 1.1; }, "home", "joint 'FL_tilt' in -1..1 rad"},
      {"OpenHome", [](auto& r) { r.home[3] += 1e-3; }, "home", "loops closed to 1e-05 m"},
      {"NaNHeight", [](auto& r) { r.home_height = kNaN; }, "home", "a finite height"},
  };
}

const auto kCorruption = [](const auto& info) { return info.param.name; };
INSTANTIATE_TEST_SUITE_P(Body, CorruptRobot, ::testing::ValuesIn(body_corruptions()), kCorruption);
INSTANTIATE_TEST_SUITE_P(Shape, CorruptRobot, ::testing::ValuesIn(shape_corruptions()), kCorruption);
INSTANTIATE_TEST_SUITE_P(Joint, CorruptRobot, ::testing::ValuesIn(joint_corruptions()), kCorruption);
INSTANTIATE_TEST_SUITE_P(Whole, CorruptRobot, ::testing::ValuesIn(whole_robot_corruptions()), kCorruption);

}  // namespace
}  // namespace crossgait
