// Coupled joints of URDFs and robot.yaml: who follows, which legs come of it, and what is refused.
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "physics/robot/multibody.h"
#include "physics/robot/robot_identity.h"
#include "physics/robot_files/robot_report.h"
#include "physics/robot_files/urdf/urdf_reader.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"
#include "tests/physics/robot_files/serial_urdf.h"

namespace crossgait {
namespace {

class CouplingFiles : public ScratchFolder {
 protected:
  LoadedRobot load(const SerialUrdf& urdf) { return load_robot_with_report(write("made.urdf", urdf.text())); }
  ConfigError refusal(const std::string& text) {
    return config_error([&] { (void)load_robot(write("made.urdf", text)); });
  }
  static int index_of(const RobotDescription& robot, const std::string& joint) {
    int i = 0;
    while (robot.joint(i).name != joint) ++i;
    return i;
  }
  static SerialUrdf with_ankle() {
    SerialUrdf urdf;
    urdf.ankle_mimic = R"(joint="{0}_knee" multiplier="-0.5" offset="0.2")";
    urdf.foot_at = {0, 0, -0.1};
    return urdf;
  }
  static SerialUrdf with_following_knee() {
    SerialUrdf urdf;
    urdf.knee_mimic = R"(joint="{0}_pitch" multiplier="-2")";
    return urdf;
  }
};

TEST_F(CouplingFiles, AnAnkleThatMimicsIsNoServo) {
  const RobotDescription robot = load(with_ankle()).robot;
  EXPECT_EQ(robot.actuated_joints().size(), 12U);
  ASSERT_EQ(robot.couplings.size(), 4U);
  for (const Leg leg : kLegs) {
    const LegModel& model = (*robot.legs)[leg];
    EXPECT_EQ(model.linkage, LegLinkage::kSerial);
    ASSERT_EQ(model.passive.size(), 1U);
    const int ankle = model.joint("ankle"), knee = model.joint("knee");
    EXPECT_EQ(robot.joint(ankle).name, fmt::format("{}_ankle", name(leg)));
    EXPECT_EQ(model.foot_body, ankle + 1);
    const JointCoupling* coupling = robot.coupling_of(ankle);
    ASSERT_NE(coupling, nullptr);
    EXPECT_EQ(coupling->leader, knee);
    EXPECT_EQ(coupling->coefficients, (std::array<double, 5>{0.2, -0.5, 0, 0, 0}));
    EXPECT_NEAR(robot.home[ankle], 0.2 - 0.5 * robot.home[knee], 1e-12);
  }
}

TEST_F(CouplingFiles, AKneeThatMimicsLeavesEightServosAndAHomeInWhichItDoes) {
  const LoadedRobot loaded = load(with_following_knee());
  const RobotDescription& robot = loaded.robot;
  EXPECT_EQ(robot.actuated_joints().size(), 8U);
  const std::vector<Pose> poses = home_poses(robot);
  for (const Leg leg : kLegs) {
    const LegModel& model = (*robot.legs)[leg];
    EXPECT_EQ(model.linkage, LegLinkage::kKneeFollows);
    const int hip = model.joint("hip"), knee = model.joint("knee");
    EXPECT_NEAR(robot.home[knee], -2 * robot.home[hip], 1e-12);
    // Links alike: the foot is below the hip, at 0.72 of both.
    const Vector3 foot =
        foot_position(robot, leg, poses) - poses[static_cast<std::size_t>(hip) + 1].translation();
    EXPECT_NEAR(foot.z(), -0.72 * 0.4, 1e-8);
    EXPECT_NEAR(foot.x(), 0, 1e-8);
  }
  for (const std::string& warning : loaded.report.warnings)
    EXPECT_EQ(warning.find("mimic"), std::string::npos) << warning;
}

TEST_F(CouplingFiles, ARobotYamlSaysAllOfIt) {
  for (const SerialUrdf& urdf : {with_ankle(), with_following_knee()}) {
    const LoadedRobot loaded = load(urdf);
    write("said.yaml", to_yaml(loaded, "made.urdf"));
    const RobotDescription again = load_robot(path("said.yaml"));
    ASSERT_EQ(again.couplings.size(), loaded.robot.couplings.size());
    EXPECT_EQ(again.actuated_joints(), loaded.robot.actuated_joints());
    EXPECT_LT((again.home - loaded.robot.home).norm(), 1e-12);
    for (std::size_t i = 0; i < again.couplings.size(); ++i) {
      EXPECT_EQ(again.couplings[i].coefficients, loaded.robot.couplings[i].coefficients);
      EXPECT_EQ(again.couplings[i].softness.time_constant, loaded.robot.couplings[i].softness.time_constant);
    }
  }
}

TEST_F(CouplingFiles, ChainsAreFollowedToTheirServo) {
  SerialUrdf urdf = with_following_knee();
  urdf.ankle_mimic = R"(joint="{0}_knee" multiplier="-0.5")";
  urdf.foot_at = {0, 0, -0.1};
  const RobotDescription robot = load(urdf).robot;
  EXPECT_EQ(robot.actuated_joints().size(), 8U);
  const LegModel& model = (*robot.legs)[Leg::FL];
  EXPECT_NEAR(robot.home[model.joint("ankle")], robot.home[model.joint("hip")], 1e-12);
}

TEST_F(CouplingFiles, BarsBesideALegMoveAlongWithIt) {
  SerialUrdf urdf;
  for (const Leg leg : kLegs) {
    const std::string p(name(leg));
    urdf.more += urdf.link(p + "_bar", 0.1, {0, 0, -0.1}, "");
    std::string joint = urdf.joint(p + "_bar_joint", p + "_thigh", p + "_bar", {0.03, 0, 0}, Vector3::UnitY(),
                                   R"(lower="-3" upper="3" effort="1" velocity="1")");
    urdf.more += joint.insert(joint.rfind("</joint>"), fmt::format("<mimic joint=\"{}_knee\"/>", p));
  }
  const RobotDescription robot = load(urdf).robot;
  EXPECT_EQ(robot.joint_count(), 16);
  EXPECT_EQ(robot.actuated_joints().size(), 12U);
  for (const JointCoupling& coupling : robot.couplings)
    EXPECT_NEAR(robot.home[coupling.follower], robot.home[coupling.leader], 1e-12);
}

// The rotor of a motor turns with its joint, as often as the gear says: neither whole turns nor limits of
// many turns are mistakes. A multiplier of 9 takes it to 9 times its leader's farthest limit.
TEST_F(CouplingFiles, ARotorBehindAGearTurnsManyTimes) {
  const auto with_rotors = [](const std::string& type, const std::string& limit, int gear) {
    SerialUrdf urdf;
    for (const Leg leg : kLegs) {
      urdf.more += urdf.link(fmt::format("{}_rotor", name(leg)), 0.05, Vector3::Zero(), "");
      urdf.more += fmt::format(
          R"(<joint name="{0}_rotor_joint" type="{1}"><parent link="{0}_hip"/><child link="{0}_rotor"/>)"
          R"(<axis xyz="0 1 0"/>{2}<mimic joint="{0}_pitch" multiplier="{3}"/></joint>)",
          name(leg), type, limit, gear);
    }
    return urdf;
  };
  for (const int gear : {9, -9}) {
    const RobotDescription robot = load(with_rotors("continuous", "", gear)).robot;
    EXPECT_EQ(robot.couplings.size(), 4U);
    const int rotor = index_of(robot, "FL_rotor_joint"), pitch = index_of(robot, "FL_pitch");
    EXPECT_FALSE(robot.joint(rotor).limited);
    EXPECT_EQ(robot.joint(rotor).upper, 9 * robot.joint(pitch).upper);
    EXPECT_EQ(robot.joint(rotor).lower, -robot.joint(rotor).upper);
    EXPECT_NEAR(robot.home[rotor], gear * robot.home[pitch], 1e-12);
    EXPECT_GT(std::abs(robot.home[rotor]), std::numbers::pi) << "or this says nothing";
  }
  const LoadedRobot limited =
      load(with_rotors("revolute", R"(<limit lower="-100" upper="100" effort="1" velocity="1"/>)", 9));
  const Joint& rotor = limited.robot.joint(index_of(limited.robot, "FL_rotor_joint"));
  EXPECT_TRUE(rotor.limited);
  EXPECT_EQ(rotor.upper, 100);
  EXPECT_TRUE(limited.report.warnings.empty());
  const LoadedRobot endless =
      load(with_rotors("revolute", R"(<limit lower="-1e9" upper="1e9" effort="1" velocity="1"/>)", 9));
  EXPECT_FALSE(endless.robot.joint(index_of(endless.robot, "FL_rotor_joint")).limited);
}

TEST_F(CouplingFiles, WhatIsHeldIsHeldWhereItsLeaderHasIt) {
  SerialUrdf urdf;
  for (const char* finger : {"left", "right"})
    urdf.more += urdf.link(std::string(finger) + "_finger", 0.1, {0, 0, 0}, "") +
                 urdf.joint(finger, "trunk", std::string(finger) + "_finger", {0.3, 0, 0}, Vector3::UnitZ(),
                            R"(lower="0.1" upper="1" effort="1" velocity="1")");
  urdf.more.insert(urdf.more.rfind("</joint>"), R"(<mimic joint="left" multiplier="2" offset="0.3"/>)");
  const LoadedRobot loaded = load(urdf);
  EXPECT_TRUE(loaded.robot.couplings.empty());
  EXPECT_DOUBLE_EQ(loaded.report.locked.at("left"), 0.1);
  EXPECT_DOUBLE_EQ(loaded.report.locked.at("right"), 0.5);
}

TEST_F(CouplingFiles, WhatCannotBeFollowedIsRefused) {
  SerialUrdf urdf = with_following_knee();
  urdf.knee_mimic = R"(joint="{0}_elbow")";
  const ConfigError unknown = refusal(urdf.text());
  EXPECT_NE(unknown.element().find("joint 'FL_knee', mimic, joint"), std::string::npos) << unknown.what();
  EXPECT_EQ(unknown.found(), "'FL_elbow'");
  urdf.knee_mimic = R"(joint="{0}_pitch" multiplier="two")";
  EXPECT_EQ(refusal(urdf.text()).expected(), "1 finite number");
  urdf.knee_mimic = R"(joint="{0}_ankle")";
  urdf.ankle_mimic = R"(joint="{0}_knee")";
  EXPECT_NE(refusal(urdf.text()).found().find("in a circle"), std::string::npos);
  // Of another leg.
  urdf.ankle_mimic = "";
  urdf.knee_mimic = R"(joint="RR_pitch")";
  const ConfigError across = refusal(urdf.text());
  EXPECT_EQ(across.element(), "legs.FL.knee");
  EXPECT_EQ(across.expected(), "a servo, or a joint that follows one of this leg");
  // A hip that follows leaves nothing to walk with.
  std::string text = SerialUrdf().text();
  const std::size_t hip = text.find("</joint>", text.find("joint name=\"FL_pitch\""));
  text.insert(hip, R"(<mimic joint="FL_knee"/>)");
  EXPECT_EQ(refusal(text).element(), "joint 'FL_pitch' of a leg");
}

}  // namespace
}  // namespace crossgait
