#include "physics/robot_files/sdf/sdf_reader.h"

#include <filesystem>
#include <numbers>

#include <gtest/gtest.h>

#include "physics/robot/loop_gap.h"
#include "physics/robot_files/robot_report.h"
#include "physics/robot_files/urdf/urdf_reader.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/robot_files/scratch_robot.h"
#include "tests/physics/robot_files/sdf_of.h"

namespace crossgait {
namespace {

using ::testing::Values;

constexpr double kSame = 1e-12;  // what is asked of a robot in another format; rounding of poses is 1e-16

/// A base of 2 kg, and a rod of 1 kg at `pose` that turns about `axis`.
std::string two_links(const std::string& rod = "", const std::string& joint = "",
                      const std::string& more = "") {
  constexpr const char* kInertia =
      "<inertia><ixx>.1</ixx><iyy>.2</iyy><izz>.25</izz><ixy>.01</ixy></inertia></inertial>";
  return fmt::format(
      "<model name=\"two\">\n<link name=\"base\"><inertial><mass>2</mass>{0}</link>\n"
      "<link name=\"rod\"><inertial><mass>1</mass>{0}{1}</link>\n"
      "<joint name=\"hinge\" "
      "type=\"revolute\"><parent>base</parent><child>rod</child>{2}</joint>\n{3}</model>\n",
      kInertia, rod, joint, more);
}

ParsedRobot read_text(const ScratchRobot& scratch, const std::string& body,
                      const std::string& version = "1.9") {
  scratch.write("test.sdf",
                fmt::format("<?xml version=\"1.0\"?>\n<sdf version=\"{}\">{}</sdf>", version, body));
  return read_sdf(scratch.path("test.sdf"));
}
ParsedRobot read_text(const std::string& body, const std::string& version = "1.9") {
  return read_text(ScratchRobot(), body, version);
}

bool warns(const ParsedRobot& robot, const std::string& of) {
  return std::ranges::any_of(robot.warnings,
                             [&](const std::string& w) { return w.find(of) != std::string::npos; });
}

void expect_near(const Pose& a, const Pose& b, double tolerance, const std::string& what) {
  EXPECT_LT((a.matrix() - b.matrix()).cwiseAbs().maxCoeff(), tolerance) << what;
}

void expect_same(const ParsedRobot& a, const ParsedRobot& b) {
  EXPECT_EQ(a.name, b.name);
  ASSERT_EQ(a.bodies.size(), b.bodies.size());
  for (std::size_t i = 0; i < a.bodies.size(); ++i) {
    const Body &x = a.bodies[i], &y = b.bodies[i];
    ASSERT_EQ(x.name, y.name);
    EXPECT_EQ(x.parent, y.parent);
    expect_near(x.X_PB, y.X_PB, kSame, x.name);
    EXPECT_EQ(x.inertia.mass, y.inertia.mass) << x.name;
    EXPECT_LT((x.inertia.p_BC - y.inertia.p_BC).norm(), kSame) << x.name;
    EXPECT_LT((x.inertia.I_C - y.inertia.I_C).norm(), kSame) << x.name;
    EXPECT_EQ(x.joint.name, y.joint.name);
    EXPECT_LT((x.joint.axis - y.joint.axis).norm(), kSame) << x.name;
    for (const auto member :
         {&Joint::lower, &Joint::upper, &Joint::effort_limit, &Joint::damping, &Joint::friction})
      EXPECT_EQ(x.joint.*member, y.joint.*member) << x.joint.name;
    EXPECT_EQ(x.joint.limited, y.joint.limited) << x.joint.name;
    ASSERT_EQ(x.shapes.size(), y.shapes.size()) << x.name;
    for (std::size_t k = 0; k < x.shapes.size(); ++k) {
      EXPECT_EQ(x.shapes[k].type, y.shapes[k].type) << x.name;
      EXPECT_LT((x.shapes[k].size - y.shapes[k].size).norm(), kSame) << x.name;
      expect_near(x.shapes[k].X_BG, y.shapes[k].X_BG, kSame, x.name);
    }
  }
  ASSERT_EQ(a.links.size(), b.links.size());
  for (const auto& [name, place] : a.links) {
    EXPECT_EQ(place.body, b.links.at(name).body) << name;
    expect_near(place.X_BL, b.links.at(name).X_BL, kSame, name);
  }
}

class BundledRobotAsSdf : public ::testing::TestWithParam<std::tuple<const char*, SdfStyle>> {};

TEST_P(BundledRobotAsSdf, IsTheSameRobot) {
  const auto [name, style] = GetParam();
  const std::string folder = std::string(CROSSGAIT_SOURCE_DIR "/models/robots/") + name;
  const ParsedRobot urdf = read_urdf(folder + "/robot.urdf");
  const ScratchRobot scratch;
  scratch.write("other.sdf", SdfOf(urdf, style).text());
  const ParsedRobot sdf = read_sdf(scratch.path("other.sdf"));
  expect_same(sdf, urdf);
  EXPECT_TRUE(sdf.warnings.empty()) << sdf.warnings.front();

  // And so is what is made of it, by the same robot.yaml.
  std::string yaml = read_text_file(folder + "/robot.yaml", kYamlBudget);
  yaml.replace(yaml.find("urdf: robot.urdf"), 16, "sdf: other.sdf");
  scratch.write("robot.yaml", yaml);
  const RobotDescription made = load_robot(scratch.path("robot.yaml")),
                         of_urdf = load_robot(folder + "/robot.yaml");
  ASSERT_EQ(made.joint_count(), of_urdf.joint_count());
  EXPECT_LT((made.home - of_urdf.home).cwiseAbs().maxCoeff(), kSame);
  EXPECT_NEAR(made.home_height, of_urdf.home_height, kSame);
  for (int i = 0; i < made.joint_count(); ++i) {
    EXPECT_EQ(made.joint(i).name, of_urdf.joint(i).name);
    EXPECT_NEAR(made.joint(i).kp, of_urdf.joint(i).kp, kSame * of_urdf.joint(i).kp);
  }
}

INSTANTIATE_TEST_SUITE_P(SdfReader, BundledRobotAsSdf,
                         ::testing::Combine(Values("scara_quadruped", "scara_quadruped_long",
                                                   "serial_quadruped"),
                                            Values(SdfStyle::kInModel, SdfStyle::kRelative)),
                         [](const auto& test) {
                           return std::string(std::get<0>(test.param)) +
                                  (std::get<1>(test.param) == SdfStyle::kInModel ? "_in_model" : "_relative");
                         });

/// A five-bar quadruped as Gazebo has it: drawn with its loops closed, which second joints of links close.
TEST(SdfReader, ClosesLoopsWhereALinkHangsOnTwo) {
  const RobotDescription robot = load_robot(kRobotFolder + "robot.yaml");
  const ParsedRobot urdf = read_urdf(kRobotFolder + "robot.urdf");
  std::map<std::string, double> home;
  for (int i = 0; i < robot.joint_count(); ++i) home[robot.joint(i).name] = robot.home[i];
  std::string loops;
  for (const Leg leg : kLegs)
    loops += fmt::format(
        "<joint name=\"{0}_tip\" type=\"{1}\"><pose>0 0 -.06 0 0 0</pose><parent>{0}_lower_left</parent>"
        "<child>{0}_lower_right</child><axis><xyz>0 1 0</xyz></axis></joint>",
        name(leg), is_front(leg) ? "revolute" : "ball");
  const ScratchRobot scratch;
  // Loops before what they close: which joints are of the tree must not hang on the order.
  scratch.write("robot.sdf", SdfOf(urdf, SdfStyle::kInModel, home).text(loops));
  std::string yaml = read_text_file(kRobotFolder + "robot.yaml", kYamlBudget);
  yaml.replace(yaml.find("urdf: robot.urdf"), 16, "sdf: robot.sdf");
  yaml.erase(yaml.find("loops:"), yaml.find("loop_softness:") - yaml.find("loops:"));
  yaml.erase(yaml.find("home:"), yaml.find("standing_height:") - yaml.find("home:"));
  yaml += "\nhome: {tilt: 0, shoulder_left: 0, shoulder_right: 0, elbow_left: 0, elbow_right: 0}\n";
  scratch.write("robot.yaml", yaml);
  const LoadedRobot loaded = load_robot_with_report(scratch.path("robot.yaml"));
  ASSERT_EQ(loaded.robot.loops.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    const LoopClosure& loop = loaded.robot.loops[i];
    EXPECT_EQ(loop.name, robot.loops[i].name);
    EXPECT_EQ(loop.body_a, robot.loops[i].body_a);
    EXPECT_EQ(loop.body_b, robot.loops[i].body_b);
    // The robot.yaml's home closes them to 1e-13 m, loading to 1e-9 m.
    EXPECT_LT((loop.p_AP - robot.loops[i].p_AP).norm(), 1e-9);
    EXPECT_LT((loop.p_BP - robot.loops[i].p_BP).norm(), 1e-9);
  }
  EXPECT_NEAR(loaded.robot.home_height, robot.home_height, 1e-9);
  EXPECT_NE(loaded.report.warnings.front().find("closed a loop at the place of 4 joint(s)"),
            std::string::npos)
      << loaded.report.warnings.front();
}

/// The five-bar quadruped of the bundle as an SDF without a robot.yaml.
LoadedRobot five_bars_of_sdf(const ScratchRobot& scratch, bool with_tilts, const std::string& loops) {
  const RobotDescription robot = load_robot(kRobotFolder + "robot.yaml");
  ParsedRobot urdf = read_urdf(kRobotFolder + "robot.urdf");
  std::map<std::string, double> home, tilts;
  for (int i = 0; i < robot.joint_count(); ++i) home[robot.joint(i).name] = robot.home[i];
  for (const LegModel& leg : *robot.legs) tilts[robot.joint(leg.joint("tilt")).name] = 0;
  if (!with_tilts) urdf = lock_joints(std::move(urdf), tilts);
  std::filesystem::remove(scratch.path("robot.yaml"));
  scratch.write("robot.sdf", SdfOf(urdf, SdfStyle::kInModel, home).text(loops));
  return load_robot_with_report(scratch.path("robot.sdf"));
}

std::string tips(const char* first = "left", const char* second = "right") {
  std::string loops;
  for (const Leg leg : kLegs)
    loops += fmt::format(
        "<joint name=\"{0}_tip\" type=\"ball\"><pose>0 0 -.06 0 0 0</pose><parent>{0}_lower_{1}</parent>"
        "<child>{0}_lower_{2}</child></joint>",
        name(leg), first, second);
  return loops;
}

TEST(SdfReader, FiveBarsAreFoundByTheirLoops) {
  const RobotDescription robot = load_robot(kRobotFolder + "robot.yaml");
  for (const bool with_tilts : {true, false}) {
    for (const bool swapped : {true, false}) {
      SCOPED_TRACE(fmt::format("{} {}", with_tilts, swapped));
      const ScratchRobot scratch;
      const std::string loops = swapped ? tips("right", "left") : tips();
      const LoadedRobot loaded = five_bars_of_sdf(scratch, with_tilts, loops);
      for (const Leg leg : kLegs) {
        const LegModel &found = (*loaded.robot.legs)[leg], &own = (*robot.legs)[leg];
        EXPECT_EQ(found.linkage, LegLinkage::kFiveBar);
        EXPECT_EQ(found.servos.size(), with_tilts ? 3U : 2U);
        for (const LegRole& role : found.roles()) {
          const std::string& joint = loaded.robot.joint(found.joint(role.name)).name;
          EXPECT_EQ(joint, robot.joint(own.joint(role.name)).name) << role.name;
          EXPECT_EQ(loaded.robot.joint(found.joint(role.name)).actuated, role.actuated) << role.name;
        }
        EXPECT_NEAR(found.foot_radius, own.foot_radius, 1e-12);
      }
      // It stands at a share of its legs, loops closed.
      EXPECT_GT(loaded.robot.standing_height, 0.05);
      const std::string yaml = to_yaml(loaded, scratch.path("robot.sdf"));
      scratch.write("again.yaml", yaml);
      const LoadedRobot again = load_robot_with_report(scratch.path("again.yaml"));
      EXPECT_EQ(again.robot.actuated_joints(), loaded.robot.actuated_joints());
      EXPECT_LT((again.robot.home - loaded.robot.home).cwiseAbs().maxCoeff(), 1e-9);
    }
  }
}

TEST(SdfReader, LoopsThatMakeNoFiveBarsLeaveEightChains) {
  const ScratchRobot scratch;
  EXPECT_NE(std::string(config_error([&] { five_bars_of_sdf(scratch, false, ""); }).what())
                .find("found eight chains of two joints, of which no one can tell how they make four legs"),
            std::string::npos);
}

TEST(SdfReader, TakesABallJointForTheLoopWhereverItStands) {
  const std::string crank =
      "<link "
      "name=\"crank\"><inertial><mass>1</mass><inertia><ixx>.1</ixx><iyy>.1</iyy><izz>.1</izz></inertia>"
      "</inertial></link><joint name=\"drive\" "
      "type=\"continuous\"><parent>base</parent><child>crank</child></joint>";
  const std::string ball =
      "<joint name=\"tie\" type=\"ball\"><parent>crank</parent><child>rod</child></joint>";
  std::string text = two_links("<pose>0 0 -.5 0 0 0</pose>", "", crank);
  text.insert(text.find("<joint"), ball);
  const ParsedRobot robot = read_text(text);
  ASSERT_EQ(robot.bodies.size(), 3U);
  ASSERT_EQ(robot.loops.size(), 1U);
  EXPECT_EQ(robot.loops[0].link_a, "crank");
  EXPECT_EQ(robot.loops[0].p_a, Vector3(0, 0, -0.5));
  EXPECT_EQ(robot.loops[0].p_b, Vector3::Zero());
}

TEST(SdfReader, AJointThatMimicsFollowsFromItsReference) {
  const std::string crank =
      "<link "
      "name=\"crank\"><inertial><mass>1</mass><inertia><ixx>.1</ixx><iyy>.1</iyy><izz>.1</izz></inertia>"
      "</inertial></link><joint name=\"drive\" type=\"continuous\"><parent>base</parent><child>crank</child>"
      "<axis><mimic joint=\"hinge\"><multiplier>-2</multiplier><offset>.3</offset><reference>.1</reference>"
      "</mimic></axis></joint>";
  const ParsedRobot robot = read_text(two_links("", "", crank), "1.11");
  ASSERT_EQ(robot.couplings.size(), 1U);
  EXPECT_EQ(robot.couplings[0].follower, "drive");
  EXPECT_EQ(robot.couplings[0].leader, "hinge");
  EXPECT_DOUBLE_EQ(robot.couplings[0].coefficients[0], 0.5);  // -2 (q - 0.1) + 0.3
  EXPECT_DOUBLE_EQ(robot.couplings[0].coefficients[1], -2);
  EXPECT_FALSE(warns(robot, "mimic"));
  std::string other = crank;
  other.replace(other.find("joint=\"hinge\""), 13, "joint=\"drive\"");
  EXPECT_THROW((void)read_text(two_links("", "", other), "1.11"), ConfigError);
}

TEST(SdfReader, PutsABodyAtItsJoint) {
  const ParsedRobot robot = read_text(two_links(
      "<pose>.5 0 -.25 0 0 1.5707963267948966</pose><collision name=\"tip\"><pose>0 0 -.5 0 0 0</pose>"
      "<geometry><sphere><radius>.125</radius></sphere></geometry></collision>",
      "<pose>.25 0 0 1.5707963267948966 0 0</pose><axis><xyz>0 0 2</xyz></axis>"));
  const Body& rod = robot.bodies[1];
  // The link is turned about z by a right angle, so that its x is y: there the joint is, turned about the
  // link's x, whose z is the link's -y.
  EXPECT_LT((rod.X_PB.translation() - Vector3(0.5, 0.25, -0.25)).norm(), kSame);
  EXPECT_LT((rod.joint.axis - Vector3(0, -1, 0)).norm(), kSame);
  EXPECT_LT((rod.shapes[0].X_BG.translation() - Vector3(-0.25, 0, -0.5)).norm(), kSame);
  EXPECT_LT((rod.inertia.p_BC - Vector3(-0.25, 0, 0)).norm(), kSame);
  EXPECT_FALSE(rod.joint.limited);
}

struct AxisCase {
  const char* version;
  const char* axis;
  Vector3 expected;  ///< in the rod's frame, turned by a right angle about z
};
class SdfAxis : public ::testing::TestWithParam<AxisCase> {};

TEST_P(SdfAxis, IsExpressedAsTheVersionSays) {
  const AxisCase& c = GetParam();
  const ParsedRobot robot = read_text(
      two_links("<pose>0 0 0 0 0 1.5707963267948966</pose>", std::string("<axis>") + c.axis + "</axis>"),
      c.version);
  EXPECT_LT((robot.bodies[1].joint.axis - c.expected).norm(), kSame);
  EXPECT_TRUE(robot.warnings.empty()) << robot.warnings.front();
}

INSTANTIATE_TEST_SUITE_P(
    SdfReader, SdfAxis,
    Values(AxisCase{"1.4", "<xyz>1 0 0</xyz>", {0, -1, 0}}, AxisCase{"1.5", "<xyz>1 0 0</xyz>", {1, 0, 0}},
           AxisCase{"1.6", "<xyz>1 0 0</xyz><use_parent_model_frame>1</use_parent_model_frame>", {0, -1, 0}},
           AxisCase{"1.6", "<use_parent_model_frame>true</use_parent_model_frame>", {0, 0, 1}},
           AxisCase{"1.7", "<xyz expressed_in=\"__model__\">1 0 0</xyz>", {0, -1, 0}},
           AxisCase{"1.10", "<xyz expressed_in=\"base\">0 1 0</xyz>", {1, 0, 0}},
           AxisCase{"1.12", "<xyz>0 3 4</xyz>", {0, 0.6, 0.8}}),
    [](const auto& test) { return std::string("case_") + std::to_string(test.index); });

/// Frames on frames on joints, and nested models by their placement frame and merged: each moves the rod by
/// .1 m.
TEST(SdfReader, FollowsFrames) {
  const std::string frames =
      "<frame name=\"a\"><pose degrees=\"true\">.1 0 0 0 0 90</pose></frame>"
      "<frame name=\"b\" attached_to=\"a\"><pose>.1 0 0 0 0 0</pose></frame>"
      "<frame name=\"c\"><pose relative_to=\"b\" rotation_format=\"quat_xyzw\">0 0 .1 0 0 0 2</pose></frame>"
      "<frame name=\"on_hinge\" attached_to=\"hinge\"/>";
  const ParsedRobot robot = read_text(two_links(
      "<pose relative_to=\"c\"/>", "<pose relative_to=\"on_rod\"/>",
      frames +
          "<frame name=\"on_rod\" attached_to=\"rod\"/>"
          "<model name=\"tool\" placement_frame=\"grip\"><pose relative_to=\"on_hinge\">0 0 .1 0 0 0</pose>"
          "<link "
          "name=\"hand\"><inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia>"
          "</inertial></link><frame name=\"grip\" attached_to=\"hand\"><pose>0 0 -.1 0 0 "
          "0</pose></frame></model>"
          "<joint name=\"weld\" type=\"fixed\"><parent>on_rod</parent><child>tool::grip</child></joint>"));
  ASSERT_EQ(robot.bodies.size(), 2U);
  EXPECT_LT((robot.bodies[1].X_PB.translation() - Vector3(0.1, 0.1, 0.1)).norm(), kSame);
  EXPECT_LT((robot.bodies[1].X_PB.linear() * Vector3::UnitX() - Vector3::UnitY()).norm(), kSame);
  const LinkPlacement& hand = robot.links.at("tool::hand");
  EXPECT_EQ(hand.body, 1);
  EXPECT_LT((hand.X_BL.translation() - Vector3(0, 0, 0.2)).norm(), kSame);
}

TEST(SdfReader, TakesWhatAJointSays) {
  const ParsedRobot robot = read_text(two_links(
      "",
      "<axis><xyz>0 1 "
      "0</xyz><limit><lower>-1</lower><upper>.5</upper><effort>7</effort><velocity>3</velocity>"
      "<stiffness>100</stiffness></limit><dynamics><damping>.5</damping><friction>.25</friction>"
      "<spring_reference>-.5</spring_reference><spring_stiffness>2</spring_stiffness></dynamics></axis>"));
  const Joint& joint = robot.bodies[1].joint;
  EXPECT_TRUE(joint.limited);
  EXPECT_EQ(joint.lower, -1);
  EXPECT_EQ(joint.upper, 0.5);
  EXPECT_EQ(joint.effort_limit, 7);
  EXPECT_EQ(joint.damping, 0.5);
  EXPECT_EQ(joint.friction, 0.25);
  EXPECT_EQ(joint.stiffness, 2);
  EXPECT_EQ(joint.spring_reference, -0.5);
  EXPECT_EQ(robot.velocity_limits, (std::map<std::string, double>{{"hinge", 3}}));
  EXPECT_TRUE(warns(robot, "ignored 1 <stiffness> of <limit>"));
  for (const char* none : {"-1e16", "-inf"}) {
    const ParsedRobot free = read_text(two_links(
        "",
        fmt::format("<axis><xyz>0 0 "
                    "1</xyz><limit><lower>{0}</lower><upper>inf</upper><effort>-1</effort></limit></axis>",
                    none)));
    EXPECT_FALSE(free.bodies[1].joint.limited);
    EXPECT_EQ(free.bodies[1].joint.effort_limit, 0);
    EXPECT_TRUE(free.warnings.empty());
  }
}

TEST(SdfReader, TakesSdfsOwnMassWhereNoneIsSaid) {
  const ParsedRobot robot = read_text(
      "<model name=\"m\"><link name=\"a\"/><link name=\"b\"><inertial><mass>3</mass></inertial></link>"
      "<joint name=\"j\" type=\"continuous\"><parent>a</parent><child>b</child></joint></model>");
  EXPECT_EQ(robot.bodies[0].inertia.mass, 1);
  EXPECT_EQ(robot.bodies[1].inertia.mass, 3);
  EXPECT_EQ(robot.bodies[1].inertia.I_C, Matrix3(Matrix3::Identity()));
  EXPECT_TRUE(warns(robot, "took SDF's default of 1 kg and 1 kg m^2 for 1 link(s) without <inertial>"));
  EXPECT_TRUE(warns(robot, "took SDF's default of 1 kg m^2 for 1 link(s) without <inertia>"));
}

TEST(SdfReader, ReadsShapesAndHowTheyTouch) {
  const auto collision = [](const std::string& name, const std::string& shape,
                            const std::string& surface = "") {
    return fmt::format("<collision name=\"{}\"><geometry>{}</geometry>{}</collision>", name, shape, surface);
  };
  const std::string rough =
      "<surface><friction><ode><mu>.8</mu><mu2>.5</mu2><fdir1>0 0 "
      "0</fdir1></ode><torsional><coefficient>2</coefficient>"
      "<patch_radius>.01</patch_radius></torsional></friction><contact><ode><kp>1e6</kp><max_vel>.05</"
      "max_vel></ode><collide_bitmask>0</collide_bitmask><category_bitmask>65535</category_bitmask>"
      "<bullet><split_impulse>1</split_impulse></bullet></contact></"
      "surface>";
  const ParsedRobot robot = read_text(two_links(
      collision("a", "<box><size>2 4 6</size></box>", rough) +
      collision("b", "<capsule><radius>.1</radius><length>.4</length></capsule>") +
      collision("c", "<ellipsoid><radii>.2 .2 .2</radii></ellipsoid>") +
      collision("d", "<ellipsoid><radii>.1 .2 .3</radii></ellipsoid>") +
      collision("e", "<plane><normal>0 0 1</normal></plane>") +
      collision("a", "<cylinder><radius>.1</radius><length>.4</length></cylinder>") +
      "<collision name=\"none\"/>"
      "<visual name=\"v\"><geometry><sphere><radius>.1</radius></sphere></geometry>"
      "<material><diffuse>1 0 0</diffuse><script><name>Gazebo/Red</name></script></material></visual>"
      "<visual name=\"w\"><geometry><sphere><radius>none</radius></sphere></geometry></visual>"));
  const std::vector<CollisionShape>& shapes = robot.bodies[1].shapes;
  ASSERT_EQ(shapes.size(), 5U);
  EXPECT_EQ(shapes[0].size, Vector3(1, 2, 3));
  EXPECT_EQ(shapes[1].type, ShapeType::kCapsule);
  EXPECT_EQ(shapes[1].size, Vector3(0.1, 0.2, 0));
  EXPECT_EQ(shapes[2].type, ShapeType::kSphere);
  EXPECT_EQ(shapes[3].type, ShapeType::kHull);
  EXPECT_EQ(shapes[4].name, "rod_a");
  ASSERT_EQ(robot.contact.shapes.size(), 1U);
  const ContactNumbers& contact = robot.contact.shapes.at("a");
  EXPECT_EQ(contact.friction[0], 0.8);
  EXPECT_NEAR(contact.friction[1], 3 * std::numbers::pi / 16 * 0.02, 1e-15);
  EXPECT_EQ(contact.condim, 4);
  EXPECT_EQ(contact.max_depenetration_velocity, 0.05);
  ASSERT_EQ(robot.bodies[1].visuals.size(), 1U);
  EXPECT_EQ(*robot.bodies[1].visuals[0].rgba, Eigen::Vector4d(1, 0, 0, 1));
  EXPECT_TRUE(warns(robot, "mu2 is 0.5"));
  EXPECT_TRUE(warns(robot, "left out 1 <kp> of surfaces: a spring of ODE's"));
  EXPECT_TRUE(warns(robot, "ignored 1 <collide_bitmask> of <contact>"));
  EXPECT_TRUE(warns(robot, "ignored 1 <bullet> of <contact>"));
  EXPECT_FALSE(warns(robot, "category_bitmask")) << "it says what is so anyway";
  EXPECT_TRUE(warns(robot, "dropped 1 collision(s) that are no box"));
  EXPECT_TRUE(warns(robot, "dropped 1 <collision> without a shape"));
  EXPECT_TRUE(warns(robot, "dropped 1 <visual> without a shape or with numbers that are none"));
}

TEST(SdfReader, TakesGainsOfPositionControllers) {
  const std::string plugin =
      "<plugin filename=\"gz-sim-joint-position-controller-system\" "
      "name=\"gz::sim::systems::JointPositionController\">"
      "<joint_name>hinge</joint_name><p_gain>40</p_gain><i_gain>.5</i_gain><cmd_max>9</cmd_max>"
      "<cmd_min>-4</cmd_min></plugin><plugin filename=\"libother.so\" name=\"other\"><any/></plugin>";
  const ParsedRobot robot = read_text(two_links(
      "", "<axis><limit><lower>-1</lower><upper>1</upper><effort>7</effort></limit></axis>", plugin));
  const Joint& joint = robot.bodies[1].joint;
  EXPECT_EQ(joint.kp, 40);
  EXPECT_EQ(joint.kd, 0.01);  // the plug-in's default
  EXPECT_EQ(joint.effort_limit, 7);
  EXPECT_EQ(joint.effort_negative, 4);
  EXPECT_TRUE(warns(robot, "left out 1 integral gain(s)"));
  EXPECT_TRUE(warns(robot, "1 <plugin> not run: 'libother.so'"));
}

/// A whole file of a world, whose robot is where its frames put it.
TEST(SdfReader, ReadsAWorldWithARobot) {
  const LoadedRobot loaded =
      load_robot_with_report(CROSSGAIT_SOURCE_DIR "/tests/physics/robot_files/sdf/yard_dog.sdf");
  const RobotDescription& robot = loaded.robot;
  EXPECT_EQ(robot.name, "yard_dog");
  EXPECT_EQ(robot.joint_count(), 12);
  EXPECT_NEAR(robot.total_mass(), 5.2 + 4 * (0.6 + 1.0 + 0.25), 1e-12);
  for (const Leg leg : kLegs) {
    const LegModel& model = (*robot.legs)[leg];
    const Vector3 corner(is_front(leg) ? 0.185 : -0.185, 0.05 * side_sign(leg), 0),
        aside(0, 0.08 * side_sign(leg), 0);
    const Body &hip = robot.bodies[static_cast<std::size_t>(model.joint("abduction")) + 1],
               &thigh = robot.bodies[static_cast<std::size_t>(model.joint("hip")) + 1],
               &shin = robot.bodies[static_cast<std::size_t>(model.joint("knee")) + 1];
    EXPECT_LT((hip.X_PB.translation() - corner).norm(), kSame);
    EXPECT_LT((thigh.X_PB.translation() - aside).norm(), kSame);
    EXPECT_LT((thigh.inertia.p_BC - Vector3(0, -0.02 * side_sign(leg), -0.03)).norm(), kSame);
    EXPECT_LT((shin.X_PB.translation() - Vector3(0, 0, -0.2)).norm(), kSame);
    for (const Body* body : {&thigh, &shin}) EXPECT_LT((body->joint.axis - Vector3::UnitY()).norm(), kSame);
    EXPECT_LT((model.p_BF - Vector3(0, 0, -0.2)).norm(), kSame);
    EXPECT_EQ(shin.joint.kp, 110);
    EXPECT_EQ(shin.joint.kd, 2);
    EXPECT_EQ(shin.joint.effort_limit, 36);
  }
  EXPECT_EQ(*robot.contact.find("friction"), std::vector<double>{0.8});
  EXPECT_EQ(loaded.report.warnings.size(), 3U) << loaded.report.warnings.back();  // sun, ground and sensor
}

TEST(SdfReader, FindsTheRobotOfAWorld) {
  const std::string plane = "<model name=\"floor\"><static>true</static><link name=\"l\"/></model>";
  const ParsedRobot robot = read_text(
      "<world name=\"w\"><physics type=\"ode\"><max_step_size>.004</max_step_size></physics><gravity>0 0 "
      "-1.6</gravity>"
      "<include><uri>model://sun_of_nowhere</uri></include>" +
      plane + two_links() + "</world>");
  EXPECT_EQ(robot.name, "two");
  EXPECT_EQ(robot.contact.timestep, 0.004);
  EXPECT_EQ((*robot.contact.gravity)[2], -1.6);
  EXPECT_TRUE(warns(
      robot,
      "left out 1 <include> whose file is not there, first in world 'w', include (line 2) ('model://sun"));
  EXPECT_TRUE(warns(robot, "left out 1 <model> beside the robot, first in model 'floor' (line 2)"));
}

TEST(SdfReader, IncludesModelsByFolderAndFile) {
  const ScratchRobot scratch;
  std::filesystem::create_directories(scratch.path("tool"));
  scratch.write("tool/model.config",
                "<model><sdf version=\"1.3\">no.sdf</sdf><sdf version=\"1.6\">tool.sdf</sdf></model>");
  scratch.write(
      "tool/tool.sdf",
      "<sdf version=\"1.6\"><model name=\"tool\"><pose>9 9 9 0 0 0</pose><link name=\"hand\"><inertial>"
      "<mass>.5</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial></link></model></"
      "sdf>");
  const auto include = [](const char* uri, const char* more, const char* child) {
    return fmt::format(
        "<include{}><uri>{}</uri><pose>0 0 .5 0 0 0</pose></include>"
        "<joint name=\"weld_{}\" type=\"fixed\"><parent>base</parent><child>{}</child></joint>",
        more, uri, child, child);
  };
  const ParsedRobot robot =
      read_text(scratch, two_links("", "",
                                   include("model://tool", "", "tool::hand") +
                                       include("tool/tool.sdf", " merge=\"true\"", "hand")));
  EXPECT_EQ(robot.bodies[0].inertia.mass, 3);
  EXPECT_LT((robot.links.at("hand").X_BL.translation() - Vector3(0, 0, 0.5)).norm(), kSame);
  EXPECT_LT((robot.links.at("tool::hand").X_BL.translation() - Vector3(0, 0, 0.5)).norm(), kSame);

  const ConfigError missing = config_error(
      [&] { read_text(scratch, two_links("", "", "<include><uri>model://nowhere</uri></include>")); });
  EXPECT_EQ(missing.expected(), "a model whose file is there");
  scratch.write(
      "tool/tool.sdf",
      "<sdf version=\"1.6\"><model name=\"tool\"><include><uri>tool.sdf</uri></include></model></sdf>");
  const ConfigError cycle =
      config_error([&] { read_text(scratch, two_links("", "", "<include><uri>tool</uri></include>")); });
  EXPECT_EQ(cycle.source(), scratch.path("tool/tool.sdf"));
  EXPECT_EQ(cycle.expected(), "files that do not include themselves");
}

// A quarter turn about z and a metre along x, of a link or the model, however the <pose> of an <include> says
// it: the hand is where the model has it, 0.5 m along its y.
TEST(SdfReader, PutsAnIncludeWhereItsPoseSays) {
  const ScratchRobot scratch;
  scratch.write(
      "tool.sdf",
      "<sdf version=\"1.9\"><model name=\"tool\"><link name=\"hand\"><pose>0 .5 0 0 0 0</pose><inertial>"
      "<mass>.5</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial></link></model>"
      "</sdf>");
  const auto placed = [&](const std::string& pose) {
    const ParsedRobot robot = read_text(
        scratch,
        two_links("", "<axis><xyz>0 1 0</xyz></axis>",
                  "<frame name=\"f\"><pose>0 0 7 0 0 0</pose></frame><include><uri>tool.sdf</uri>" + pose +
                      "</include><joint name=\"weld\" type=\"fixed\"><parent>base</parent><child>"
                      "tool::hand</child></joint>"));
    EXPECT_FALSE(warns(robot, "ignored")) << robot.warnings.front();
    return Vector3(robot.links.at("tool::hand").X_BL.translation());
  };
  const Vector3 turned(0.5, 0, 0);  // (0, 0.5, 0) by a quarter turn, and (1, 0, 0)
  EXPECT_LT((placed("<pose degrees=\"true\">1 0 0 0 0 90</pose>") - turned).norm(), kSame);
  EXPECT_LT((placed("<pose rotation_format=\"quat_xyzw\">1 0 0 0 0 1 1</pose>") - turned).norm(), kSame);
  EXPECT_LT((placed("<pose relative_to=\"f\" degrees=\"1\">1 0 0 0 0 90</pose>") - turned - Vector3(0, 0, 7))
                .norm(),
            kSame);
}

TEST(SdfReader, SaysWhatOfAFileIsMissing) {
  const ScratchRobot scratch;
  const auto refusal = [&](const std::string& uri) {
    return config_error(
        [&] { read_text(scratch, "<world name=\"w\"><include><uri>" + uri + "</uri></include></world>"); });
  };
  EXPECT_EQ(refusal("model://gone").found(),
            "none (left out 1 <include> whose file is not there, first in world 'w', include (line 2) "
            "('model://gone'))");
  const ConfigError urdf = refusal("robot.urdf");
  EXPECT_EQ(urdf.source(), scratch.path("robot.urdf"));
  EXPECT_EQ(urdf.found(), "<robot>, as a URDF has it: an SDF includes SDFs alone");
}

TEST(SdfReader, SaysOnceWhatItLeavesOut) {
  const ParsedRobot robot = read_text(two_links(
      "<gravity>false</gravity><collision name=\"c\"><geometry><polyline><point>0 0</point><point>1 0</point>"
      "<point>0 1</point><height>1</height></polyline></geometry></collision>"));
  EXPECT_EQ(
      robot.warnings,
      (std::vector<std::string>{
          "took SDF's default of z for the axis of 1 joint(s) that say none, first in joint 'hinge' (line 5)",
          "dropped 1 collision(s) that are no box, sphere, cylinder, capsule, ellipsoid or mesh, first in "
          "link 'rod', collision 'c', geometry, polyline (line 4)",
          "ignored 1 <gravity> of <link>, first in link 'rod', gravity (line 4): gravity=\"false\""}));
}

struct BadSdf {
  const char* name;
  std::string text, element, expected, found;
};
class BadSdfs : public ::testing::TestWithParam<BadSdf> {};

TEST_P(BadSdfs, AreNamed) {
  const BadSdf& c = GetParam();
  const ScratchRobot scratch;
  scratch.write("bad.sdf", c.text);
  const ConfigError error = config_error([&] { read_sdf(scratch.path("bad.sdf")); });
  EXPECT_EQ(error.source(), scratch.path("bad.sdf"));
  EXPECT_NE(error.element().find(c.element), std::string::npos) << error.what();
  EXPECT_NE(error.expected().find(c.expected), std::string::npos) << error.what();
  EXPECT_NE(error.found().find(c.found), std::string::npos) << error.what();
}

std::string sdf(const std::string& body) { return "<sdf version=\"1.9\">" + body + "</sdf>"; }
std::string joint_of_type(const std::string& type) {
  std::string text = two_links();
  return sdf(text.replace(text.find("revolute"), 8, type));
}

INSTANTIATE_TEST_SUITE_P(
    SdfReader, BadSdfs,
    Values(
        BadSdf{"Urdf", "<robot/>", "file", "an <sdf> element", "its name has to end in .urdf"},
        BadSdf{"AnotherElement", "<mujoco/>", "file", "an <sdf> element", "<mujoco>"},
        BadSdf{"Entities", "<?xml version=\"1.0\"?>\n<!-- < -->\n<!DOCTYPE a [<!ENTITY m \"5.2\">]>\n<sdf/>",
               "line 3", "XML that defines no entities of its own", "<!DOCTYPE ... ["},
        BadSdf{"NoVersion", "<sdf/>", "line 1, sdf", "version 1.4 to 1.12", "''"},
        BadSdf{"OldVersion", "<sdf version=\"1.3\"/>", "line 1, sdf", "version 1.4 to 1.12", "'1.3'"},
        BadSdf{"NoModel", sdf(""), "sdf", "a model with joints", "none"},
        BadSdf{"StaticModel", sdf(two_links("", "", "<static>1</static>")), "sdf", "not <static>", "'two'"},
        BadSdf{"TwoModels", sdf(two_links() + two_links()), "sdf", "one model with joints", "'two', 'two'"},
        BadSdf{"Prismatic", joint_of_type("prismatic"), "line 4, joint 'hinge'",
               "type revolute, continuous or fixed", "'prismatic'"},
        BadSdf{"LoneBall", joint_of_type("ball"), "joint 'hinge'", "type revolute, continuous or fixed",
               "'ball'"},
        BadSdf{"UnknownFrame", sdf(two_links("<pose relative_to=\"moon\"/>")), "line 3, link 'rod'",
               "a link, joint, frame or model", "'moon'"},
        BadSdf{"FramesInACycle", sdf(two_links("<pose relative_to=\"hinge\"/>")), "joint 'hinge'",
               "a pose that is relative to something else", "a cycle"},
        BadSdf{"FrameOfNothing", sdf(two_links("", "", "<frame name=\"f\" attached_to=\"moon\"/>")),
               "line 5, frame 'f'", "a link, joint, frame or model", "'moon'"},
        BadSdf{"SecondName", sdf(two_links("", "", "<frame name=\"rod\"/>")), "frame 'rod'",
               "a name that no other", "a second one"},
        BadSdf{"ShortPose", sdf(two_links("<pose>0 0 1</pose>")), "line 3, link 'rod', pose",
               "6 finite numbers", "'0 0 1'"},
        BadSdf{"NoNumber", sdf(two_links("<pose>0 0 1 0 0 nan</pose>")), "link 'rod', pose",
               "6 finite numbers", "nan"},
        BadSdf{"NoAxis", sdf(two_links("", "<axis><xyz>0 0 0</xyz></axis>")), "joint 'hinge', axis",
               "an axis of non-zero length", "(0, 0, 0)"},
        BadSdf{"FixedLoop",
               sdf(two_links("", "",
                             "<joint name=\"j\" type=\"fixed\"><parent>base</parent><child>rod</child>"
                             "</joint>")),
               "joint 'j'", "ball of a further joint of link 'rod'", "'fixed'"},
        BadSdf{"Automatic",
               sdf(two_links("", "",
                             "<link name=\"auto\"><inertial auto=\"true\"/></link><joint name=\"j\" "
                             "type=\"fixed\"><parent>rod</parent><child>auto</child></joint>")),
               "link 'auto', inertial", "written out", "auto=\"true\""},
        BadSdf{"ControllerOfNothing",
               sdf(two_links(
                   "", "",
                   "<plugin name=\"a::JointPositionController\"><joint_name>knee</joint_name></plugin>")),
               "joint_name", "a moving joint of the model", "'knee'"}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace crossgait
