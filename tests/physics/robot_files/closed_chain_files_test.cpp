// Legs of which bars move a joint, found by the loops of their files.
#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "physics/robot/multibody.h"
#include "physics/robot/robot_identity.h"
#include "physics/robot_files/robot_report.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"
#include "tests/physics/robot_files/chain_urdf.h"

namespace crossgait {
namespace {

/// A bar of a leg: on which link of it, where, and how far it goes to what it holds on to.
struct Bar {
  std::string name, on;
  Vector3 at;
};

/// A way to put bars beside a leg, and the links and points at which they are closed.
struct Layout {
  std::string name;
  std::vector<Bar> bars;
  std::string link_a, link_b;
  Vector3 point_a, point_b;
  std::vector<std::string> servos, passive;  // their roles
  bool has_ankle = false;
};

const Vector3 kTip(-0.03, 0, 0.03), kRod(0, 0, -0.2);

// Parallelograms beside the thigh, or beside the shin.
const std::vector<Layout> kLayouts{{"crank_on_abduction",
                                    {{"crank", "abduction_link", {0, 0.07, 0}}, {"rod", "crank_link", kTip}},
                                    "rod_link",
                                    "knee_link",
                                    kRod,
                                    kTip,
                                    {"abduction", "hip", "crank"},
                                    {"knee", "rod"}},
                                   {"crank_on_thigh",
                                    {{"crank", "hip_link", {0, 0, -0.02}}, {"rod", "crank_link", kTip}},
                                    "rod_link",
                                    "knee_link",
                                    {0, 0, -0.18},
                                    kTip,
                                    {"abduction", "hip", "crank"},
                                    {"knee", "rod"}},
                                   {"rod_on_shin",
                                    {{"crank", "abduction_link", {0, 0.07, 0}}, {"rod", "knee_link", kTip}},
                                    "crank_link",
                                    "rod_link",
                                    kTip,
                                    {0, 0, 0.2},
                                    {"abduction", "hip", "crank"},
                                    {"knee", "rod"}},
                                   {"bar_to_the_toe",
                                    {{"rod", "hip_link", {-0.03, 0, -0.17}}},
                                    "rod_link",
                                    "ankle_link",
                                    {0, 0, -0.2},
                                    kTip,
                                    {"abduction", "hip", "knee"},
                                    {"ankle", "rod"},
                                    true}};

std::string urdf_of(const Layout& layout) {
  ChainUrdf urdf;
  if (layout.has_ankle)
    urdf.joints = [](Leg leg) {
      std::vector<ChainJoint> joints = ChainUrdf::usual(leg);
      joints.push_back({"ankle", Vector3::UnitY(), {0, 0, -0.1}, -2, 2});
      return joints;
    };
  for (const Leg leg : kLegs) {
    const std::string p = std::string(name(leg)) + "_";
    for (const Bar& bar : layout.bars) {
      const Vector3 at(bar.at.x(), bar.at.y() * side_sign(leg), bar.at.z());
      urdf.more += ChainUrdf::link(p + bar.name + "_link", 0.03);
      urdf.more += ChainUrdf::joint(p, {bar.name, Vector3::UnitY(), {}, -3, 3}, p + bar.on,
                                    p + bar.name + "_link", at);
    }
  }
  return urdf.text();
}

std::string loops_of(const Layout& layout) {
  std::string yaml = "urdf: made.urdf\nloops:\n";
  for (const Leg leg : kLegs)
    yaml += fmt::format(
        "  - {{name: {0}_loop, link_a: {0}_{1}, point_a: [{2}], link_b: {0}_{3}, point_b: [{4}]}}\n",
        name(leg), layout.link_a, fmt::join(layout.point_a, ", "), layout.link_b,
        fmt::join(layout.point_b, ", "));
  return yaml;
}

class ClosedChainFiles : public ScratchFolder, public ::testing::WithParamInterface<Layout> {
 protected:
  LoadedRobot load(const std::string& more = "") {
    write("made.urdf", urdf_of(GetParam()));
    return load_robot_with_report(write("robot.yaml", loops_of(GetParam()) + more));
  }
  static std::vector<std::string> roles_of(const LegModel& model, bool actuated) {
    std::vector<std::string> roles;
    for (const LegRole& role : model.roles()) {
      if (role.actuated == actuated) roles.emplace_back(role.name);
    }
    return roles;
  }
};
INSTANTIATE_TEST_SUITE_P(, ClosedChainFiles, ::testing::ValuesIn(kLayouts),
                         [](const auto& test) { return test.param.name; });

TEST_P(ClosedChainFiles, BarsAreFoundByTheLoops) {
  const auto [robot, report] = load();
  EXPECT_EQ(robot.actuated_joints().size(), 12U);
  const std::vector<Pose> poses = home_poses(robot);
  EXPECT_LT(max_loop_gap(robot, poses), 1e-12);
  for (const Leg leg : kLegs) {
    const LegModel& model = (*robot.legs)[leg];
    EXPECT_EQ(model.linkage, LegLinkage::kClosedChain);
    EXPECT_EQ(roles_of(model, true), GetParam().servos);
    EXPECT_EQ(roles_of(model, false), GetParam().passive);
    for (const LegRole& role : model.roles())
      EXPECT_EQ(robot.joint(model.joint(role.name)).name, fmt::format("{}_{}", name(leg), role.name));
    EXPECT_EQ(model.foot_body, model.joint(GetParam().has_ankle ? "ankle" : "knee") + 1);
    // It stands as a leg without bars does.
    const Vector3 hip = poses[static_cast<std::size_t>(model.joint("hip")) + 1].translation();
    const Vector3 foot = foot_position(robot, leg, poses) - hip;
    EXPECT_NEAR(foot.z(), -robot.standing_height, 1e-8);
    EXPECT_NEAR(robot.standing_height, 0.72 * (GetParam().has_ankle ? 0.5 : 0.4), 1e-9);
  }
}

TEST_P(ClosedChainFiles, LegsThatAreSaidAreTheSame) {
  const LoadedRobot found = load();
  std::string legs = "legs:\n";
  for (const Leg leg : kLegs)
    legs += fmt::format("  {0}: {{abduction: {0}_abduction, hip: {0}_hip, knee: {0}_knee{1}}}\n", name(leg),
                        GetParam().has_ankle ? fmt::format(", ankle: {}_ankle", name(leg)) : "");
  EXPECT_EQ(identity_hash(load(legs).robot), identity_hash(found.robot));
}

TEST_P(ClosedChainFiles, ARobotYamlSaysAllOfIt) {
  const LoadedRobot loaded = load();
  const LoadedRobot again = load_robot_with_report(write("again.yaml", to_yaml(loaded, "made.urdf")));
  EXPECT_EQ(again.robot.actuated_joints(), loaded.robot.actuated_joints());
  EXPECT_LT((again.robot.home - loaded.robot.home).cwiseAbs().maxCoeff(), 1e-12);
  for (const Leg leg : kLegs)
    EXPECT_EQ((*again.robot.legs)[leg].parts, (*loaded.robot.legs)[leg].parts) << name(leg);
}

TEST_P(ClosedChainFiles, AHomeNeedsItsServosAlone) {
  const LoadedRobot loaded = load();
  std::string home = "home: {";
  const LegModel& model = (*loaded.robot.legs)[Leg::FL];
  for (const std::string& role : GetParam().servos)
    home += fmt::format("{}: {}, ", role, loaded.robot.home[model.joint(role)]);
  const LoadedRobot again = load(home + "}\n");
  EXPECT_LT((again.robot.home - loaded.robot.home).cwiseAbs().maxCoeff(), 1e-9);
  const std::string twisted = home + fmt::format("{}: 2}}\n", GetParam().passive[0]);
  EXPECT_NE(std::string(config_error([&] { (void)load(twisted); }).what()).find("of closed loops"),
            std::string::npos);
}

class BehindAKneeThatFollows : public ScratchFolder {};

TEST_F(BehindAKneeThatFollows, AServoMovesTheFootInItsPlace) {
  ChainUrdf urdf;
  urdf.joints = [](Leg leg) {
    std::vector<ChainJoint> joints = ChainUrdf::usual(leg);
    joints.push_back({"ankle", Vector3::UnitY(), {0, 0, -0.15}, -2, 2});
    return joints;
  };
  write("made.urdf", urdf.text());
  std::string yaml = "urdf: made.urdf\ncouplings:\n";
  for (const Leg leg : kLegs)
    yaml += fmt::format("  - {{follower: {0}_knee, leader: {0}_hip, coefficients: [0, -1.5]}}\n", name(leg));
  const RobotDescription robot = load_robot(write("robot.yaml", yaml));
  const std::vector<Pose> poses = home_poses(robot);
  for (const Leg leg : kLegs) {
    const LegModel& model = (*robot.legs)[leg];
    EXPECT_EQ(model.linkage, LegLinkage::kClosedChain);
    ASSERT_EQ(model.servos.size(), 3U);
    EXPECT_EQ(robot.joint(model.servos[2]).name, fmt::format("{}_ankle", name(leg)));
    EXPECT_EQ(model.servos[2], model.joint("ankle"));
    ASSERT_EQ(model.passive, std::vector{model.joint("knee")});
    EXPECT_NEAR(robot.home[model.joint("knee")], -1.5 * robot.home[model.joint("hip")], 1e-12);
    const Vector3 hip = poses[static_cast<std::size_t>(model.joint("hip")) + 1].translation();
    EXPECT_NEAR((foot_position(robot, leg, poses) - hip).z(), -robot.standing_height, 1e-8);
  }
}

// Without its loop a leg branches, and one loop of four is no robot that any rule knows.
TEST_P(ClosedChainFiles, WithoutTheirLoopsTheyAreRefused) {
  write("made.urdf", urdf_of(GetParam()));
  EXPECT_THROW((void)load_robot(write("robot.yaml", "urdf: made.urdf\n")), ConfigError);
}

}  // namespace
}  // namespace crossgait
