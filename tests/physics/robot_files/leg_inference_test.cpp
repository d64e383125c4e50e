// Legs of other kinds than abduction, hip, knee: their joints' roles, which leg is which, and feet.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "physics/robot/multibody.h"
#include "physics/robot_files/inference/leg_names.h"
#include "physics/robot_files/robot_report.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"
#include "tests/physics/robot_files/chain_urdf.h"

namespace crossgait {
namespace {

class LegInference : public ScratchFolder {
 protected:
  LoadedRobot load(const ChainUrdf& urdf) {
    std::filesystem::remove(path("robot.yaml"));
    return load_robot_with_report(write("made.urdf", urdf.text()));
  }
  LoadedRobot load(const ChainUrdf& urdf, const std::string& yaml) {
    write("made.urdf", urdf.text());
    return load_robot_with_report(write("robot.yaml", "urdf: made.urdf\n" + yaml));
  }
  static std::vector<std::string> joints_of(const RobotDescription& robot, Leg leg) {
    std::vector<std::string> names;
    for (const int joint : (*robot.legs)[leg].servos) names.push_back(robot.joint(joint).name);
    return names;
  }
  /// Of the foot from the hip, at home.
  static Vector3 foot_from_hip(const RobotDescription& robot, Leg leg) {
    const std::vector<Pose> poses = home_poses(robot);
    const auto hip = static_cast<std::size_t>((*robot.legs)[leg].joint("hip")) + 1;
    return foot_position(robot, leg, poses) - poses[hip].translation();
  }
  /// Whether all feet stand at the robot's height below their hips, 0.07 m beside them or below them.
  static void expect_standing(const RobotDescription& robot, double aside) {
    for (const Leg leg : kLegs) {
      const Vector3 p = foot_from_hip(robot, leg);
      EXPECT_NEAR(p.z(), -robot.standing_height, 1e-12) << name(leg);  // rounding of lengths of 0.4 m
      EXPECT_NEAR(p.y(), aside * side_sign(leg), 1e-12) << name(leg);
    }
  }
  static bool warns(const RobotReport& report, const std::string& part) {
    return std::ranges::any_of(report.warnings,
                               [&](const std::string& w) { return w.find(part) != std::string::npos; });
  }
};

std::vector<ChainJoint> with(std::vector<ChainJoint> joints, const ChainJoint& last, double shin) {
  joints.back().next.z() = shin;
  joints.push_back(last);
  return joints;
}

TEST_F(LegInference, AnAbductionBehindTheHipIsStillTheAbduction) {
  ChainUrdf urdf;
  urdf.joints = [](Leg leg) {
    return std::vector<ChainJoint>{{"first", Vector3::UnitY(), {0, 0.07 * side_sign(leg), 0}, -1.5, 2.5},
                                   {"second", Vector3::UnitX(), {0, 0, -0.2}, -0.9, 0.9},
                                   {"third", Vector3::UnitY(), {0, 0, -0.2}, -2.6, -0.6}};
  };
  const RobotDescription robot = load(urdf).robot;
  for (const Leg leg : kLegs) {
    const LegModel& model = (*robot.legs)[leg];
    EXPECT_EQ(model.linkage, LegLinkage::kHipFirst);
    EXPECT_EQ(robot.joint(model.joint("hip")).name, fmt::format("{}_first", name(leg)));
    EXPECT_EQ(robot.joint(model.joint("abduction")).name, fmt::format("{}_second", name(leg)));
    EXPECT_EQ(robot.home[model.joint("abduction")], 0);
  }
  expect_standing(robot, 0.07);
}

TEST_F(LegInference, AnAbductionBehindATiltedHipMakesTheKneeParallelToIt) {
  ChainUrdf urdf;
  const double tilt = 0.1;
  urdf.joints = [tilt](Leg leg) {
    return std::vector<ChainJoint>{{"a", Vector3::UnitY(), {0, 0.07 * side_sign(leg), 0}, -1.5, 2.5},
                                   {"b", Vector3::UnitX(), {0, 0, -0.2}, -0.9, 0.9},
                                   {"c", {0, std::cos(tilt), std::sin(tilt)}, {0, 0, -0.2}, -2.6, -0.6}};
  };
  const RobotDescription robot = load(urdf).robot;
  for (const Leg leg : kLegs) {
    EXPECT_NEAR(robot.home[(*robot.legs)[leg].joint("abduction")], -tilt, 1e-12);
    EXPECT_NEAR(foot_from_hip(robot, leg).z(), -robot.standing_height, 1e-12);
  }
}

TEST_F(LegInference, TheWrittenYamlKnowsTheHipFirst) {
  ChainUrdf urdf;
  urdf.joints = [](Leg leg) {
    std::vector<ChainJoint> joints = ChainUrdf::usual(leg);
    std::swap(joints[0].axis, joints[1].axis);
    return joints;
  };
  const LoadedRobot loaded = load(urdf);
  const auto [robot, report] = load_robot_with_report(write("robot.yaml", to_yaml(loaded, "made.urdf")));
  EXPECT_EQ((*robot.legs)[Leg::RR].linkage, LegLinkage::kHipFirst);
  EXPECT_LT((robot.home - loaded.robot.home).norm(), 1e-15);
}

TEST_F(LegInference, ThreePitchesAreHipKneeAndAHeldAnkle) {
  ChainUrdf urdf;
  double lower = -1;
  urdf.joints = [&lower](Leg leg) {
    return std::vector<ChainJoint>{{"hip", Vector3::UnitY(), {0, 0.05 * side_sign(leg), -0.15}, -1.5, 2.5},
                                   {"knee", Vector3::UnitY(), {0, 0, -0.15}, -2.6, -0.3},
                                   {"ankle", Vector3::UnitY(), {0, 0, -0.1}, lower, 1.5}};
  };
  for (const double limit : {-1.0, 0.4}) {
    lower = limit;
    const auto [robot, report] = load(urdf);
    EXPECT_EQ(joints_of(robot, Leg::FR), (std::vector<std::string>{"FR_hip", "FR_knee"}));
    EXPECT_EQ(report.locked.at("RL_ankle"), std::max(0.0, limit)) << "next to zero within its limits";
    EXPECT_TRUE(warns(report, "held are FL_ankle")) << fmt::format("{}", fmt::join(report.warnings, "\n"));
    expect_standing(robot, 0.05);
  }
}

TEST_F(LegInference, WhatLegsHaveBeyondTheirRolesIsHeld) {
  const ChainJoint ankle{"ankle", Vector3::UnitY(), {0, 0, -0.05}};
  const ChainJoint twist{"ankle", Vector3::UnitX(), {0, 0, -0.05}};
  const std::vector<std::string> expected{"FL_abduction", "FL_hip", "FL_knee"};
  ChainUrdf urdf;
  for (const ChainJoint& last : {ankle, twist}) {
    urdf.joints = [&](Leg leg) { return with(ChainUrdf::usual(leg), last, -0.15); };
    EXPECT_EQ(joints_of(load(urdf).robot, Leg::FL), expected);
  }
  // Behind alone: the legs are still alike in what has a role.
  urdf.joints = [&](Leg leg) {
    return is_front(leg) ? ChainUrdf::usual(leg) : with(ChainUrdf::usual(leg), ankle, -0.15);
  };
  EXPECT_EQ(joints_of(load(urdf).robot, Leg::FL), expected);
  EXPECT_EQ(load(urdf).report.locked.size(), 2U);
  // Of two joints that turn a leg aside the one about the vertical.
  urdf.joints = [](Leg leg) {
    std::vector<ChainJoint> joints = ChainUrdf::usual(leg);
    joints.insert(joints.begin(), {"yaw", Vector3::UnitZ(), Vector3::Zero(), -0.5, 0.5});
    return joints;
  };
  EXPECT_EQ(joints_of(load(urdf).robot, Leg::FL), expected);
  EXPECT_EQ(load(urdf).report.locked.count("FL_yaw"), 1U);
}

TEST_F(LegInference, WheelsAreHeldAndFeetOfTheirRadius) {
  ChainUrdf urdf;
  urdf.joints = [](Leg leg) {
    return with(ChainUrdf::usual(leg), {"wheel", Vector3::UnitY(), Vector3::Zero(), 0, 0, true}, -0.2);
  };
  urdf.foot =
      "<collision><origin rpy=\"1.5707963267948966 0 0\"/><geometry><cylinder radius=\"0.07\" "
      "length=\"0.04\"/>"
      "</geometry></collision>";
  const auto check = [](const LoadedRobot& loaded) {
    for (const Leg leg : kLegs) {
      const LegModel& model = (*loaded.robot.legs)[leg];
      EXPECT_EQ(model.servos.size(), 3U);
      EXPECT_NEAR(model.foot_radius, 0.07, 1e-12);
      EXPECT_LT((model.p_BF - Vector3(0, 0, -0.2)).norm(), 1e-12);
    }
  };
  const LoadedRobot found = load(urdf);
  check(found);
  EXPECT_TRUE(warns(found.report, "wheels do not turn: held are FL_wheel")) << found.report.warnings.front();
  check(load(urdf, "locked: [FL_wheel, FR_wheel, RL_wheel, RR_wheel]\n"));
  // What is not round about the joint is none: a cylinder across it, a box, one off its axle.
  for (const char* foot : {"<cylinder radius=\"0.07\" length=\"0.04\"/>", "<box size=\"0.14 0.04 0.14\"/>"}) {
    urdf.foot = fmt::format("<collision><geometry>{}</geometry></collision>", foot);
    EXPECT_FALSE(warns(load(urdf).report, "wheels")) << foot;
  }
  urdf.foot =
      "<collision><origin xyz=\"0.01 0 0\" rpy=\"1.5707963267948966 0 0\"/><geometry><cylinder "
      "radius=\"0.07\" "
      "length=\"0.04\"/></geometry></collision>";
  EXPECT_FALSE(warns(load(urdf).report, "wheels"));
  // A knee that turns all the way round is none.
  urdf.joints = [](Leg leg) {
    std::vector<ChainJoint> joints = ChainUrdf::usual(leg);
    joints.back().is_continuous = true;
    return joints;
  };
  EXPECT_EQ(joints_of(load(urdf).robot, Leg::FL).size(), 3U);
  // Nor where the middle of its long shin is near it.
  urdf.foot =
      "<collision><geometry><sphere radius=\"0.02\"/></geometry></collision><collision><origin xyz=\"0 0 "
      "0.3\"/>"
      "<geometry><box size=\"0.02 0.02 0.2\"/></geometry></collision>";
  EXPECT_EQ(joints_of(load(urdf).robot, Leg::FL).size(), 3U);
}

TEST_F(LegInference, LockedJointsDoNotCount) {
  ChainUrdf urdf;
  urdf.joints = [](Leg leg) {
    return with(ChainUrdf::usual(leg), {"toe", Vector3::UnitY(), {0, 0, -0.05}}, -0.15);
  };
  const auto [robot, report] = load(urdf, "locked: {FL_toe: 0.5, FR_toe: 0.5, RL_toe: 0.5, RR_toe: 0.5}\n");
  EXPECT_EQ(robot.joint_count(), 12);
  EXPECT_FALSE(warns(report, "held"));
  const Vector3 toe = Eigen::AngleAxisd(0.5, Vector3::UnitY()) * Vector3(0, 0, -0.05);
  EXPECT_LT(((*robot.legs)[Leg::FL].p_BF - Vector3(0, 0, -0.15) - toe).norm(), 1e-12);
  const ConfigError error = config_error([&] { (void)load(urdf, "locked: {FL_toe: 2}\n"); });
  EXPECT_NE(std::string(error.what()).find("an angle in -1..1 rad"), std::string::npos) << error.what();
}

// Planes of legs that are canted are not upright: how deep feet are is counted along the vertical all the
// same.
TEST_F(LegInference, CantedLegsStandAsHighAsUprightOnes) {
  ChainUrdf urdf;
  urdf.joints = ChainUrdf::usual;
  for (const double cant : {0.0, 0.1, 0.3, -0.3}) {
    const LoadedRobot loaded =
        load(urdf, fmt::format("locked: {{FL_abduction: {0}, RL_abduction: {0}, FR_abduction: {1}, "
                               "RR_abduction: {1}}}\n",
                               cant, -cant));
    for (const Leg leg : kLegs) {
      const Vector3 foot = foot_from_hip(loaded.robot, leg);
      EXPECT_NEAR(foot.z(), -loaded.robot.standing_height, 1e-12);  // rounding of lengths of 0.4 m
      EXPECT_NEAR(foot.x(), loaded.robot.stance_offset, 1e-12);
    }
  }
}

TEST_F(LegInference, LegsOnASpineAreLegsAndTheSpineIsHeld) {
  ChainUrdf urdf;
  urdf.parent = [](Leg leg) { return std::string(is_front(leg) ? "trunk" : "aft"); };
  urdf.more = ChainUrdf::link("aft", 3) +
              ChainUrdf::joint("", {"spine", Vector3::UnitZ(), {}, -0.5, 0.5}, "trunk", "aft", {-0.1, 0, 0});
  const auto [robot, report] = load(urdf);
  EXPECT_EQ(robot.joint_count(), 12);
  EXPECT_EQ(report.locked, (std::map<std::string, double>{{"spine", 0}}));
  EXPECT_EQ(robot.bodies[0].inertia.mass, 9);
}

TEST_F(LegInference, AllFourNamesSayWhereForwardIs) {
  const std::array<Leg, 4> round{Leg::FL, Leg::RL, Leg::RR, Leg::FR};  // as seen from above, to the left
  for (const std::size_t turn : {1U, 2U, 3U}) {
    ChainUrdf urdf;
    urdf.prefix = [&](Leg leg) {
      const auto at = static_cast<std::size_t>(std::ranges::find(round, leg) - round.begin());
      return std::string(name(round[(at + turn) % 4]));
    };
    if (turn % 2 == 0) {
      const auto [robot, report] = load(urdf);
      EXPECT_EQ(report.R_BA.col(0), Vector3(-1, 0, 0));
      EXPECT_EQ(joints_of(robot, Leg::FL).front(), "FL_abduction");
      EXPECT_TRUE(report.warnings.empty());
    }
    // A frame that is given is not turned by names: these are warned of.
    const auto [robot, report] = load(urdf, "frame: {forward: [1, 0, 0], up: [0, 0, 1]}\n");
    EXPECT_EQ(joints_of(robot, Leg::FL).front(), urdf.prefix(Leg::FL) + "_abduction");
    EXPECT_EQ(report.warnings.size(), 4U);
  }
}

/// Four legs around a trunk, turned about the vertical first.
std::string sprawling(double turn, bool has_names) {
  std::string out = "<robot name=\"spider\">\n" + ChainUrdf::link("trunk", 1.2);
  for (const Leg leg : kLegs) {
    const std::string p = has_names ? std::string(name(leg)) + "_" : fmt::format("leg{}_", index(leg));
    const double x = is_front(leg) ? 1 : -1, y = side_sign(leg);
    // From diagonal (turn 0) to sideways (1).
    const double angle = y * (M_PI_2 - (1 - turn) * x * M_PI_4);
    out +=
        ChainUrdf::link(p + "coxa", 0.06) + ChainUrdf::link(p + "femur", 0.08) +
        ChainUrdf::link(p + "tibia", 0.06,
                        "<collision><origin xyz=\"0.12 0 0\"/><geometry><sphere radius=\"0.01\"/></geometry>"
                        "</collision>");
    const auto joint = [&](const char* name, const char* parent, const char* child, const Vector3& at,
                           const Vector3& axis, double upper, double yaw) {
      return fmt::format(
          "<joint name=\"{}{}\" type=\"revolute\"><parent link=\"{}\"/><child link=\"{}{}\"/>"
          "<origin xyz=\"{} {} {}\" rpy=\"0 0 {}\"/><axis xyz=\"{} {} {}\"/>"
          "<limit lower=\"-0.8\" upper=\"{}\" effort=\"1.5\" velocity=\"6\"/></joint>\n",
          p, name, parent, p, child, at.x(), at.y(), at.z(), yaw, axis.x(), axis.y(), axis.z(), upper);
    };
    const std::string coxa = p + "coxa", femur = p + "femur";
    out += joint("yaw", "trunk", "coxa", {0.07 * x, 0.07 * y, 0}, Vector3::UnitZ(), 0.8, angle);
    out += joint("lift", coxa.c_str(), "femur", {0.04, 0, 0}, Vector3::UnitY(), 1.5, 0);
    out += joint("shank", femur.c_str(), "tibia", {0.08, 0, 0}, Vector3::UnitY(), 2.6, 0);
  }
  return out + "</robot>\n";
}

TEST_F(LegInference, SprawlingLegsStandWhereTheyStand) {
  for (const double turn : {0.0, 0.4, 1.0}) {
    for (const bool has_names : {true, false}) {
      const auto [robot, report] = load_robot_with_report(write("made.urdf", sprawling(turn, has_names)));
      EXPECT_TRUE(report.R_BA.isIdentity(0)) << turn;
      for (const Leg leg : kLegs)
        EXPECT_EQ(joints_of(robot, leg).front(),
                  has_names ? fmt::format("{}_yaw", name(leg)) : fmt::format("leg{}_yaw", index(leg)));
    }
  }
  write("made.urdf", sprawling(0, false));
  const LoadedRobot turned = load_robot_with_report(
      write("robot.yaml", "urdf: made.urdf\nframe: {forward: [0, 1, 0], up: [0, 0, 1]}\n"));
  EXPECT_EQ(joints_of(turned.robot, Leg::FL).front(), "leg2_yaw") << "behind on the left in the file's frame";
}

TEST_F(LegInference, LegsAlikeButForRoundingAreLegsAndOthersAreToldApart) {
  ChainUrdf urdf;
  urdf.joints = [](Leg leg) {
    std::vector<ChainJoint> joints = ChainUrdf::usual(leg);
    const double tilt = is_front(leg) ? 0.0499 : 0.0501;  // on both sides of where tenths are rounded
    joints.back().axis = {0, std::cos(tilt), std::sin(tilt) * side_sign(leg)};
    return joints;
  };
  EXPECT_EQ(load(urdf).robot.joint_count(), 12);
  urdf.joints = [](Leg leg) {
    std::vector<ChainJoint> joints = ChainUrdf::usual(leg);
    if (leg == Leg::RR) joints.back().axis = {0, 0.8, 0.6};
    return joints;
  };
  const ConfigError error = config_error([&] { (void)load(urdf); });
  EXPECT_NE(
      error.found().find("joints 2 and 3 from 'FL_abduction' are at 0 degrees, from 'RR_abduction' at 37"),
      std::string::npos)
      << error.what();
}

TEST_F(LegInference, LegsWithoutTwoParallelJointsAreRefused) {
  ChainUrdf urdf;
  urdf.joints = [](Leg leg) {
    return std::vector<ChainJoint>{{"yaw", Vector3::UnitZ(), {0, 0.07 * side_sign(leg), 0}},
                                   {"pitch", Vector3::UnitY(), {0, 0, -0.2}}};
  };
  const ConfigError error = config_error([&] { (void)load(urdf); });
  EXPECT_EQ(error.found(), "2, of which no two are parallel");
}

TEST_F(LegInference, FeetAreWhatIsSeenElseWhereALinkIs) {
  ChainUrdf urdf;
  urdf.foot = "<visual><geometry><sphere radius=\"0.025\"/></geometry></visual>";
  const auto seen = load(urdf);
  EXPECT_EQ((*seen.robot.legs)[Leg::FL].foot_radius, 0.025);
  EXPECT_TRUE(warns(seen.report, "of radius 0.025 m, from what they look like ('FL_knee_link'"))
      << fmt::format("{}", fmt::join(seen.report.warnings, "\n"));
  urdf.foot = "";
  const auto placed = load(urdf);
  const LegModel& leg = (*placed.robot.legs)[Leg::RR];
  EXPECT_LT((leg.p_BF - Vector3(0, 0, -0.2)).norm(), 1e-12);
  EXPECT_NEAR(leg.foot_radius, 0.05 * 0.2, 1e-12);
  EXPECT_TRUE(warns(placed.report, "of radius 0.01 m, at the origins of links fixed to them ('FL_knee_link'"))
      << fmt::format("{}", fmt::join(placed.report.warnings, "\n"));
}

TEST(LegNames, AreFoundInWhateverSpelling) {
  const std::vector<std::pair<const char*, std::optional<Leg>>> names{{"FL_hip", Leg::FL},
                                                                      {"lf_haa", Leg::FL},
                                                                      {"front_left_abd", Leg::FL},
                                                                      {"leg_front_l_1", Leg::FL},
                                                                      {"LegFrontR", Leg::FR},
                                                                      {"RightHindKnee", Leg::RR},
                                                                      {"hip_fl", Leg::FL},
                                                                      {"FLHip", Leg::FL},
                                                                      {"rear_right2", Leg::RR},
                                                                      {"bl_knee", Leg::RL},
                                                                      {"HR_hip_joint", Leg::RR},
                                                                      {"joint_3", std::nullopt},
                                                                      {"front_left_hip_back", std::nullopt},
                                                                      {"arm", std::nullopt},
                                                                      {"flange", std::nullopt}};
  for (const auto& [text, leg] : names) EXPECT_EQ(leg_in_name(text), leg) << text;
}

}  // namespace
}  // namespace crossgait
