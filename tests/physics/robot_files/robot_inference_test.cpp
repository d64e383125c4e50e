// A robot from its URDF alone: what is inferred, and what is refused.
#include "physics/robot_files/inference/robot_inference.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "physics/robot/multibody.h"
#include "physics/robot/robot_identity.h"
#include "physics/robot_files/robot_report.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"
#include "tests/physics/robot_files/serial_urdf.h"

namespace crossgait {
namespace {

class Inferred : public ScratchFolder {
 protected:
  LoadedRobot load(const SerialUrdf& urdf) { return load_robot_with_report(write("made.urdf", urdf.text())); }
  ConfigError refusal(const std::string& text) {
    return config_error([&] { (void)load_robot(write("made.urdf", text)); });
  }
  static std::string joint_name(const RobotDescription& robot, Leg leg, const char* role) {
    return robot.joint((*robot.legs)[leg].joint(role)).name;
  }
  /// Of the hip at home, in the base's frame.
  static Vector3 hip_axis_at_home(const RobotDescription& robot, Leg leg) {
    const int hip = (*robot.legs)[leg].joint("hip");
    return home_poses(robot)[static_cast<std::size_t>(hip) + 1].linear() * robot.joint(hip).axis;
  }
  static double home_abduction(const RobotDescription& robot, Leg leg) {
    return robot.home[(*robot.legs)[leg].joint("abduction")];
  }
  static const Inference* find(const RobotReport& report, const std::string& what) {
    for (const Inference& i : report.inferred) {
      if (i.what == what) return &i;
    }
    return nullptr;
  }
  /// Foot below the hip, in the hip's body frame's place, at home.
  static Vector3 foot_from_hip(const RobotDescription& robot, Leg leg) {
    const std::vector<Pose> poses = home_poses(robot);
    const auto hip = static_cast<std::size_t>((*robot.legs)[leg].joint("hip")) + 1;
    return foot_position(robot, leg, poses) - poses[hip].translation();
  }
};

TEST_F(Inferred, LegsAreWhereTheyStandWhateverTheirNames) {
  SerialUrdf urdf;
  urdf.prefix = [](Leg leg) { return std::string("leg_") + "dcba"[index(leg)]; };
  const auto [robot, report] = load(urdf);
  for (const Leg leg : kLegs) {
    const std::string p = urdf.prefix(leg);
    EXPECT_EQ((*robot.legs)[leg].linkage, LegLinkage::kSerial);
    EXPECT_EQ(joint_name(robot, leg, "abduction"), p + "_abduction");
    EXPECT_EQ(joint_name(robot, leg, "hip"), p + "_pitch");
    EXPECT_EQ(joint_name(robot, leg, "knee"), p + "_knee");
    EXPECT_EQ((*robot.legs)[leg].p_BF, Vector3(0, 0, -0.2));
    EXPECT_EQ((*robot.legs)[leg].foot_radius, 0.02);
  }
  EXPECT_EQ(report.warnings, std::vector<std::string>());
  EXPECT_EQ(robot.actuated_joints().size(), 12U);
}

TEST_F(Inferred, NamesThatSayAnotherLegAreToldOf) {
  SerialUrdf urdf;
  urdf.prefix = [](Leg leg) {  // right and left exchanged in front
    return std::string(leg == Leg::FL   ? "front_right"
                       : leg == Leg::FR ? "FL"
                       : leg == Leg::RL ? "LH"
                                        : "hind_right");
  };
  const auto [robot, report] = load(urdf);
  const std::set<std::string> warnings(report.warnings.begin(), report.warnings.end());
  EXPECT_EQ(warnings,
            (std::set<std::string>{"joint 'front_right_abduction' is named as of FR and stands where FL is",
                                   "joint 'FL_abduction' is named as of FL and stands where FR is"}));
}

TEST_F(Inferred, HomeHasTheFeetAtTheirDepthUnderTheCentreOfMass) {
  for (const bool abduction : {true, false}) {
    SerialUrdf urdf;
    urdf.abduction = abduction;
    const RobotDescription robot = load(urdf).robot;
    const std::vector<Pose> poses = home_poses(robot);
    double com = 0, feet = 0;
    for (std::size_t i = 0; i < poses.size(); ++i)
      com +=
          robot.bodies[i].inertia.mass * (poses[i] * robot.bodies[i].inertia.p_BC).x() / robot.total_mass();
    for (const Leg leg : kLegs) {
      const Vector3 foot = foot_from_hip(robot, leg);
      EXPECT_NEAR(foot.z(), -0.72 * 0.4, 1e-12);  // rounding of lengths of 0.4 m
      EXPECT_NEAR(foot.x(), robot.stance_offset, 1e-12);
      EXPECT_NEAR(foot.y(), 0, 1e-12);
      feet += foot_position(robot, leg, poses).x() / kLegCount;
      EXPECT_LT(robot.home[(*robot.legs)[leg].joint("knee")], 0) << "knees that only bend backward";
    }
    EXPECT_NEAR(feet, com, 1e-8);  // ten rounds, each a fifth or less of the one before
    EXPECT_GT(std::abs(robot.stance_offset), 0.01);
    EXPECT_EQ(robot.standing_height, 0.72 * 0.4);
    EXPECT_NEAR(robot.home_height, 0.72 * 0.4 + 0.02, 1e-12);
  }
}

TEST_F(Inferred, HipAxesAreLevelAtHomeAboutWhateverAbductionAxis) {
  SerialUrdf urdf;
  urdf.abduction_axis = Vector3(0.97, 0.14, 0.2).normalized();
  const RobotDescription robot = load(urdf).robot;
  for (const Leg leg : kLegs) {
    EXPECT_NEAR(hip_axis_at_home(robot, leg).z(), 0, 1e-9) << name(leg);
    EXPECT_NEAR(home_abduction(robot, leg), 0, 1e-9) << name(leg) << ": it was level already";
  }
}

// An axis that leans more than it is away from the other cannot turn it level; it turns it as near as it
// gets.
TEST_F(Inferred, HipAxesAreAsLevelAsTheyGet) {
  constexpr double kLean = 10 * M_PI / 180, kBetween = 4 * M_PI / 180, kTurned = 0.6;
  for (const double sign : {1.0, -1.0}) {
    SerialUrdf urdf;
    const auto leaning = [sign](double angle) { return Vector3(0, std::cos(angle), sign * std::sin(angle)); };
    urdf.abduction_axis = leaning(kLean);
    urdf.hip_axis = Eigen::AngleAxisd(-kTurned, urdf.abduction_axis) * leaning(kLean - kBetween);
    // By their axes alone these would be hip, knee and ankle.
    std::string yaml = "urdf: made.urdf\nlegs:\n";
    for (const Leg leg : kLegs)
      yaml += fmt::format("  {0}: {{abduction: {0}_abduction, hip: {0}_pitch, knee: {0}_knee}}\n", name(leg));
    write("made.urdf", urdf.text());
    const RobotDescription robot = load_robot(write("robot.yaml", yaml));
    for (const Leg leg : kLegs) {
      const double lean = std::asin(hip_axis_at_home(robot, leg).z());
      EXPECT_NEAR(lean, sign * (kLean - kBetween), 1e-7) << name(leg);
      EXPECT_NEAR(home_abduction(robot, leg), kTurned, 1e-7) << name(leg);
    }
  }
}

TEST_F(Inferred, KneesBendForwardWhereTheyCannotBendBackward) {
  SerialUrdf urdf;
  urdf.knee_limits = R"(lower="0.5" upper="2.6" effort="30" velocity="1")";
  const auto [robot, report] = load(urdf);
  EXPECT_GT(robot.home[(*robot.legs)[Leg::RR].joint("knee")], 0.5);
  EXPECT_NEAR(foot_from_hip(robot, Leg::RR).z(), -0.288, 1e-12);
  EXPECT_NE(find(report, "home")->value.find("RR forward"), std::string::npos);
  urdf.knee_limits = R"(lower="-2.6" upper="2.6" effort="30" velocity="1")";
  EXPECT_LT(load(urdf).robot.home[(*robot.legs)[Leg::RR].joint("knee")], 0);
}

TEST_F(Inferred, AFrameThatIsNotRep103IsTurned) {
  const RobotDescription expected = load({}).robot;
  SerialUrdf urdf;
  urdf.R << 0, 0, 1, 1, 0, 0, 0, 1, 0;  // forward along the file's y, up along its x
  const auto [robot, report] = load(urdf);
  EXPECT_LT((report.R_BA - urdf.R).norm(), 1e-12);
  EXPECT_LT((robot.home - expected.home).norm(), 1e-9);
  EXPECT_LT((robot.bodies[0].inertia.p_BC - Vector3(0.03, 0, 0)).norm(), 1e-15);
  const std::vector<Pose> poses = home_poses(robot), others = home_poses(expected);
  for (const Leg leg : kLegs)
    EXPECT_LT((foot_position(robot, leg, poses) - foot_position(expected, leg, others)).norm(), 1e-9);
  EXPECT_NE(find(report, "frame")->reason.find("a guess"), std::string::npos);
}

TEST_F(Inferred, KneesAboveTheHipsSayThatZPointsDown) {
  const RobotDescription expected = load({}).robot;
  SerialUrdf urdf;
  urdf.R << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  const auto [robot, report] = load(urdf);
  EXPECT_LT((report.R_BA - urdf.R).norm(), 1e-12);
  EXPECT_LT((robot.home - expected.home).norm(), 1e-9);
  EXPECT_NE(find(report, "frame")->reason.find("z points down"), std::string::npos);
}

TEST_F(Inferred, WhatIsNoLegIsLocked) {
  SerialUrdf urdf;
  urdf.more = urdf.link("arm", 1, {0, 0, 0.1}, "") +
              urdf.joint("arm_joint", "trunk", "arm", {0.1, 0, 0.05}, Vector3::UnitZ(),
                         R"(lower="-1" upper="1" effort="1" velocity="1")");
  const auto [robot, report] = load(urdf);
  EXPECT_EQ(robot.joint_count(), 12);
  EXPECT_EQ(robot.bodies[0].inertia.mass, 9);
  EXPECT_LT((robot.bodies[0].inertia.p_BC - Vector3(0.34, 0, 0.15) / 9).norm(), 1e-15);
  EXPECT_EQ(find(report, "locked")->value, "arm_joint");
}

TEST_F(Inferred, ServosFollowFromMassAndHeight) {
  SerialUrdf urdf;
  urdf.knee_limits = R"(lower="-2.6" upper="-0.5" effort="1000" velocity="1")";
  const auto [robot, report] = load(urdf);
  const double m = 20, g = 9.81, h = 0.288;
  const Joint& hip = robot.joint((*robot.legs)[Leg::FL].joint("hip"));
  EXPECT_NEAR(hip.kp, 3 * m * g * h, 1e-9);
  EXPECT_NEAR(hip.kd, 2 * 0.3 * hip.kp / std::sqrt(g / (0.03 * h)), 1e-9);
  EXPECT_NEAR(hip.armature, 0.005 * m * h * h, 1e-12);
  EXPECT_EQ(hip.effort_limit, 20) << "as the file says";
  const Joint& knee = robot.joint((*robot.legs)[Leg::FL].joint("knee"));
  EXPECT_NEAR(knee.effort_limit, 0.8 * m * g * h, 1e-9) << "1000 N m is no torque of such a machine";
  EXPECT_NE(find(report, "effort")->value.find("4 joint(s) from 'FL_knee'"), std::string::npos);
}

TEST_F(Inferred, AFootWithoutASphereIsAtTheEndOfItsShape) {
  SerialUrdf urdf;
  urdf.foot_shape = R"(<cylinder radius="0.01" length="0.2"/>)";
  urdf.foot_at = {0, 0, -0.1};
  const auto [robot, report] = load(urdf);
  const LegModel& leg = (*robot.legs)[Leg::RL];
  EXPECT_NEAR(leg.foot_radius, 0.05 * 0.2, 1e-15);
  EXPECT_LT((leg.p_BF - Vector3(0, 0, -0.19)).norm(), 1e-12);
  const std::vector<CollisionShape>& shapes = robot.bodies[static_cast<std::size_t>(leg.foot_body)].shapes;
  ASSERT_EQ(shapes.size(), 1U) << "the foot alone touches";
  EXPECT_EQ(leg_of_shape(robot, leg.foot_body, 0), static_cast<int>(Leg::RL));
}

TEST_F(Inferred, AFootWithoutASphereIsTheEndOfACapsule) {
  SerialUrdf urdf;
  urdf.foot_shape = R"(<capsule radius="0.015" length="0.18"/>)";
  urdf.foot_at = {0, 0, -0.1};
  const auto [robot, report] = load(urdf);
  const LegModel& leg = (*robot.legs)[Leg::RL];
  EXPECT_EQ(leg.foot_radius, 0.015);
  EXPECT_LT((leg.p_BF - Vector3(0, 0, -0.19)).norm(), 1e-12);
  EXPECT_NE(find(report, "legs.RL.foot")->reason.find("capsule"), std::string::npos);
  EXPECT_EQ(robot.bodies[static_cast<std::size_t>(leg.foot_body)].shapes.size(), 1U)
      << "the foot alone touches";
}

TEST_F(Inferred, AShinThatEndsInItsFootDoesNotTouch) {
  SerialUrdf urdf;
  const auto with_shin = [&urdf](double length) {
    std::string text = urdf.text();
    const std::string at = "</collision></link>\n<joint name=\"FL_knee\"";
    const std::string shin = fmt::format(
        "</collision><collision><origin xyz=\"0 0 {}\"/><geometry><cylinder radius=\"0.015\" "
        "length=\"{}\"/></geometry>",
        -length / 2, length);
    return text.insert(text.find(at), shin);
  };
  const auto shapes = [](const RobotDescription& robot) {
    return robot.bodies[static_cast<std::size_t>((*robot.legs)[Leg::FL].foot_body)].shapes.size();
  };
  const auto ends_in_it = load_robot_with_report(write("made.urdf", with_shin(0.2)));
  EXPECT_EQ(shapes(ends_in_it.robot), 1U);
  ASSERT_EQ(ends_in_it.report.warnings.size(), 1U);
  EXPECT_EQ(ends_in_it.report.warnings[0],
            "left out 1 collision shape(s) around feet, first of 'FL_shin': feet alone touch");
  // Two radii from the foot's centre, 0.02 m each, and a little more.
  const auto ends_above = load_robot_with_report(write("made.urdf", with_shin(0.2 - 0.04 - 1e-6)));
  EXPECT_EQ(shapes(ends_above.robot), 2U);
  EXPECT_TRUE(ends_above.report.warnings.empty());
}

TEST_F(Inferred, TheWrittenYamlMakesTheSameRobot) {
  SerialUrdf urdf;
  urdf.R << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  urdf.knee_limits = R"(lower="-2.6" upper="-0.5" effort="1000" velocity="1")";
  urdf.more = urdf.link("arm", 1, {0, 0, 0.1}, "") +
              urdf.joint("arm's joint", "trunk", "arm", {0.1, 0, 0.05}, Vector3::UnitZ(),
                         R"(lower="-1" upper="1" effort="1" velocity="1")");
  const LoadedRobot loaded = load(urdf);
  const auto [robot, report] = load_robot_with_report(write("robot.yaml", to_yaml(loaded, "made.urdf")));
  EXPECT_TRUE(report.inferred.empty()) << report.inferred.front().what;
  EXPECT_EQ(robot.name, loaded.robot.name);
  EXPECT_LT((robot.home - loaded.robot.home).norm(), 1e-15);
  EXPECT_EQ(robot.standing_height, loaded.robot.standing_height);
  EXPECT_EQ(robot.stance_offset, loaded.robot.stance_offset);
  ASSERT_EQ(robot.bodies.size(), loaded.robot.bodies.size());
  for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
    const Body &a = robot.bodies[i], &b = loaded.robot.bodies[i];
    EXPECT_EQ(a.name, b.name);
    EXPECT_LT((a.X_PB.matrix() - b.X_PB.matrix()).norm(), 1e-12);
    EXPECT_EQ(a.shapes.size(), b.shapes.size());
    EXPECT_EQ(a.joint.kp, b.joint.kp);
    EXPECT_EQ(a.joint.kd, b.joint.kd);
    EXPECT_EQ(a.joint.armature, b.joint.armature);
    EXPECT_EQ(a.joint.effort_limit, b.joint.effort_limit);
  }
  EXPECT_NEAR(robot.home_height, loaded.robot.home_height, 1e-12);
}

TEST_F(Inferred, YamlOverridesOneThingAndLeavesTheRestInferred) {
  write("made.urdf", SerialUrdf().text());
  const auto [robot, report] = load_robot_with_report(
      write("robot.yaml", "name: mine\nurdf: made.urdf\nstanding_height: 0.3\nservo: {kp: 50, kd: 1}\n"));
  EXPECT_EQ(robot.name, "mine");
  EXPECT_NEAR(foot_from_hip(robot, Leg::FR).z(), -0.3, 1e-12);
  EXPECT_EQ(robot.joint(0).kp, 50);
  EXPECT_EQ(robot.joint(0).effort_limit, 20);
  EXPECT_NEAR(robot.joint(0).armature, 0.005 * 20 * 0.3 * 0.3, 1e-12);
  EXPECT_EQ(find(report, "servo"), nullptr);
  EXPECT_NE(find(report, "home"), nullptr);
}

TEST_F(Inferred, TheRuleTakesThePlaceOfTheFilesGainsWhereItIsAsked) {
  const SerialUrdf urdf;
  const ServoRule rule = [&] {
    const RobotDescription robot = load(urdf).robot;
    return servo_rule(robot.total_mass(), robot.standing_height, robot.standing_height / kStandingShare);
  }();
  write("robot.yaml", "urdf: made.urdf\nservo: {kp: 7, kd: 1, effort: 9}\n");
  const std::string file = path("made.urdf");
  const auto hip = [](const LoadedRobot& loaded) { return loaded.robot.joint(1); };
  EXPECT_EQ(hip(load_robot_with_report(file)).kp, 7);
  EXPECT_EQ(hip(load_robot_with_report(file, ServoSource::kRule)).kp, rule.kp);
  EXPECT_EQ(hip(load_robot_with_report(file, ServoSource::kRule)).kd, rule.kd);
  write("robot.yaml", "urdf: made.urdf\nservo: rule\n");
  EXPECT_EQ(hip(load_robot_with_report(file)).kp, rule.kp);
  EXPECT_EQ(hip(load_robot_with_report(file)).effort_limit, 20);  // the URDF's
}

TEST_F(Inferred, AServoLawIsReadByNameAndWrittenAsNumbers) {
  write("made.urdf", SerialUrdf().text());
  const auto read = [&](const std::string& rest) {
    return load_robot_with_report(
        write("robot.yaml", "urdf: made.urdf\nservo: {kp: 70, kd: 2, effort: 9, " + rest));
  };
  const LoadedRobot drive = read("law: drive}\njoints: {FL_knee: {law: damping}}\n");
  EXPECT_EQ(drive.robot.joint(0).implicit_stiffness, 1);
  EXPECT_EQ(drive.robot.joint(0).implicit_damping, 1);
  const Joint& knee = drive.robot.joint((*drive.robot.legs)[Leg::FL].joint("knee"));
  EXPECT_EQ(knee.implicit_stiffness, 0);
  EXPECT_EQ(knee.implicit_damping, 1);
  const LoadedRobot again = load_robot_with_report(write("written.yaml", to_yaml(drive, path("made.urdf"))));
  EXPECT_EQ(identity_hash(again.robot), identity_hash(drive.robot));
  EXPECT_NE(identity_hash(read("law: explicit}\n").robot), identity_hash(drive.robot));
  EXPECT_EQ(identity_text(read("law: explicit}\n").robot).find("implicit"), std::string::npos)
      << "robots keep the identity that they had before there were laws";
  const auto complaint = [&](const std::string& rest) {
    return std::string(config_error([&] { read(rest); }).what());
  };
  EXPECT_NE(complaint("law: spring}\n").find("expected one of explicit, damping, drive"), std::string::npos);
  EXPECT_NE(complaint("law: drive, implicit_damping: 1}\n")
                .find("servo.implicit_damping: expected either a law or its numbers, found both"),
            std::string::npos);
}

TEST_F(Inferred, ATorqueLimitThatNoServoHasIsReplacedAndSaid) {
  SerialUrdf urdf;
  urdf.knee_limits = R"(lower="-2.6" upper="-0.5" effort="1000" velocity="1")";
  const auto [robot, report] = load(urdf);
  const double used = robot.joint((*robot.legs)[Leg::FL].joint("knee")).effort_limit;
  EXPECT_LT(used, 1000);
  const std::string expected = fmt::format(
      "the file's torque limit of 1e+03 N m of 4 joint(s) from 'FL_knee' is that of no servo of this "
      "robot: {:.3g} N m is used (0.8 m g h)",
      used);
  EXPECT_NE(std::find(report.warnings.begin(), report.warnings.end(), expected), report.warnings.end())
      << fmt::format("{}", fmt::join(report.warnings, "\n"));
}

TEST_F(Inferred, AnEnvironmentBesideARobotIsNotItsRobotYaml) {
  const std::string file = write("made.urdf", SerialUrdf().text());
  write("made.yaml", "robot: made.urdf\naction: joints\n");
  EXPECT_EQ(load_robot(file).source, file);
  // One of its own is looked for all the same.
  write("robot.yaml", "urdf: made.urdf\nname: other\n");
  EXPECT_EQ(load_robot(file).name, "other");
  EXPECT_EQ(config_error([&] { (void)load_robot(path("made.yaml")); }).found(), "an environment");
  // What is neither is still the robot's.
  write("made.yaml", "wings: 2\n");
  EXPECT_THROW((void)load_robot(file), ConfigError);
}

struct Refusal {
  const char* name;
  std::function<std::string()> text;
  std::vector<std::string> parts;  ///< of the message
};

class RefusedRobots : public ScratchFolder, public ::testing::WithParamInterface<Refusal> {};

TEST_P(RefusedRobots, SayWhatWasFound) {
  write("made.urdf", GetParam().text());
  const ConfigError error = config_error([&] { (void)load_robot(path("made.urdf")); });
  for (const std::string& part : GetParam().parts)
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
}

std::string with_shank(int links) {
  SerialUrdf urdf;
  for (const Leg leg : kLegs) {
    std::string parent = urdf.prefix(leg) + "_shin";
    for (int i = 0; i < links; ++i) {
      const std::string child = urdf.prefix(leg) + "_more" + std::to_string(i);
      urdf.more += urdf.link(child, 1, {0, 0, 0}, "") +
                   urdf.joint(child + "_joint", parent, child, {0, 0, -0.1}, Vector3::UnitY(),
                              R"(lower="-1" upper="1" effort="1" velocity="1")");
      parent = child;
    }
  }
  return urdf.text();
}

std::string eight_chains() {
  SerialUrdf legs;
  legs.abduction = false;
  SerialUrdf others = legs;
  others.prefix = [](Leg leg) { return "other_" + std::string(name(leg)); };
  std::string text = others.text();
  text = text.substr(text.find("<joint name=\"other_FL_pitch\""));
  legs.more = text.substr(0, text.find("</robot>"));
  return legs.text();
}

std::string three_legs() {
  std::string text = SerialUrdf().text();
  return text.replace(text.find("<joint name=\"RR_knee\" type=\"revolute\""),
                      std::string("<joint name=\"RR_knee\" type=\"revolute\"").size(),
                      "<joint name=\"RR_knee\" type=\"fixed\"");
}

std::string in_one_quadrant() {
  std::string text = SerialUrdf().text();
  const std::string from = "<origin xyz=\"-0.2 0.05 0\"/>";  // of RL
  return text.replace(text.find(from), from.size(), "<origin xyz=\"0.3 0.05 0\"/>");
}

std::string without_foot() {
  SerialUrdf urdf;
  urdf.foot_shape.clear();  // and no link is fixed to the shin
  return urdf.text();
}

std::string with_missing_foot() {
  SerialUrdf urdf;
  urdf.foot_shape = R"(<mesh filename="gone.stl"/>)";
  return urdf.text();
}

std::string stiff_knees() {
  SerialUrdf urdf;
  urdf.knee_limits = R"(lower="-0.1" upper="0.1" effort="1" velocity="1")";
  return urdf.text();
}

INSTANTIATE_TEST_SUITE_P(
    Inference, RefusedRobots,
    ::testing::Values(
        Refusal{"EightChains", eight_chains, {"eight chains of two joints", "`loops`", "robot.yaml"}},
        Refusal{"SixJointsALeg",
                [] { return with_shank(3); },
                {"from 'FL_abduction'", "2 or 3 moving joints", "found 6"}},
        Refusal{"ThreeLegs",
                three_legs,
                {"four branches of the base that are alike", "2 joints from 'RR_abduction'"}},
        Refusal{"TwoInOneQuadrant", in_one_quadrant, {"one leg in each quadrant", "both"}},
        Refusal{"NoFoot", without_foot, {"link 'FL_shin'", "a collision shape to find the foot by"}},
        Refusal{"MissingFoot",
                with_missing_foot,
                {"a collision shape to find the foot by",
                 "found none (dropped 4 collision mesh(es) whose file is not there, first in link 'FL_shin' "
                 "('gone.stl'))"}},
        Refusal{"StiffKnees", stiff_knees, {"legs.FL", "limits that forbid it", "'FL_knee' -0.1..0.1"}}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace crossgait
