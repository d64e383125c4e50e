#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "physics/robot/multibody.h"
#include "physics/robot/robot.h"
#include "physics/robot_files/robot_formats.h"
#include "physics/robot_files/robot_report.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/robot_files/scratch_robot.h"

namespace crossgait {
namespace {

const std::string kLongRobot = CROSSGAIT_SOURCE_DIR "/models/robots/scara_quadruped_long/robot.yaml";

std::vector<Pose> standing_poses(const RobotDescription& robot) {
  RobotState state;
  state.q = robot.home;
  state.p_WB.z() = robot.home_height;
  std::vector<Pose> poses;
  forward_kinematics(robot, state, poses);
  return poses;
}

TEST(RobotLoader, ReadsTheMachineOfTheGuide) {
  const RobotDescription robot = load_robot(kRobotFolder + "robot.yaml");
  EXPECT_EQ(robot.name, "scara_quadruped");
  EXPECT_EQ(robot.source, kRobotFolder + "robot.yaml");
  ASSERT_EQ(robot.joint_count(), 20);
  EXPECT_NEAR(robot.total_mass(), 0.3403 + 4 * (0.0918 + 2 * (0.00179 + 0.00186)), 1e-15);  // rounding
  EXPECT_EQ(robot.bodies[0].inertia.I_C.diagonal(), Vector3(4.65e-4, 3.17e-4, 2.28e-4));
  for (int i = 0; i < robot.joint_count(); ++i) {
    const Joint& joint = robot.joint(i);
    EXPECT_EQ(joint.armature, 2e-4) << joint.name;
    EXPECT_EQ(joint.damping, 0.02) << joint.name;
    EXPECT_EQ(joint.axis, i % 5 == 0 ? Vector3(Vector3::UnitX()) : Vector3(Vector3::UnitY())) << joint.name;
    EXPECT_EQ(joint.actuated, i % 5 < 3) << joint.name;
    EXPECT_EQ(joint.kp, joint.actuated ? 1.0 : 0.0) << joint.name;
    EXPECT_EQ(joint.kd, 0) << joint.name;
    EXPECT_EQ(joint.effort_limit, joint.actuated ? 1.0 : 0.0) << joint.name;
  }
}

TEST(RobotLoader, OrdersJointsByLegAndRole) {
  const RobotDescription robot = load_robot(kRobotFolder + "robot.yaml");
  const char* const roles[] = {"tilt", "shoulder_left", "shoulder_right", "elbow_left", "elbow_right"};
  for (const Leg leg : kLegs) {
    const LegModel& model = (*robot.legs)[leg];
    const int joints[] = {model.joint("tilt"), model.joint("shoulder_left"), model.joint("shoulder_right"),
                          model.joint("elbow_left"), model.joint("elbow_right")};
    for (int k = 0; k < 5; ++k) {
      EXPECT_EQ(joints[k], 5 * static_cast<int>(leg) + k);
      EXPECT_EQ(robot.joint(joints[k]).name, std::string(name(leg)) + "_" + roles[k]);
    }
    EXPECT_EQ(model.foot_body, model.joint("elbow_left") + 1);
    EXPECT_EQ(model.p_BF, Vector3(0, 0, -0.06));
    EXPECT_EQ(model.foot_radius, 0.008);
  }
}

TEST(RobotLoader, PlacesLegsByTheirNames) {
  const RobotDescription robot = load_robot(kRobotFolder + "robot.yaml");
  for (const Leg leg : kLegs) {
    const LegModel& model = (*robot.legs)[leg];
    const double front = is_front(leg) ? 1 : -1;
    const auto frame = [&](int joint) {
      return Vector3(robot.bodies[static_cast<std::size_t>(joint) + 1].X_PB.translation());
    };
    EXPECT_EQ(frame(model.joint("tilt")), Vector3(front * 0.075, side_sign(leg) * 0.038, 0.0125));
    EXPECT_EQ(frame(model.joint("shoulder_left")), Vector3(-0.010, side_sign(leg) * 0.024, -0.010));
    EXPECT_EQ(frame(model.joint("shoulder_right")), Vector3(0.010, side_sign(leg) * 0.024, -0.010));
    EXPECT_EQ(frame(model.joint("elbow_left")), Vector3(0, 0, -0.045));
    EXPECT_EQ(frame(model.joint("elbow_right")), Vector3(0, 0, -0.045));
  }
}

TEST(RobotLoader, HomeStandsOnFourFeetWithKneesOutward) {
  const RobotDescription robot = load_robot(kRobotFolder + "robot.yaml");
  const std::vector<Pose> poses = standing_poses(robot);
  EXPECT_LT(max_loop_gap(robot, poses), 1e-15);  // rounding of lengths of .1 m
  for (const Leg leg : kLegs) {
    const LegModel& model = (*robot.legs)[leg];
    const double x = is_front(leg) ? 0.075 : -0.075;
    // The file states 13 digits of the shoulders' angles.
    EXPECT_LT((foot_position(robot, leg, poses) - Vector3(x, side_sign(leg) * 0.062, 0.008)).norm(), 1e-13);
    EXPECT_NEAR(robot.home_height, 0.0755, 1e-13);
    const auto knee = [&](int elbow) { return poses[static_cast<std::size_t>(elbow) + 1].translation().x(); };
    EXPECT_LT(knee(model.joint("elbow_left")), x - 0.03);
    EXPECT_GT(knee(model.joint("elbow_right")), x + 0.03);
  }
}

TEST(RobotLoader, TakesTheUrdfForTheRobot) {
  const RobotDescription robot = load_robot(kRobotFolder + "robot.urdf");
  EXPECT_EQ(robot.name, "scara_quadruped");
  const ScratchRobot scratch;
  scratch.replace("robot.yaml", "urdf: robot.urdf", "urdf: other.urdf");
  std::filesystem::rename(scratch.path("robot.urdf"), scratch.path("other.urdf"));
  EXPECT_EQ(load_robot(scratch.path("other.urdf")).source, scratch.path("robot.yaml"));
  std::filesystem::rename(scratch.path("robot.yaml"), scratch.path("other.yaml"));
  EXPECT_EQ(load_robot(scratch.path("other.urdf")).source, scratch.path("other.yaml"));
}

TEST(RobotLoader, LoadsASecondRobotOfOtherNamesAndFigures) {
  const RobotDescription robot = load_robot(kLongRobot);
  EXPECT_EQ(robot.name, "scara_quadruped_long");
  EXPECT_EQ(robot.bodies[0].name, "chassis");
  EXPECT_DOUBLE_EQ(robot.bodies[0].inertia.mass, 0.52 + 0.12);  // with the battery
  EXPECT_LT(robot.bodies[0].inertia.p_BC.x(), 0);               // which sits behind the middle
  EXPECT_EQ(robot.joint(15).name, "rear_right_abduction");
  EXPECT_EQ(robot.joint(15).armature, 4.5e-4);
  EXPECT_EQ(robot.joint(15).kp, 2.4);
  EXPECT_EQ(robot.joint(16).armature, 3.1e-4);
  EXPECT_EQ(robot.joint(16).kp, 1.8);
  EXPECT_EQ(robot.joint(16).kd, 0.005);
  EXPECT_EQ(robot.joint(16).effort_limit, 1.5);
  const std::vector<Pose> poses = standing_poses(robot);
  EXPECT_LT(max_loop_gap(robot, poses), 1e-15);  // rounding of lengths of .1 m
  for (const Leg leg : kLegs) EXPECT_NEAR(foot_position(robot, leg, poses).z(), 0.009, 1e-12);
}

TEST(RobotLoader, ReadsTheSoftnessOfLoops) {
  const ScratchRobot scratch;
  scratch.replace("robot.yaml", "loop_softness: {time_constant: 0.005",
                  "loop_softness: {time_constant: 0.004");
  const Softness softness = load_robot(scratch.path("robot.yaml")).loop_softness;
  EXPECT_EQ(softness.time_constant, 0.004);
  EXPECT_EQ(softness.impedance_max, 0.99);
  EXPECT_EQ(load_robot(scratch.path("robot.yaml")).friction_softness.time_constant, 0.005);
  scratch.replace("robot.yaml", "loop_softness:", "friction_softness: {time_constant: 0.02}\nloop_softness:");
  const RobotDescription robot = load_robot(scratch.path("robot.yaml"));
  EXPECT_EQ(robot.friction_softness.time_constant, 0.02);
  EXPECT_EQ(robot.friction_softness.impedance_min, RobotDescription().friction_softness.impedance_min);
  EXPECT_EQ(robot.loop_softness.time_constant, 0.004);
  EXPECT_EQ(robot.joint(0).limit_softness.time_constant, 0.02);
  scratch.replace("robot.yaml", "loop_softness:", "limit_softness: {time_constant: 0.01}\nloop_softness:");
  const LoadedRobot changed = load_robot_with_report(scratch.path("robot.yaml"));
  for (int i = 0; i < changed.robot.joint_count(); ++i) {
    EXPECT_EQ(changed.robot.joint(i).limit_softness.time_constant, 0.01);
    EXPECT_EQ(changed.robot.joint(i).limit_softness.impedance_max, 0.95);
  }
  EXPECT_NE(to_yaml(changed, "robot.urdf").find("limit_softness: {time_constant: 0.01"), std::string::npos);
}

TEST(RobotLoader, PutsFurtherJointsBehindTheLegs) {
  const ScratchRobot scratch;
  const std::string inertial =
      R"(<inertial><mass value="0.1"/><inertia ixx="1e-5" ixy="0" ixz="0" iyy="1e-5" iyz="0" izz="1e-5"/></inertial>)";
  scratch.replace("robot.urdf", "</robot>",
                  "<link name=\"arm\">" + inertial + "</link><link name=\"hand\">" + inertial + R"(</link>
      <joint name="B_wrist" type="continuous"><parent link="arm"/><child link="hand"/></joint>
      <joint name="A_arm" type="continuous"><parent link="trunk"/><child link="arm"/></joint></robot>)");
  const RobotDescription robot = load_robot(scratch.path("robot.yaml"));
  ASSERT_EQ(robot.joint_count(), 22);
  EXPECT_EQ(robot.joint(0).name, "FL_tilt");
  EXPECT_EQ(robot.joint(20).name, "A_arm");
  EXPECT_EQ(robot.joint(21).name, "B_wrist");
  EXPECT_EQ(robot.bodies[22].parent, 21);
  EXPECT_FALSE(robot.joint(20).actuated);
  EXPECT_EQ(robot.joint(20).armature, 2e-4);
}

/// One change to one of the default robot's files, and what the error has to name.
struct BadInput {
  const char* name;
  const char* from;
  const char* to;
  const char* element;
  const char* expected;
  const char* found;
};

void PrintTo(const BadInput& bad, std::ostream* stream) { *stream << bad.name; }

void expect_error(const char* file, const BadInput& bad) {
  const ScratchRobot scratch;
  scratch.replace(file, bad.from, bad.to);
  const ConfigError error = config_error([&] { load_robot(scratch.path("robot.yaml")); });
  EXPECT_EQ(error.source(), scratch.path(file)) << error.what();
  EXPECT_NE(error.element().find(bad.element), std::string::npos) << error.what();
  EXPECT_NE(error.expected().find(bad.expected), std::string::npos) << error.what();
  EXPECT_NE(error.found().find(bad.found), std::string::npos) << error.what();
}

class BadUrdf : public ::testing::TestWithParam<BadInput> {};
TEST_P(BadUrdf, IsRejectedByName) { expect_error("robot.urdf", GetParam()); }

const BadInput kBadUrdfs[] = {
    {"Truncated", "</robot>", "", "line ", "well-formed XML", "end tag"},
    {"NotXml", "<?xml version=\"1.0\"?>", "link = trunk", "line ", "well-formed XML", "Error"},
    {"SecondRobot", "</robot>", "</robot><robot name=\"other\"/>", "line ", "one element around all others",
     "<robot> behind <robot>"},
    {"NamelessRobot", "<robot name=\"scara_quadruped\">", "<robot nam=\"\">", "robot", "urdfdom accepts",
     "name"},
    {"NoName", "<link name=\"trunk\">", "<link>", "link ''", "attribute 'name'", "none"},
    {"MissingParentLink", "<parent link=\"trunk\"/>", "<parent link=\"body\"/>", "joint 'FL_tilt'",
     "a parent link of this file", "'body'"},
    {"MissingChildLink", "<child link=\"FL_upper_left\"/>", "", "joint 'FL_shoulder_left'",
     "a child link of this file", "''"},
    {"DuplicateLink", "<link name=\"FL_upper_left\">", "<link name=\"trunk\">", "link 'trunk'",
     "a unique name", "second"},
    {"DuplicateJoint", "<joint name=\"FR_tilt\"", "<joint name=\"FL_tilt\"", "joint 'FL_tilt'",
     "a unique name", "second"},
    {"UnknownType", "<joint name=\"FL_tilt\" type=\"revolute\">", "<joint name=\"FL_tilt\" type=\"screw\">",
     "joint 'FL_tilt'", "revolute, continuous or fixed", "'screw'"},
    {"UnsupportedType", "<joint name=\"FL_tilt\" type=\"revolute\">",
     "<joint name=\"FL_tilt\" type=\"prismatic\">", "joint 'FL_tilt'", "revolute, continuous or fixed",
     "'prismatic'"},
    {"NoType", "<joint name=\"FL_tilt\" type=\"revolute\">", "<joint name=\"FL_tilt\">", "joint 'FL_tilt'",
     "revolute, continuous or fixed", "''"},
    {"TwoParents", "<child link=\"FR_tilt_link\"/>", "<child link=\"FL_tilt_link\"/>", "joint 'FR_tilt'",
     "one parent of link 'FL_tilt_link'", "'trunk' and 'trunk'"},
    {"TwoRoots", "</robot>", "<link name=\"lost\"/></robot>", "robot 'scara_quadruped'", "one root link",
     "'lost', 'trunk'"},
    {"CycleWithRoot", "</robot>",
     "<link name=\"a\"/><link name=\"b\"/><joint name=\"ab\" type=\"fixed\"><parent link=\"a\"/><child "
     "link=\"b\"/></joint><joint name=\"ba\" type=\"fixed\"><parent link=\"b\"/><child "
     "link=\"a\"/></joint></robot>",
     "link 'a'", "a tree of links", "a cycle of joints"},
    {"CycleThroughTrunk", "</robot>",
     "<joint name=\"back\" type=\"fixed\"><parent link=\"FL_foot\"/><child link=\"trunk\"/></joint></robot>",
     "link 'FL_foot'", "a tree of links", "a cycle of joints"},
    {"SelfLoop", "<child link=\"FL_tilt_link\"/>", "<child link=\"trunk\"/>", "link ", "a tree of links",
     "a cycle of joints"},
    {"NegativeMass", "<mass value=\"0.0918\"/>", "<mass value=\"-0.0918\"/>", "link 'FL_tilt_link'",
     "mass (kg) >= 0", "-0.0918"},
    {"ZeroMass", "<mass value=\"0.0918\"/>", "<mass value=\"0\"/>", "link 'FL_tilt_link'", "mass (kg) > 0",
     "0"},
    {"NaNMass", "<mass value=\"0.0918\"/>", "<mass value=\"nan\"/>",
     "link 'FL_tilt_link', inertial, mass, value", "1 finite number", "'nan'"},
    {"NaNOrigin", "<origin xyz=\"0.075 0.038 0.0125\"/>", "<origin xyz=\"0.075 NaN 0.0125\"/>",
     "joint 'FL_tilt', origin, xyz", "3 finite number", "NaN"},
    {"InfiniteAngle", "<origin xyz=\"0.075 0.038 0.0125\"/>", "<origin rpy=\"0 0 inf\"/>",
     "joint 'FL_tilt', origin, rpy", "3 finite number", "inf"},
    {"NaNAxis", "<axis xyz=\"1 0 0\"/>", "<axis xyz=\"nan 0 0\"/>", "joint 'FL_tilt', axis, xyz",
     "3 finite number", "nan"},
    {"ShortAxis", "<axis xyz=\"1 0 0\"/>", "<axis xyz=\"1 0\"/>", "joint 'FL_tilt', axis, xyz",
     "3 finite number", "'1 0'"},
    {"ZeroAxis", "<axis xyz=\"1 0 0\"/>", "<axis xyz=\"0 0 0\"/>", "joint 'FL_tilt'",
     "an axis of non-zero length", "(0, 0, 0)"},
    {"NaNInertia", "ixx=\"7.84125e-06\"", "ixx=\"nan\"", "link 'FL_tilt_link', inertial, inertia, ixx",
     "1 finite number", "nan"},
    {"HugeInertia", "ixx=\"7.84125e-06\"", "ixx=\"1e999\"", "link 'FL_tilt_link', inertial, inertia, ixx",
     "1 finite number", "1e999"},
    {"HalfAnInertia", "ixx=\"7.84125e-06\" ixy=\"0\"", "ixx=\"7.84125e-06\"",
     "link 'FL_tilt_link', inertial, inertia", "attribute 'ixy'", "none"},
    {"NoMass", "<mass value=\"0.0918\"/>", "", "link 'FL_tilt_link', inertial", "an element <mass>", "none"},
    {"NegativeFriction", "<dynamics damping=\"0.02\"/>", "<dynamics damping=\"0.02\" friction=\"-1\"/>",
     "joint 'FL_tilt'", "friction (N m) >= 0", "-1"},
    {"AllNegativeInertia", "ixx=\"7.84125e-06\" ixy=\"0\" ixz=\"0\" iyy=\"1.53e-05\" iyz=\"0\" izz=\"",
     "ixx=\"-1\" ixy=\"0\" ixz=\"0\" iyy=\"-1\" iyz=\"0\" izz=\"-1", "link 'FL_tilt_link'",
     "positive definite inertia", "principal moments"},
    {"NoRadius", "<geometry><sphere radius=\"0.005\"/></geometry>", "<geometry><sphere/></geometry>",
     "link 'FL_upper_left', collision, geometry, sphere", "attribute 'radius'", "none"},
    {"TwoParentElements", "<parent link=\"trunk\"/>", "<parent link=\"trunk\"/><parent link=\"FL_foot\"/>",
     "joint 'FL_tilt'", "one <parent>", "several"},
    {"FloatingLeg", "<joint name=\"FL_tilt\" type=\"revolute\">",
     "<joint name=\"FL_tilt\" type=\"floating\">", "joint 'FL_tilt'",
     "floating only below a root without mass", "'floating'"},
    {"NegativeDamping", "<dynamics damping=\"0.02\"/>", "<dynamics damping=\"-0.02\"/>", "joint 'FL_tilt'",
     "damping (N m s/rad) >= 0", "-0.02"},
    {"NegativeRadius", "<geometry><sphere radius=\"0.005\"/></geometry>",
     "<geometry><sphere radius=\"-0.005\"/></geometry>", "link 'FL_upper_left', collision 'FL_knee_left'",
     "size (m) > 0", "-0.005"},
};
const auto kLoaderCase = [](const auto& info) { return info.param.name; };
INSTANTIATE_TEST_SUITE_P(RobotLoader, BadUrdf, ::testing::ValuesIn(kBadUrdfs), kLoaderCase);

TEST(RobotLoader, FindsTheFootOfAFiveBarWhereItsLowerLinksAreJoined) {
  const RobotDescription stated = load_robot(kRobotFolder + "robot.yaml");
  const ScratchRobot scratch;
  for (const char* foot : {"FL", "FR", "RL", "RR"})
    scratch.replace("robot.yaml", std::string(", foot: ") + foot + "_foot}", "}");
  const LoadedRobot found = load_robot_with_report(scratch.path("robot.yaml"));
  for (const Leg leg : kLegs) {
    const LegModel &a = (*stated.legs)[leg], &b = (*found.robot.legs)[leg];
    EXPECT_EQ(b.foot_body, a.foot_body);
    EXPECT_EQ(b.p_BF, a.p_BF);
    EXPECT_EQ(b.foot_radius, a.foot_radius);
  }
  scratch.replace("robot.yaml", "link_b: FL_lower_right", "link_b: FL_upper_right");
  EXPECT_NE(std::string(config_error([&] { load_robot(scratch.path("robot.yaml")); }).what())
                .find("legs.FL: expected a loop"),
            std::string::npos);
}

class BadRobotYaml : public ::testing::TestWithParam<BadInput> {};
TEST_P(BadRobotYaml, IsRejectedByName) { expect_error("robot.yaml", GetParam()); }

const BadInput kBadYamls[] = {
    {"UnknownKey", "armature:", "armour:", "line 5, armour", "one of the keys name, urdf, ",
     "unknown key 'armour'"},
    {"MissingKey", "urdf: robot.urdf\n", "", "top level", "key 'urdf'", "none"},
    {"UrdfThatIsAnMjcf", "urdf: robot.urdf", "urdf: robot.xml", "urdf", "a .urdf file", "'robot.xml'"},
    {"NameOfTwoLines", "name: ", "name: \"two\\nlines\" # ", "robot", "a name in one line",
     "'two lines' in several"},
    {"DuplicateKey", "servo:", "armature: 1\nservo:", "line 6, armature", "each key once", "duplicate"},
    {"NotANumber", "kp: 1.0", "kp: one", "servo.kp", "a finite number", "'one'"},
    {"NaN", "armature: 2.0e-4", "armature: .nan", "armature", "a finite number", "'.nan'"},
    {"NegativeArmature", "armature: 2.0e-4", "armature: -2.0e-4", "joint 'FL_tilt'", "armature (kg m^2) >= 0",
     "-0.0002"},
    {"NegativeGain", "kp: 1.0", "kp: -1.0", "joint 'FL_tilt'", "kp (N m/rad) >= 0", "-1"},
    {"WrongLegName", "  FR: {tilt", "  FO: {tilt", "legs.FO", "one of the keys FL, FR, RL, RR",
     "unknown key 'FO'"},
    {"TwiceTheSameLeg", "  FR: {tilt", "  FL: {tilt", "legs.FL", "each key once", "duplicate"},
    {"FootIsNoLink", "foot: FL_foot", "foot: FL_hoof", "legs.FL.foot", "a link of the robot's file",
     "'FL_hoof'"},
    {"FootWithoutSphere", "foot: FL_foot", "foot: FL_lower_left", "legs.FL.foot", "one collision sphere",
     "'FL_lower_left'"},
    {"FootOfAnotherLeg", "foot: FL_foot", "foot: FR_foot", "legs.FL.foot",
     "a foot on a lower link of its leg", "link 'FR_lower_left'"},
    {"UnknownJoint", "tilt: FL_tilt", "tilt: FL_lean", "legs.FL.tilt", "a moving joint of the robot's file",
     "'FL_lean'"},
    {"FixedJoint", "tilt: FL_tilt", "tilt: FL_foot_joint", "legs.FL.tilt",
     "a moving joint of the robot's file", "'FL_foot_joint'"},
    {"JointTwice", "shoulder_right: FL_shoulder_right", "shoulder_right: FL_shoulder_left",
     "legs.FL.shoulder_right", "each joint once", "'FL_shoulder_left' again"},
    {"WrongParent", "elbow_left: FR_elbow_left, elbow_right: FR_elbow_right",
     "elbow_left: FR_elbow_right, elbow_right: FR_elbow_left", "legs.FR.elbow_left",
     "a joint on link 'FR_upper_left'", "joint 'FR_elbow_right' on link 'FR_upper_right'"},
    {"ShoulderIsElbow",
     "shoulder_left: FR_shoulder_left, shoulder_right: FR_shoulder_right,\n       elbow_left: FR_elbow_left",
     "shoulder_left: FR_elbow_left, shoulder_right: FR_shoulder_right,\n       elbow_left: FR_shoulder_left",
     "legs.FR.shoulder_left", "a joint on link 'FR_tilt_link'",
     "joint 'FR_elbow_left' on link 'FR_upper_left'"},
    {"UnknownLoopLink", "link_a: FR_lower_left", "link_a: FR_shin", "loops[1].link_a",
     "a link of the robot's file", "'FR_shin'"},
    {"ShortLoopPoint", "point_a: [0, 0, -0.06]", "point_a: [0, -0.06]", "loops[0].point_a", "3 numbers",
     "a list of 2"},
    {"LoopOnOneLink", "link_b: FL_lower_right", "link_b: FL_foot", "legs.FL",
     "a loop between the two lower links", "none"},
    {"DuplicateLoop", "name: FR_tip", "name: FL_tip", "loop 'FL_tip'", "a unique name", "second"},
    {"SoftnessOutOfRange", "impedance_max: 0.99", "impedance_max: 1.5", "loop_softness.impedance_max",
     "[impedance_min, 1]", "1.5"},
    {"UnknownSoftness", "impedance_max: 0.99", "impedance: 0.99", "loop_softness.impedance",
     "one of the keys", "unknown key 'impedance'"},
    {"HomeThatCannotClose", "shoulder_left: 0.8606149458496", "shoulder_left: 2.5", "home",
     "angles within 0.1 rad of closed loops", "stay open"},
    {"HomeInAnotherMode", "elbow_left: -1.6867970467349", "elbow_left: 1.6867970467349", "home",
     "angles within 0.1 rad of closed loops", "stay open"},
    {"HomeOutOfPlane", "point_a: [0, 0, -0.06]", "point_a: [0, 0.001, -0.06]", "home",
     "loops closed to 1e-05 m", "a gap of 0.001"},
    {"HomeBeyondLimits", "home:\n  tilt: 0", "home:\n  tilt: 1.2", "home", "joint 'FL_tilt' in -1..1 rad",
     "1.2"},
    {"HomeWithoutElbow", "  elbow_right: 1.6867970467349\n", "", "home", "key 'elbow_right'", "none"},
    {"ExceptionOfNoJoint", "servo:", "joints: {FL_lean: {kp: 2}}\nservo:", "joints.FL_lean",
     "a moving joint of the robot's file", "'FL_lean'"},
    {"GainOfAPassiveJoint", "servo:", "joints: {FL_elbow_left: {kp: 2}}\nservo:", "joints.FL_elbow_left.kp",
     "one of the keys damping, implicit_joint_damping, stiffness, armature, friction", "unknown key 'kp'"},
};
INSTANTIATE_TEST_SUITE_P(RobotLoader, BadRobotYaml, ::testing::ValuesIn(kBadYamls), kLoaderCase);

TEST(RobotLoader, NamesLinksThatLeadRoundInACircle) {
  for (const char* name : {"circle.urdf", "circle.xml", "circle.yaml"}) {
    const std::string file = ::testing::TempDir() + name;
    std::filesystem::remove(file);
    std::filesystem::create_symlink(name, file);
    const ConfigError error = config_error([&] { load_robot(file); });
    EXPECT_EQ(error.source(), file);
    EXPECT_EQ(error.found(), "Too many levels of symbolic links");
    std::filesystem::remove(file);
  }
}

TEST(RobotLoader, NamesMissingFiles) {
  const ScratchRobot scratch;
  EXPECT_EQ(config_error([&] { load_robot(scratch.path("no.yaml")); }).source(), scratch.path("no.yaml"));
  EXPECT_EQ(config_error([&] { load_robot(scratch.path("no.urdf")); }).source(), scratch.path("no.urdf"));
  EXPECT_EQ(config_error([&] { load_robot(scratch.path("robot.of_no_format")); }).expected(),
            fmt::format("a {} file", robot_files_in_words()));
  std::filesystem::remove(scratch.path("robot.urdf"));
  EXPECT_EQ(config_error([&] { load_robot(scratch.path("robot.yaml")); }).source(),
            scratch.path("robot.urdf"));
}

TEST(RobotLoader, RejectsAUrdfThatItsYamlDoesNotName) {
  const ScratchRobot scratch;
  scratch.write("other.urdf", "<robot/>");
  const ConfigError error = config_error([&] { load_robot(scratch.path("other.urdf")); });
  EXPECT_EQ(error.source(), scratch.path("robot.yaml"));
  EXPECT_EQ(error.expected(), "'other.urdf'");
  EXPECT_EQ(error.found(), "'robot.urdf'");
}

TEST(RobotLoader, NamesAMovingLinkWithoutInertia) {
  const ScratchRobot scratch;
  scratch.replace("robot.urdf", "</robot>", R"(<link name="ghost"/><joint name="spin" type="continuous">
      <parent link="trunk"/><child link="ghost"/></joint></robot>)");
  const ConfigError error = config_error([&] { load_robot(scratch.path("robot.yaml")); });
  EXPECT_EQ(error.source(), scratch.path("robot.urdf"));
  EXPECT_EQ(error.element(), "link 'ghost'");
  EXPECT_EQ(error.expected(), "an <inertial> element on a moving link");
}

TEST(RobotLoader, NamesTooManyJoints) {
  const ScratchRobot scratch;
  std::string more;
  for (int i = 0; i < 13; ++i) {  // 20 + 13 joints
    const std::string n = std::to_string(i);
    more += "<link name=\"link" + n +
            "\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" "
            "izz=\"1\"/></inertial></link>"
            "<joint name=\"joint" +
            n + "\" type=\"continuous\"><parent link=\"trunk\"/><child link=\"link" + n + "\"/></joint>";
  }
  scratch.replace("robot.urdf", "</robot>", more + "</robot>");
  const ConfigError error = config_error([&] { load_robot(scratch.path("robot.yaml")); });
  EXPECT_EQ(error.expected(), "at most 32 moving joints");
  EXPECT_EQ(error.found(), "33");
}

}  // namespace
}  // namespace crossgait
