// Robots from MJCF files, through the engine that compiles them.
#include "physics/robot_files/mjcf/mjcf_reader.h"

#include <algorithm>
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "backends/registry.h"
#include "ik/leg_kinematics.h"
#include "motion/gait_source.h"
#include "motion/walk.h"
#include "physics/robot_files/mjcf/mjcf_model.h"
#include "physics/robot_files/robot_report.h"
#include "tests/backends/made_mjcf.h"
#include "tests/physics/robot_files/mesh_bytes.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

const std::string kOwnMjcf = CROSSGAIT_SOURCE_DIR "/tests/backends/mjcf/serial_quadruped.xml";
const std::string kSameUrdf = CROSSGAIT_SOURCE_DIR "/models/robots/serial_quadruped/robot.urdf";

void expect_near(const Matrix3& a, const Matrix3& b, double tolerance) {
  EXPECT_LT((a - b).cwiseAbs().maxCoeff(), tolerance);
}
void expect_same_pose(const Pose& a, const Pose& b) {
  EXPECT_LT((a.matrix() - b.matrix()).cwiseAbs().maxCoeff(), 1e-14);
}

// The same robot written twice, by people. 1e-12: decimal numbers go through MuJoCo's doubles, quaternions
// and principal axes, a few roundings each.
TEST_F(MjcfReader, SaysWhatAUrdfOfTheSameRobotSays) {
  const RobotDescription mjcf = load_robot(kOwnMjcf), urdf = load_robot(kSameUrdf);
  EXPECT_EQ(mjcf.name, urdf.name);
  ASSERT_EQ(mjcf.bodies.size(), urdf.bodies.size());
  constexpr double kSame = 1e-12;
  for (std::size_t i = 0; i < urdf.bodies.size(); ++i) {
    const Body &a = mjcf.bodies[i], &b = urdf.bodies[i];
    SCOPED_TRACE(b.name);
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.parent, b.parent);
    EXPECT_NEAR(a.inertia.mass, b.inertia.mass, kSame);
    EXPECT_LT((a.inertia.p_BC - b.inertia.p_BC).norm(), kSame);
    expect_near(a.inertia.I_C, b.inertia.I_C, kSame);
    EXPECT_LT((a.X_PB.matrix() - b.X_PB.matrix()).cwiseAbs().maxCoeff(), kSame);
    const Joint &j = a.joint, &k = b.joint;
    EXPECT_EQ(j.name, k.name);
    EXPECT_EQ(j.actuated, k.actuated);
    EXPECT_LT((j.axis - k.axis).norm(), kSame);
    for (const auto member : {&Joint::lower, &Joint::upper, &Joint::damping, &Joint::friction,
                              &Joint::armature, &Joint::kp, &Joint::kd, &Joint::effort_limit})
      EXPECT_NEAR(j.*member, k.*member, kSame * std::max(1.0, std::abs(k.*member)));
    ASSERT_EQ(a.shapes.size(), b.shapes.size());
    for (std::size_t s = 0; s < b.shapes.size(); ++s) {
      EXPECT_EQ(a.shapes[s].type, b.shapes[s].type);
      EXPECT_LT((a.shapes[s].size - b.shapes[s].size).norm(), kSame);
      EXPECT_LT((a.shapes[s].X_BG.matrix() - b.shapes[s].X_BG.matrix()).cwiseAbs().maxCoeff(), kSame);
    }
  }
  EXPECT_LT((mjcf.home - urdf.home).cwiseAbs().maxCoeff(), kSame);
  EXPECT_NEAR(mjcf.home_height, urdf.home_height, kSame);
  EXPECT_NEAR(mjcf.standing_height, urdf.standing_height, kSame);
  EXPECT_NEAR(mjcf.stance_offset, urdf.stance_offset, kSame);
}

TEST_F(MjcfReader, ListsWhatItLeavesOut) {
  const std::vector<std::string> expected{
      "ignored 1 element(s) of <sensor>, first in gyro (line",
      "ignored 2 site(s), camera(s) and light(s), first in light (line 29)",
      "left out 1 <geom> of the world: terrain is chosen apart, first in geom 'floor' (line 30)"};
  const ParsedRobot robot = read_mjcf(kOwnMjcf);
  ASSERT_EQ(robot.warnings.size(), expected.size()) << fmt::format("{}", fmt::join(robot.warnings, "\n"));
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const std::string beginning = expected[i].substr(0, expected[i].find("(line"));
    EXPECT_EQ(robot.warnings[i].substr(0, beginning.size()), beginning);
  }
}

TEST_F(MjcfReader, AnglesAreDegreesWhereTheCompilerSaysNothing) {
  MadeMjcf mjcf;
  mjcf.hip_joint = "range=\"-90 45\"";
  EXPECT_DOUBLE_EQ(body(tree(mjcf), "FL_thigh").joint.lower, -std::numbers::pi / 2);
  mjcf.compiler = "<compiler angle=\"radian\"/>";
  mjcf.hip_joint = "range=\"-1.5 1\"";
  EXPECT_EQ(body(tree(mjcf), "FL_thigh").joint.lower, -1.5);
  EXPECT_EQ(body(tree(mjcf), "FL_thigh").joint.upper, 1);
}

TEST_F(MjcfReader, RangesAreLimitsUnlessTheFileSaysNot) {
  MadeMjcf mjcf;
  mjcf.hip_joint = "range=\"-90 45\" limited=\"false\"";
  EXPECT_EQ(body(tree(mjcf), "FL_thigh").joint.upper, Joint().upper);
  EXPECT_FALSE(body(tree(mjcf), "FL_thigh").joint.limited);
  mjcf.hip_joint = "range=\"-90 45\"";
  EXPECT_TRUE(body(tree(mjcf), "FL_thigh").joint.limited);
  mjcf.hip_joint = "";
  EXPECT_FALSE(body(tree(mjcf), "FL_thigh").joint.limited);
  mjcf.hip_joint = "range=\"-900 45\"";
  EXPECT_TRUE(warns(tree(mjcf).warnings, "took limits beyond +-2 pi rad for +-pi in 4 joint(s)"));
}

TEST_F(MjcfReader, LimitsAreAsSoftAsTheFileSays) {
  MadeMjcf mjcf;
  mjcf.compiler = "<compiler angle=\"radian\"/>";
  mjcf.hip_joint = "range=\"-1.5 1\"";
  EXPECT_EQ(body(tree(mjcf), "FL_thigh").joint.limit_softness.time_constant, 0.02);
  // The direct form: stiffness 400, damping 30.
  mjcf.hip_joint = R"(range="-1.5 1" solreflimit="-400 -30" solimplimit=".8 .9 .01 .4 3" margin=".125")";
  const Joint joint = body(tree(mjcf), "FL_thigh").joint;
  EXPECT_DOUBLE_EQ(joint.limit_softness.time_constant, 2.0 / 30);
  EXPECT_DOUBLE_EQ(joint.limit_softness.damping_ratio, 30 / (2 * 20.0));
  EXPECT_EQ(joint.limit_softness.impedance_max, 0.9);
  EXPECT_EQ(joint.limit_softness.impedance_power, 3);
  EXPECT_EQ(joint.lower, -1.375);  // it acts from its margin on
  EXPECT_EQ(joint.upper, 0.875);
}

TEST_F(MjcfReader, ClassesAreInherited) {
  MadeMjcf mjcf;
  mjcf.defaults = R"(<joint damping=".1" armature=".01"/><default class="stiff"><joint damping=".4"/>
                     <default class="stiffer"><joint frictionloss=".2"/></default></default>)";
  mjcf.hip_joint = "class=\"stiffer\"";
  const ParsedRobot robot = tree(mjcf);
  EXPECT_EQ(body(robot, "FL_thigh").joint.damping, 0.4);
  EXPECT_EQ(body(robot, "FL_thigh").joint.friction, 0.2);
  EXPECT_EQ(body(robot, "FL_thigh").joint.armature, 0.01);
  EXPECT_EQ(body(robot, "FL_shin").joint.damping, 0.1);
  EXPECT_LT((body(robot, "FL_shin").joint.axis - Vector3::UnitY()).norm(), 1e-15);
}

// Euler angles turn about x, then the new y and z; quaternions begin with w.
TEST_F(MjcfReader, PosesAreThoseOfEulerAnglesAndQuaternions) {
  MadeMjcf mjcf;
  mjcf.shin = R"(<geom name="e" type="box" size=".01 .02 .03" pos=".1 0 0" euler="90 0 90"/>
                 <geom name="q" type="box" size=".01 .02 .03" quat="1 0 0 1"/>)";
  const ParsedRobot robot = tree(mjcf);
  const Body& shin = body(robot, "FL_shin");
  ASSERT_EQ(shin.shapes.size(), 3U);
  const double quarter = std::numbers::pi / 2;
  Pose X = Pose::Identity();
  X.translation() = Vector3(0.1, 0, 0);
  X.linear() = (Eigen::AngleAxisd(quarter, Vector3::UnitX()) * Eigen::AngleAxisd(quarter, Vector3::UnitZ()))
                   .toRotationMatrix();
  expect_same_pose(shin.shapes[0].X_BG, X);
  expect_near(shin.shapes[1].X_BG.linear(), Eigen::AngleAxisd(quarter, Vector3::UnitZ()).toRotationMatrix(),
              1e-14);
}

TEST_F(MjcfReader, ACapsuleGoesFromTo) {
  MadeMjcf mjcf;
  mjcf.thigh = R"(<geom name="c" type="capsule" fromto="0 0 0 .06 0 -.08" size=".01"/>)";
  const ParsedRobot robot = tree(mjcf);
  const Body& thigh = body(robot, "FL_thigh");
  ASSERT_EQ(thigh.shapes.size(), 1U);
  const CollisionShape& shape = thigh.shapes[0];
  EXPECT_EQ(shape.type, ShapeType::kCapsule);
  EXPECT_EQ(shape.size[0], 0.01);
  EXPECT_NEAR(shape.size[1], 0.05, 1e-15);
  EXPECT_LT((shape.X_BG.translation() - Vector3(0.03, 0, -0.04)).norm(), 1e-15);
  EXPECT_LT((shape.X_BG.linear().col(2).cross(Vector3(0.6, 0, -0.8))).norm(), 1e-15);
}

// The link's frame is that of its joint: at its anchor, and turned back by its reference angle.
TEST_F(MjcfReader, AJointMayBeOffItsBodyAndItsZeroElsewhere) {
  MadeMjcf mjcf;
  mjcf.compiler = "<compiler angle=\"radian\"/>";
  mjcf.hip_joint = "pos=\"0 0 .05\" ref=\".5\"";
  const ParsedRobot robot = tree(mjcf);
  const Body &thigh = body(robot, "FL_thigh"), &shin = body(robot, "FL_shin");
  EXPECT_LT((thigh.X_PB.translation() - Vector3(0.2, 0.1, 0.05)).norm(), 1e-15);
  EXPECT_LT((thigh.inertia.p_BC - Vector3(0, 0, -0.15)).norm(), 1e-15);
  EXPECT_LT((shin.X_PB.translation() - Vector3(0, 0, -0.25)).norm(), 1e-15);
  // At the reference angle the file's body stands as it is written.
  expect_near((thigh.X_PB * Eigen::AngleAxisd(0.5, Vector3::UnitY())).linear(), Matrix3::Identity(), 1e-15);
}

TEST_F(MjcfReader, MassFollowsFromGeomsWhereNoneIsGiven) {
  MadeMjcf mjcf;
  mjcf.thigh_inertial = "";
  mjcf.thigh = R"(<geom type="sphere" size=".05" density="2000" pos="0 0 -.1"/>)";
  const ParsedRobot robot = tree(mjcf);
  const SpatialInertia& inertia = body(robot, "FL_thigh").inertia;
  const double mass = 4.0 / 3 * std::numbers::pi * 0.05 * 0.05 * 0.05 * 2000;
  EXPECT_NEAR(inertia.mass, mass, 1e-14);
  EXPECT_LT((inertia.p_BC - Vector3(0, 0, -0.1)).norm(), 1e-15);
  expect_near(inertia.I_C, 0.4 * mass * 0.0025 * Matrix3::Identity(), 1e-15);
}

/// A box of edges 2, 4 and 6 about (1, 2, 3), closed, outward.
std::string box_stl() {
  const auto corner = [](int i) {
    return Vector3((i & 1) != 0 ? 2 : 0, (i & 2) != 0 ? 4 : 0, (i & 4) != 0 ? 6 : 0);
  };
  std::vector<Vector3> corners;
  for (const int i : {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                      2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5})
    corners.push_back(corner(i));
  return binary_stl(corners);
}

TEST_F(MjcfReader, MeshesAreWhereTheFileHasThem) {
  std::filesystem::create_directories(path("assets"));
  write("assets/box.stl", box_stl());
  MadeMjcf mjcf;
  mjcf.compiler = "<compiler meshdir=\"assets\"/>";
  mjcf.defaults = "<mesh scale=\".01 .01 .01\"/>";
  mjcf.asset = R"(<mesh file="box.stl"/><material name="red" rgba="1 0 0 1"/>)";
  mjcf.thigh = R"(<geom name="hit" type="mesh" mesh="box" pos="0 0 .5" group="3"/>
                  <geom type="mesh" mesh="box" euler="0 0 90" contype="0" conaffinity="0" group="2" material="red"/>)";
  const ParsedRobot robot = tree(mjcf);
  const Body& thigh = body(robot, "FL_thigh");
  ASSERT_EQ(thigh.shapes.size(), 1U);
  EXPECT_EQ(thigh.shapes[0].type, ShapeType::kBox);
  EXPECT_LT((thigh.shapes[0].size - Vector3(0.01, 0.02, 0.03)).norm(), 1e-15);
  EXPECT_LT((thigh.shapes[0].X_BG.translation() - Vector3(0.01, 0.02, 0.53)).norm(), 1e-15);
  EXPECT_EQ(robot.mesh_vertices.at("hit").size(), 8U);
  ASSERT_EQ(thigh.visuals.size(), 1U);
  EXPECT_EQ(thigh.visuals[0].type, VisualType::kMesh);
  EXPECT_EQ(thigh.visuals[0].mesh, path("assets/box.stl"));
  EXPECT_EQ(thigh.visuals[0].scale, Vector3::Constant(0.01));
  EXPECT_EQ(thigh.visuals[0].rgba, Eigen::Vector4d(1, 0, 0, 1));
  Pose X = Pose::Identity();
  X.linear() = Eigen::AngleAxisd(std::numbers::pi / 2, Vector3::UnitZ()).toRotationMatrix();
  expect_same_pose(thigh.visuals[0].X_BG, X);
}

TEST_F(MjcfReader, AMeshGivesMassWhereNoneIsGiven) {
  write("box.stl", box_stl());
  MadeMjcf mjcf;
  mjcf.asset = R"(<mesh file="box.stl" scale=".01 .01 .01"/>)";
  mjcf.thigh_inertial = "";
  mjcf.thigh = R"(<geom type="mesh" mesh="box" density="1000"/>)";
  const SpatialInertia inertia = body(tree(mjcf), "FL_thigh").inertia;
  // 2 x 4 x 6 cm of water. Vertices are floats: 1e-7 of each.
  EXPECT_NEAR(inertia.mass, 0.048, 0.048 * 1e-6);
  EXPECT_LT((inertia.p_BC - Vector3(0.01, 0.02, 0.03)).norm(), 1e-8);
  EXPECT_NEAR(inertia.I_C(0, 0), 0.048 / 12 * (0.04 * 0.04 + 0.06 * 0.06), 1e-10);
  EXPECT_NEAR(inertia.I_C(2, 2), 0.048 / 12 * (0.02 * 0.02 + 0.04 * 0.04), 1e-10);
}

/// A prism over an L of three squares, 3 litres, its faces two triangles or fans each.
const char* const kPrismOverL =
    "v 0 0 0\nv .2 0 0\nv .2 .1 0\nv .1 .1 0\nv .1 .2 0\nv 0 .2 0\n"
    "v 0 0 .1\nv .2 0 .1\nv .2 .1 .1\nv .1 .1 .1\nv .1 .2 .1\nv 0 .2 .1\n"
    "f 1 3 2\nf 1 4 3\nf 1 5 4\nf 1 6 5\nf 7 8 9\nf 7 9 10\nf 7 10 11\nf 7 11 12\n"
    "f 1 2 8\nf 1 8 7\nf 2 3 9\nf 2 9 8\nf 3 4 10\nf 3 10 9\nf 4 5 11\nf 4 11 10\nf 5 6 12\nf 5 12 11\n"
    "f 6 1 7\nf 6 7 12\n";

// Compilers differ in what a mesh that is not convex weighs; in what is within its faces they do not.
TEST_F(MjcfReader, AMeshThatIsNotConvexWeighsWhatIsAskedForOrIsToldOf) {
  write("l.obj", kPrismOverL);
  MadeMjcf mjcf;
  mjcf.thigh_inertial = "";
  mjcf.thigh = R"(<geom type="mesh" mesh="l" density="1000"/>)";
  const auto mass = [&](const char* asset, const char* compiler, const char* defaults) {
    mjcf.asset = asset, mjcf.compiler = compiler, mjcf.defaults = defaults;
    return body(tree(mjcf), "FL_thigh").inertia.mass;
  };
  constexpr double kFloats = 3e-6;  // of 3 kg: vertices are floats
  EXPECT_NEAR(mass(R"(<mesh file="l.obj" inertia="exact"/>)", "", ""), 3, kFloats);
  EXPECT_NEAR(mass(R"(<mesh file="l.obj"/>)", R"(<compiler exactmeshinertia="true"/>)", ""), 3, kFloats);
  EXPECT_NEAR(mass(R"(<mesh file="l.obj"/>)", "", R"(<mesh inertia="exact"/>)"), 3, kFloats);
  EXPECT_FALSE(warns(tree(mjcf).warnings, "within its faces"));
  EXPECT_FALSE(warns(tree(mjcf).warnings, "'inertia'"));
  const double as_compiled = mass(R"(<mesh file="l.obj"/>)", "", "");
  const bool differs = std::abs(as_compiled - 3) > 0.03;  // in 2.2.2, not in 4.0.0
  EXPECT_EQ(warns(tree(mjcf).warnings, fmt::format("{:.4g} kg and moments", as_compiled)), differs);
  EXPECT_EQ(warns(tree(mjcf).warnings, "within its faces are 3 kg"), differs);
}

TEST_F(MjcfReader, MeshesThatAreNotThereAreDroppedAndCounted) {
  MadeMjcf mjcf;
  mjcf.asset = R"(<mesh name="gone" file="gone.stl"/><mesh name="foreign" file="../gone.ply"/>)";
  mjcf.thigh = R"(<geom type="mesh" mesh="gone" group="3"/><geom type="mesh" mesh="foreign" group="3"/>
                  <geom type="mesh" mesh="gone" contype="0" conaffinity="0"/>)";
  const ParsedRobot robot = tree(mjcf);
  EXPECT_TRUE(body(robot, "FL_thigh").shapes.empty());
  ASSERT_EQ(body(robot, "FL_thigh").visuals.size(), 1U);  // known to be missing: collision shapes stand in
  EXPECT_EQ(body(robot, "FL_thigh").visuals[0].mesh, "");
  EXPECT_TRUE(warns(robot.warnings, "('gone.stl')"));
  for (const char* warning : {"dropped 1 collision mesh(es) whose file is not there",
                              "dropped 1 collision mesh(es) that are no STL, OBJ or DAE",
                              "dropped 1 visual mesh(es) whose file is not there"})
    EXPECT_TRUE(warns(robot.warnings, warning)) << warning;
  // But not where a mass hangs on one.
  mjcf.thigh_inertial = "";
  EXPECT_EQ(refusal(mjcf).found(), "'../gone.ply'");
}

TEST_F(MjcfReader, WhatCollidesIsFeltAndGroupsZeroToTwoAreSeen) {
  MadeMjcf mjcf;
  mjcf.thigh = R"(<geom name="both" size=".01"/><geom name="felt" size=".02" group="3"/>
                  <geom name="seen" size=".03" contype="0" conaffinity="0" group="1" rgba="0 1 0 .5"/>
                  <geom name="neither" size=".04" contype="0" conaffinity="0" group="3"/>
                  <geom name="affine" size=".05" contype="0" conaffinity="1" group="4"/>
                  <geom name="bar" type="capsule" fromto="0 0 0 0 0 -.2" size=".01" contype="0" conaffinity="0"/>)";
  const ParsedRobot robot = tree(mjcf);
  const Body& thigh = body(robot, "FL_thigh");
  std::vector<std::string> felt;
  for (const CollisionShape& shape : thigh.shapes) felt.push_back(shape.name);
  EXPECT_EQ(felt, (std::vector<std::string>{"both", "felt", "affine"}));
  ASSERT_EQ(thigh.visuals.size(), 3U);
  EXPECT_EQ(thigh.visuals[0].size[0], 0.01);
  EXPECT_FALSE(thigh.visuals[0].rgba.has_value());
  EXPECT_EQ(thigh.visuals[1].size[0], 0.03);
  EXPECT_EQ(thigh.visuals[1].rgba, Eigen::Vector4d(0, 1, 0, 0.5));
  EXPECT_EQ(thigh.visuals[2].type, VisualType::kCapsule);
  EXPECT_NEAR(thigh.visuals[2].size[1], 0.1, 1e-15);
}

// `ref` is the angle that a joint has as the file draws it: the same robot, counted otherwise.
TEST_F(MjcfReader, ARobotDrawnWithItsLegsAsideIsTheSame) {
  const auto loaded = [this](const std::string& from, const std::string& to) {
    const std::filesystem::path own(kOwnMjcf);
    write("legs.xml", read((own.parent_path() / "legs.xml").string()));
    std::string text = read(kOwnMjcf);
    text.replace(text.find(from), from.size(), to);
    return load_robot_with_report(write("robot.xml", text));
  };
  const std::string range = R"(<joint axis="1 0 0" range="-0.85 0.85"/>)";
  const auto [plain, report] = loaded(range, range);
  const auto [counted, of_counted] = loaded(range, R"(<joint axis="1 0 0" range="-0.55 1.15" ref="0.3"/>)");
  EXPECT_TRUE(of_counted.R_BA.isApprox(report.R_BA));
  EXPECT_NEAR(counted.home_height, plain.home_height, 1e-9);
  const LegArray<Vector3> origins = leg_origins(plain), others = leg_origins(counted);
  for (const Leg leg : kLegs) {
    const LegModel& model = (*plain.legs)[leg];
    for (const char* role : {"abduction", "hip", "knee"}) {
      const double more = std::string(role) == "abduction" ? 0.3 : 0;
      EXPECT_NEAR(counted.home[model.joint(role)], plain.home[model.joint(role)] + more, 1e-9) << role;
    }
    EXPECT_LT((origins[leg] - others[leg]).norm(), 1e-9);
  }
}

constexpr const char* kTwoActuators = R"(<actuator>
  <position name="p" joint="FL_hip" kp="20" gear="2" forcerange="-5 8"/>
  <position name="q" joint="FR_hip" kp="30"/>
  <motor name="m" joint="FL_knee" gear="3" ctrlrange="-4 4"/>
  <motor name="n" joint="FR_knee" gear="3" ctrlrange="-4 4" forcerange="-2 2"/>
  <general name="g" joint="RL_hip" gaintype="fixed" gainprm="40" biastype="affine" biasprm="0 -40 -3"/>
  <general name="x" joint="RL_knee" dyntype="filter" dynprm=".1"/>
  <muscle name="y" joint="RR_hip"/></actuator>)";

TEST_F(MjcfReader, ActuatorsAreServosAndTorquesBehindTheirGears) {
  MadeMjcf mjcf;
  mjcf.sections = kTwoActuators;
  const ParsedRobot robot = tree(mjcf);
  const auto joint = [&](const std::string& link) { return body(robot, link).joint; };
  EXPECT_EQ(joint("FL_thigh").kp, 80);
  EXPECT_EQ(joint("FL_thigh").effort_limit, 16);
  EXPECT_EQ(joint("FL_shin").kp, 0);
  EXPECT_EQ(joint("FL_shin").effort_limit, 12);
  EXPECT_EQ(joint("FR_shin").effort_limit, 6);
  EXPECT_EQ(joint("RL_thigh").kp, 40);
  EXPECT_EQ(joint("RL_thigh").kd, 3);
  EXPECT_EQ(joint("RL_shin").effort_limit, 0);
  EXPECT_TRUE(warns(robot.warnings, "did not keep the lag of 0.1 s and the delay of 0 s of 1 motor(s)"));
  EXPECT_TRUE(warns(robot.warnings, "ignored the force of 1 <muscle>, neither motor nor servo of a joint"));
}

TEST_F(MjcfReader, AServosGainsAreTheFilesOrFollowFromThem) {
  MadeMjcf mjcf;
  mjcf.sections = kTwoActuators;
  const auto [robot, report] = load(mjcf);
  const auto joint = [&, &r = robot](Leg leg, const char* role) {
    return r.joint((*r.legs)[leg].joint(role));
  };
  EXPECT_EQ(joint(Leg::FL, "hip").kp, 80);
  EXPECT_EQ(joint(Leg::RL, "hip").kd, 3);
  // Nothing damps FR's: as the rule damps its own stiffness.
  const Joint rule = joint(Leg::RR, "hip");
  EXPECT_EQ(joint(Leg::FR, "hip").kp, 30);
  EXPECT_NEAR(joint(Leg::FR, "hip").kd, rule.kd * 30 / rule.kp, 1e-12);
  const auto servo = std::find_if(report.inferred.begin(), report.inferred.end(),
                                  [](const Inference& i) { return i.what == "servo"; });
  ASSERT_NE(servo, report.inferred.end());
  EXPECT_NE(servo->reason.find("the file's position actuators"), std::string::npos) << servo->reason;
}

TEST_F(MjcfReader, JointsThatAreDampedNeedNoDampingOfTheServo) {
  MadeMjcf mjcf;
  mjcf.defaults = "<joint damping=\".5\"/>";
  mjcf.sections = R"(<actuator><position joint="FL_hip" kp="20"/></actuator>)";
  const auto robot = load(mjcf).robot;
  EXPECT_EQ(robot.joint((*robot.legs)[Leg::FL].joint("hip")).kd, 0);
}

// Feet 0.2 cos(1) + 0.2 cos(1) = 0.216 m below the hips: all servo angles are the file's.
constexpr const char* kKeys = R"(<keyframe>
  <key name="lying" qpos="0 0 0 1 0 0 0  0 0  0 0  0 0  0 0"/>
  <key name="home" qpos="0 0 .2 1 0 0 0  1 -2  1 -2  1 -2  1 -2" ctrl="1 2 3"/></keyframe>)";

TEST_F(MjcfReader, TheKeyframeOfTheNameHomeIsTheHomePose) {
  MadeMjcf mjcf;
  mjcf.sections = kKeys;
  const auto [robot, report] = load(mjcf);
  for (int i = 0; i < robot.joint_count(); ++i) EXPECT_EQ(robot.home[i], i % 2 == 0 ? 1 : -2);
  EXPECT_NEAR(robot.standing_height, 0.4 * std::cos(1.0), 1e-12);
  const auto home = std::find_if(report.inferred.begin(), report.inferred.end(),
                                 [](const Inference& i) { return i.what == "home"; });
  ASSERT_NE(home, report.inferred.end());
  EXPECT_EQ(home->value, "the angles of keyframe 'home'");
}

TEST_F(MjcfReader, AKeyframeInWhichItCannotStandIsNotItsHome) {
  MadeMjcf mjcf;
  mjcf.sections = R"(<keyframe><key qpos="0 0 0 1 0 0 0  1.5 -3  1.5 -3  1.5 -3  1.5 -3"/></keyframe>)";
  const auto [robot, report] = load(mjcf);
  EXPECT_NEAR(robot.standing_height, 0.72 * 0.4, 1e-12);
  EXPECT_TRUE(
      warns(report.warnings, "the first keyframe is not taken for the home pose: its feet are 0.0283"));
}

TEST_F(MjcfReader, ConnectedBodiesAreALoop) {
  MadeMjcf mjcf;
  mjcf.sections = R"(<equality><connect name="tie" body1="FL_shin" body2="FR_shin" anchor="0 0 -.1"/>
                     <weld body1="RL_shin" body2="RR_shin"/>
                     <connect body1="RL_shin" body2="RR_shin" anchor="0 0 0" active="false"/></equality>)";
  const ParsedRobot robot = tree(mjcf);
  ASSERT_EQ(robot.loops.size(), 1U);
  EXPECT_EQ(robot.loops[0].name, "tie");
  EXPECT_LT((robot.loops[0].p_a - Vector3(0, 0, -0.1)).norm(), 1e-15);
  EXPECT_LT((robot.loops[0].p_b - Vector3(0, 0.2, -0.1)).norm(), 1e-15);
  EXPECT_TRUE(warns(robot.warnings, "ignored 1 <weld> in <equality>"));
}

TEST_F(MjcfReader, JointsThatFollowAreCouplingsWithTheirSoftness) {
  MadeMjcf mjcf;
  mjcf.compiler = R"(<compiler angle="radian"/>)";
  mjcf.defaults =
      R"(<equality solimp=".8 .9 .002"/><default class="stiff"><equality solref=".004 1.5"/></default>)";
  mjcf.hip_joint = R"(ref="0.1")";
  mjcf.sections = R"(<equality><joint class="stiff" joint1="FL_knee" joint2="FL_hip" polycoef="0.3 -2 0.5"/>
                     <joint joint1="RL_hip" joint2="RL_knee"/>
                     <joint joint1="RR_knee" joint2="RR_hip" active="false"/></equality>
                     <actuator><motor joint="RL_hip"/></actuator>)";
  const ParsedRobot robot = tree(mjcf);
  ASSERT_EQ(robot.couplings.size(), 2U);
  const NamedCoupling& knee = robot.couplings[0];
  EXPECT_EQ(knee.follower, "FL_knee");
  EXPECT_EQ(knee.leader, "FL_hip");
  EXPECT_FALSE(knee.is_driven);
  // knee = 0.3 - 2 (hip - 0.1) + 0.5 (hip - 0.1)^2
  const double hip = 0.7, off = hip - 0.1;
  EXPECT_NEAR(JointCoupling{.coefficients = knee.coefficients}.follower_at(hip),
              0.3 - 2 * off + 0.5 * off * off, 1e-15);
  EXPECT_EQ(knee.softness.time_constant, 0.004);
  EXPECT_EQ(knee.softness.damping_ratio, 1.5);
  EXPECT_EQ(knee.softness.impedance_min, 0.8);
  EXPECT_EQ(knee.softness.impedance_width, 0.002);
  EXPECT_EQ(knee.softness.impedance_power, 2);  // MuJoCo's
  EXPECT_TRUE(knee.says_softness);
  EXPECT_TRUE(robot.couplings[1].is_driven);
  EXPECT_NEAR(robot.couplings[1].coefficients[0], 0.1, 1e-15);  // hip - 0.1 = knee
  EXPECT_EQ(robot.couplings[1].softness.time_constant, 0.02);
  EXPECT_FALSE(warns(robot.warnings, "equality"));
}

// MuJoCo, "tendon" in <equality>: lengths count from those at the references.
TEST_F(MjcfReader, TendonsThatTieTwoJointsAreCouplings) {
  MadeMjcf mjcf;
  mjcf.compiler = R"(<compiler angle="radian"/>)";
  mjcf.hip_joint = R"(ref="0.1")";
  mjcf.sections = R"(<tendon>
      <fixed name="belt"><joint joint="FL_hip" coef="2"/><joint joint="FL_knee" coef="-0.5"/></fixed>
      <fixed name="one"><joint joint="FR_knee" coef="4"/></fixed><fixed name="other"><joint joint="FR_hip" coef="-3"/></fixed>
      <fixed name="three"><joint joint="RL_hip" coef="1"/><joint joint="RL_knee" coef="1"/><joint joint="RR_hip" coef="1"/></fixed>
      </tendon><equality><tendon tendon1="belt" polycoef="0.3"/><tendon tendon1="one" tendon2="other" polycoef="0 2 1"/>
      <tendon tendon1="three"/></equality><actuator><motor joint="FL_hip"/></actuator>)";
  const ParsedRobot robot = tree(mjcf);
  ASSERT_EQ(robot.couplings.size(), 2U);
  const auto at = [](const NamedCoupling& c, double leader) {
    return JointCoupling{.coefficients = c.coefficients}.follower_at(leader);
  };
  // 2 (hip - 0.1) - 0.5 knee = 0.3, and the hip has the motor.
  EXPECT_EQ(robot.couplings[0].follower, "FL_knee");
  EXPECT_NEAR(at(robot.couplings[0], 0.7), (2 * 0.6 - 0.3) / 0.5, 1e-14);
  EXPECT_FALSE(robot.couplings[0].is_driven);
  // 4 knee = 2 t + t^2, t = -3 (hip - 0.1)
  EXPECT_EQ(robot.couplings[1].follower, "FR_knee");
  const double t = -3 * (0.7 - 0.1);
  EXPECT_NEAR(at(robot.couplings[1], 0.7), (2 * t + t * t) / 4, 1e-14);
  EXPECT_TRUE(robot.coupled.at("RL_hip").starts_with("hangs on tendon 'three' of 3 joint(s)"));
  EXPECT_TRUE(warns(robot.warnings, "ignored 1 element(s) of <tendon>")) << "the one that is not simulated";
  EXPECT_TRUE(warns(robot.warnings, "ignored 1 <tendon> in <equality>"));
}

TEST_F(MjcfReader, AJointHeldByAnEqualityIsPartOfWhatItHangsOn) {
  MadeMjcf mjcf;
  mjcf.compiler = R"(<compiler angle="radian"/>)";
  for (const Leg leg : kLegs) {
    const std::string p(name(leg));
    mjcf.sections += fmt::format(R"(<joint joint1="{}_toe" polycoef="0.25"/>)", p);
  }
  mjcf.sections = "<equality>" + mjcf.sections + "</equality>";
  std::string text = mjcf.text();
  for (const Leg leg : kLegs) {
    const std::string foot = fmt::format("<geom name=\"{}_foot\"", name(leg));
    text.insert(
        text.find(foot),
        fmt::format(
            R"(<body name="{0}_end" pos="0 0 -.2"><inertial pos="0 0 0" mass=".1" diaginertia="1e-4 1e-4
                             1e-4"/><joint name="{0}_toe" axis="0 1 0" ref="0.1"/></body>)",
            name(leg)));
  }
  const LoadedRobot loaded = load_robot_with_report(write("made.xml", text));
  EXPECT_EQ(loaded.robot.joint_count(), 8);
  EXPECT_NEAR(loaded.report.locked.at("FL_toe"), 0.35, 1e-15);
  EXPECT_TRUE(warns(loaded.report.warnings, "4 joint(s) are held rigidly"));
  MadeMjcf wrong;
  wrong.sections = R"(<equality><joint joint1="FL_elbow"/></equality>)";
  EXPECT_EQ(refusal(wrong).expected(), "a hinge of this file in joint1");
}

TEST_F(MjcfReader, AFollowerOfNothingIsRefused) {
  MadeMjcf mjcf;
  mjcf.sections = R"(<equality><joint joint1="FL_knee" joint2="FL_elbow"/></equality>)";
  EXPECT_EQ(refusal(mjcf).found(), "'FL_elbow'");
  mjcf.sections = R"(<equality><joint joint1="FL_knee" joint2="FL_hip" polycoef="one"/></equality>)";
  EXPECT_EQ(refusal(mjcf).expected(), "1 to 5 finite number(s) in polycoef");
}

// Two servos that are coupled both act, as MuJoCo has it.
TEST_F(MjcfReader, AServoThatFollowsKeepsItsServoWithAWarning) {
  MadeMjcf mjcf;
  mjcf.sections = R"(<equality><joint joint1="FL_knee" joint2="FR_knee"/></equality><actuator>)";
  for (const Leg leg : kLegs)
    mjcf.sections +=
        fmt::format(R"(<position joint="{0}_hip" kp="60"/><position joint="{0}_knee" kp="60"/>)", name(leg));
  mjcf.sections += "</actuator>";
  const LoadedRobot loaded = load_robot_with_report(file(mjcf));
  EXPECT_EQ(loaded.robot.actuated_joints().size(), 8U);
  ASSERT_EQ(loaded.robot.couplings.size(), 1U);
  EXPECT_TRUE(warns(loaded.report.warnings, "have a servo of their own"));
}

TEST_F(MjcfReader, WhatChangesMotionAndIsNotSimulatedIsCounted) {
  MadeMjcf mjcf;
  mjcf.world = R"(<body name="box" pos="1 0 0"><freejoint/><geom size=".1"/></body>)";
  mjcf.sections = R"(<tendon><fixed name="t"><joint joint="FL_hip" coef="1"/></fixed></tendon>
                     <contact><exclude body1="trunk" body2="FL_shin"/></contact>
                     <custom><numeric name="n" data="1"/></custom>)";
  const ParsedRobot robot = tree(mjcf);
  for (const char* warning : {"ignored 1 element(s) of <tendon>", "ignored 1 element(s) of <contact>",
                              "left out 1 body or bodies beside the robot"})
    EXPECT_TRUE(warns(robot.warnings, warning)) << warning;
}

TEST_F(MjcfReader, AttributesThatTheEngineDoesNotKnowAreIgnoredAndCounted) {
  MadeMjcf mjcf;
  mjcf.hip_joint = "wobble=\"3\"";
  EXPECT_TRUE(warns(
      tree(mjcf).warnings,
      "ignored 4 attribute(s) 'wobble' of <joint> that the engine does not know, first in joint 'FL_hip'"));
}

TEST_F(MjcfReader, ABodyOfTheWorldWithoutAJointIsTheBase) {
  MadeMjcf mjcf;
  mjcf.trunk_joint = "";
  EXPECT_TRUE(warns(tree(mjcf).warnings, "took body 'trunk', which has no free joint, for the free base"));
}

TEST_F(MjcfReader, TheLinesOfErrorsAreTheFiles) {
  MadeMjcf mjcf;
  mjcf.shin = "<geom type=\"ball\"/>";
  const ConfigError error = refusal(mjcf);
  EXPECT_EQ(error.source(), path("made.xml"));
  EXPECT_EQ(error.element(), "line 5, geom 'FL_shin_geom_0'");
  EXPECT_NE(error.found().find("invalid keyword: 'ball'"), std::string::npos) << error.found();
  // In a file that is included, too.
  mjcf.shin = "<include file=\"geoms.xml\"/>";
  write("geoms.xml", "<mujocoinclude>\n\n<geom name=\"g\" type=\"sphere\"/></mujocoinclude>");
  EXPECT_EQ(refusal(mjcf).source(), path("geoms.xml"));
  EXPECT_EQ(refusal(mjcf).element(), "line 3, geom 'g'");
}

TEST_F(MjcfReader, RefusesByName) {
  struct Case {
    void (*change)(MadeMjcf&);
    std::string element, found;
  };
  const std::vector<Case> cases{
      {[](MadeMjcf& m) {
         m.thigh = "<body name=\"b\"><joint name=\"s\" type=\"slide\"/><geom size=\".1\"/></body>";
       },
       "joint 's'", "a slide joint"},
      {[](MadeMjcf& m) {
         m.thigh = "<body name=\"b\"><joint name=\"s\" type=\"ball\"/><geom size=\".1\"/></body>";
       },
       "joint 's'", "a ball joint"},
      {[](MadeMjcf& m) { m.thigh = "<joint name=\"second\" axis=\"1 0 0\"/>"; }, "joint 'second'",
       "a second one on 'FL_thigh'"},
      {[](MadeMjcf& m) { m.trunk_joint = "<joint name=\"up\" axis=\"0 0 1\"/>"; }, "joint 'up'",
       "another one"},
      {[](MadeMjcf& m) { m.world = "<body name=\"arm\"><joint axis=\"0 0 1\"/><geom size=\".1\"/></body>"; },
       "body 'trunk'", "a second one beside 'arm'"},
      {[](MadeMjcf& m) { m.thigh = "<composite type=\"grid\" count=\"99 99 1\"/>"; }, "composite",
       "<composite>"},
      {[](MadeMjcf& m) { m.asset = "<mesh name=\"m\" file=\"/etc/passwd.stl\"/>"; }, "mesh 'm'",
       "'/etc/passwd.stl'"},
      {[](MadeMjcf& m) { m.asset = "<mesh name=\"m\" file=\"a.stl\" scale=\"1 nan 1\"/>"; }, "mesh 'm'",
       "'1 nan 1'"},
      {[](MadeMjcf& m) { m.thigh = "<include file=\"made.xml\"/>"; }, "include", "again"},
      {[](MadeMjcf& m) { m.thigh = "<include file=\"/dev/zero\"/>"; }, "include", "'/dev/zero'"},
      {[](MadeMjcf& m) { m.sections = "<wings/>"; }, "wings", "unrecognized element"},
      // Too long: newer releases of MuJoCo fill up what is too short.
      {[](MadeMjcf& m) {
         m.sections =
             "<keyframe><key qpos=\"1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 "
             "28 "
             "29 30 31 32 33 34 35 36 37 38 39 40 41 42\"/></keyframe>";
       },
       "file", "invalid qpos size"},
      {[](MadeMjcf& m) { m.thigh_inertial = ""; }, "body 'FL_thigh'", "mass and inertia"},
  };
  for (const Case& c : cases) {
    MadeMjcf mjcf;
    c.change(mjcf);
    const ConfigError error = refusal(mjcf);
    EXPECT_EQ(error.source(), path("made.xml")) << error.what();
    EXPECT_NE(error.element().find(c.element), std::string::npos) << error.what();
    EXPECT_NE(error.found().find(c.found), std::string::npos) << error.what();
  }
}

TEST_F(MjcfReader, ARobotYamlNamesItByMjcf) {
  const MadeMjcf mjcf;
  const std::string xml = file(mjcf);
  const LoadedRobot inferred = load_robot_with_report(xml);
  write("robot.yaml", to_yaml(inferred, "made.xml"));
  const LoadedRobot stated = load_robot_with_report(path("robot.yaml"));
  EXPECT_TRUE(stated.report.inferred.empty());
  EXPECT_EQ(stated.robot.source, path("robot.yaml"));
  EXPECT_LT((stated.robot.home - inferred.robot.home).cwiseAbs().maxCoeff(), 1e-15);
  // Beside the file it is read along with it.
  EXPECT_EQ(load_robot(xml).source, path("robot.yaml"));
  write("robot.yaml", "mjcf: made.xml\nurdf: made.urdf\n");
  EXPECT_EQ(config_error([&] { (void)load_robot(path("robot.yaml")); }).found(), "both");
  write("robot.yaml", "mjcf: made.urdf\n");
  EXPECT_EQ(config_error([&] { (void)load_robot(path("robot.yaml")); }).expected(), "a .xml or .mjcf file");
}

TEST(MjcfCompilation, WithoutAnEngineThatCanItSaysSo) {
  const EngineRegistry none(std::vector<std::string>{});
  EXPECT_FALSE(none.compiles_mjcf());
  const ConfigError error = config_error([&] { (void)none.compile_mjcf({"robot.xml", "", {}}); });
  EXPECT_EQ(error.source(), "robot.xml");
  EXPECT_NE(error.expected().find("an engine that reads MJCF"), std::string::npos);
  // A program that has no registry either.
  const MjcfCompiler compiler = set_mjcf_compiler(nullptr);
  EXPECT_EQ(config_error([&] { (void)load_robot(kOwnMjcf); }).found(), "a program without engines");
  set_mjcf_compiler(compiler);
}

/// Positions of the base over two seconds of trot.
class RobotFile : public EngineTest {
 protected:
  static std::vector<Vector3> walk(const RobotDescription& description) {
    const auto robot = std::make_shared<const RobotDescription>(description);
    const auto world = make(robot);
    std::vector<Vector3> way;
    const auto watch = [&way](const WalkSample& sample) {
      way.push_back(sample.world.state().p_WB);
      return true;
    };
    (void)run_walk(
        *world,
        make_gait_controller(choose_gait("trot", {}, std::nullopt, gait_scale(*robot)), world->spec()),
        {.seconds = 2}, watch);
    return way;
  }
};
CROSSGAIT_FOR_EVERY_BACKEND(RobotFile);

TEST_P(RobotFile, WalksTheSameFromAnMjcfAsFromAUrdf) {
  if (!compiles_mjcf()) GTEST_SKIP() << "no available engine compiles MJCF";
  const std::vector<Vector3> mjcf = walk(load_robot(kOwnMjcf)), urdf = walk(load_robot(kSameUrdf));
  ASSERT_EQ(mjcf.size(), urdf.size());
  double apart = 0;
  for (std::size_t i = 0; i < urdf.size(); ++i) apart = std::max(apart, (mjcf[i] - urdf[i]).norm());
  measured("apart, m", apart);
  EXPECT_LT(apart, 1e-9);  // descriptions agree to 1e-12, and walking lets that grow
  EXPECT_GT(urdf.back().x(), 0.3);
}

TEST_P(RobotFile, LooksChangeNoBitOfAWalk) {
  RobotDescription plain = load_robot(kSameUrdf), seen = plain;
  for (Body& body : plain.bodies) body.visuals.clear();
  for (Body& body : seen.bodies) {
    ASSERT_FALSE(body.visuals.empty()) << body.name;
    body.visuals.push_back(
        {VisualType::kMesh, {}, "/nowhere.stl", {2, 2, 2}, Pose::Identity(), std::nullopt});
  }
  EXPECT_EQ(walk(plain), walk(seen));
}

TEST_F(MjcfReader, SaysWhatOfMotionIsNotSimulated) {
  MadeMjcf mjcf;
  mjcf.sections =
      "<option density=\"1.2\" viscosity=\"0.0\" wind=\"0 0 0\"><flag frictionloss=\"disable\" "
      "gravity=\"enable\" warmstart=\"disable\"/></option>";
  const std::vector<std::string> warnings = tree(mjcf).warnings;
  EXPECT_TRUE(
      warns(warnings, "did not simulate 1 attribute(s) density=\"1.2\" of <option>, first in option"));
  EXPECT_TRUE(warns(warnings, "did not simulate 1 attribute(s) frictionloss=\"disable\" of <flag>"));
  for (const char* neutral : {"viscosity", "wind", "gravity", "warmstart"})
    EXPECT_FALSE(warns(warnings, neutral)) << neutral;
}

}  // namespace
}  // namespace crossgait
