#include "physics/robot_files/urdf/urdf_reader.h"

#include <locale>
#include <thread>

#include <gtest/gtest.h>

#include "tests/physics/core/config_error.h"
#include "tests/physics/robot_files/scratch_robot.h"

namespace crossgait {
namespace {

/// A base with a 1 kg body, a turned 3 kg body fixed to it, and a rod that turns on the fixed one.
constexpr const char* kFixedPair = R"(<robot name="pair">
  <link name="base">
    <inertial>
      <mass value="1"/>
      <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.25"/>
    </inertial>
    <collision><geometry><box size="0.2 0.4 0.6"/></geometry></collision>
  </link>
  <link name="box">
    <inertial>
      <origin xyz="0.5 0 0"/>
      <mass value="3"/>
      <inertia ixx="0.3" ixy="0" ixz="0" iyy="0.4" iyz="0" izz="0.5"/>
    </inertial>
    <collision><origin xyz="0 0 0.1"/><geometry><cylinder radius="0.1" length="0.6"/></geometry></collision>
  </link>
  <link name="marker"/>
  <link name="rod">
    <inertial>
      <mass value="2"/>
      <inertia ixx="0.1" ixy="0.01" ixz="0.02" iyy="0.1" iyz="0.03" izz="0.1"/>
    </inertial>
  </link>
  <joint name="weld" type="fixed">
    <parent link="base"/><child link="box"/>
    <origin xyz="1 0 0" rpy="0 0 1.5707963267948966"/>
  </joint>
  <joint name="second_weld" type="fixed">
    <parent link="box"/><child link="marker"/>
    <origin xyz="0 1 0"/>
  </joint>
  <joint name="hinge" type="continuous">
    <parent link="marker"/><child link="rod"/>
    <origin xyz="0 0 1"/>
    <axis xyz="0 3 4"/>
    <dynamics damping="0.5"/>
  </joint>
  <transmission name="for other programs"/>
</robot>)";

ParsedRobot read(const std::string& text) {
  const ScratchRobot scratch;
  scratch.write("test.urdf", text);
  return read_urdf(scratch.path("test.urdf"));
}

TEST(UrdfReader, MergesFixedLinksIntoTheirBody) {
  const ParsedRobot robot = read(kFixedPair);
  ASSERT_EQ(robot.bodies.size(), 2U);
  const SpatialInertia& base = robot.bodies[0].inertia;
  // The box's centre of mass lies at (1, 0.5, 0): its x is the base's y. Numbers of order one, rounding.
  EXPECT_DOUBLE_EQ(base.mass, 4);
  EXPECT_LT((base.p_BC - Vector3(0.75, 0.375, 0)).norm(), 1e-15);
  // Parallel-axis theorem with the reduced mass 3/4 and the distance (1, 0.5, 0); the box's x and y moments
  // change places.
  Matrix3 expected;
  expected << 0.1 + 0.4 + 0.75 * 0.25, -0.75 * 0.5, 0,  //
      -0.75 * 0.5, 0.2 + 0.3 + 0.75 * 1, 0,             //
      0, 0, 0.25 + 0.5 + 0.75 * 1.25;
  EXPECT_LT((base.I_C - expected).norm(), 1e-15);
  EXPECT_EQ(base.I_C, base.I_C.transpose());
}

TEST(UrdfReader, MovesShapesAndFramesOfFixedLinks) {
  const ParsedRobot robot = read(kFixedPair);
  const Body& base = robot.bodies[0];
  ASSERT_EQ(base.shapes.size(), 2U);
  EXPECT_EQ(base.shapes[0].name, "base_collision_0");
  EXPECT_EQ(base.shapes[0].type, ShapeType::kBox);
  EXPECT_EQ(base.shapes[0].size, Vector3(0.1, 0.2, 0.3));
  EXPECT_EQ(base.shapes[1].type, ShapeType::kCylinder);
  EXPECT_EQ(base.shapes[1].size, Vector3(0.1, 0.3, 0));
  EXPECT_EQ(base.shapes[1].X_BG.translation(), Vector3(1, 0, 0.1));
  EXPECT_EQ(robot.links.at("box").shapes, std::vector<int>{1});
  EXPECT_EQ(robot.links.at("marker").body, 0);
  // The box's y is the base's -x. Rounding.
  EXPECT_LT(robot.links.at("marker").X_BL.translation().norm(), 1e-15);
  EXPECT_LT((robot.bodies[1].X_PB.translation() - Vector3(0, 0, 1)).norm(), 1e-15);
  EXPECT_LT((robot.bodies[1].X_PB.linear() * Vector3::UnitX() - Vector3::UnitY()).norm(), 1e-15);
}

TEST(UrdfReader, ReadsJoints) {
  const Body rod = read(kFixedPair).bodies.at(1);
  EXPECT_EQ(rod.name, "rod");
  EXPECT_EQ(rod.parent, 0);
  EXPECT_EQ(rod.joint.name, "hinge");
  EXPECT_LT((rod.joint.axis - Vector3(0, 0.6, 0.8)).norm(), 1e-15);  // rounding of the normalisation
  EXPECT_EQ(rod.joint.damping, 0.5);
  EXPECT_EQ(rod.inertia.I_C(1, 2), 0.03);
  EXPECT_EQ(rod.inertia.I_C(2, 0), 0.02);
}

TEST(UrdfReader, LimitsRevoluteJointsWhoseLimitsAreMeant) {
  const auto joint = [](const std::string& type, const std::string& limits) {
    std::string text = kFixedPair;
    text.replace(text.find("continuous"), 10, type);
    const std::string damping = R"(<dynamics damping="0.5"/>)";
    text.insert(text.find(damping), "<limit effort=\"1\" velocity=\"1\" " + limits + "/>");
    return read(text).bodies.at(1).joint;
  };
  const Joint limited = joint("revolute", "lower=\"-0.5\" upper=\"0.25\"");
  EXPECT_TRUE(limited.limited);
  EXPECT_EQ(limited.lower, -0.5);
  EXPECT_EQ(limited.upper, 0.25);
  EXPECT_TRUE(joint("revolute", "lower=\"-0.5\" upper=\"100\"").limited);
  EXPECT_FALSE(joint("revolute", "lower=\"-100\" upper=\"100\"").limited);
  EXPECT_FALSE(joint("revolute", "").limited);
  EXPECT_FALSE(joint("continuous", "lower=\"-0.5\" upper=\"0.25\"").limited);
}

TEST(UrdfReader, ReadsADecimalPointInEveryLocale) {
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Comma));
  const ParsedRobot robot = read(kFixedPair);
  std::locale::global(before);
  EXPECT_EQ(robot.bodies[0].shapes[0].size, Vector3(0.1, 0.2, 0.3));
}

TEST(UrdfReader, RejectsOtherFormats) {
  EXPECT_EQ(config_error([] { read("<sdf/>"); }).expected(), "a <robot> element");
  EXPECT_EQ(config_error([] { read("<sdf/>"); }).found(), "<sdf>");
  EXPECT_EQ(config_error([] { read(""); }).expected(), "well-formed XML");
  EXPECT_EQ(config_error([] { read("<robot name='r'/>"); }).expected(), "at least one link");
}

/// A chain of links, each fixed to the one before.
std::string chain(int links) {
  std::string text = "<robot name='r'>";
  for (int i = 0; i < links; ++i) {
    const std::string own = std::to_string(i), before = std::to_string(i - 1);
    text += "<link name='" + own +
            "'><inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' " +
            "izz='1'/></inertial></link>";
    if (i == 0) continue;
    text += "<joint name='j" + own + "' type='fixed'><parent link='" + before + "'/><child link='" + own +
            "'/></joint>";
  }
  return text + "</robot>";
}

TEST(UrdfReader, ReadsLongChains) {
  const ParsedRobot robot = read(chain(1000));
  EXPECT_EQ(robot.bodies.size(), 1U);
  EXPECT_DOUBLE_EQ(robot.bodies[0].inertia.mass, 1000);
}

// Both are followed by recursion, TinyXML's and urdfdom's.
TEST(UrdfReader, RefusesMoreLinksAndLevelsThanItsBudget) {
  EXPECT_EQ(config_error([] { read(chain(1001)); }).expected(), "at most 1000 links");
  EXPECT_EQ(config_error([] { read(chain(5000)); }).expected(), "at most 20000 elements");
  std::string nested = "<robot name='r'>";
  for (int i = 0; i < 100000; ++i) nested += "<link name='a'>";
  EXPECT_EQ(config_error([&] { read(nested); }).expected(), "at most 32 levels");
}

TEST(UrdfReader, RefusesLinksInACircle) {
  std::string text = "<robot name='r'>";
  for (const char* link : {"a", "b", "c", "d", "root"}) text += std::string("<link name='") + link + "'/>";
  for (const auto& [parent, child] : {std::pair{"b", "a"}, {"c", "b"}, {"d", "c"}, {"b", "d"}}) {
    text += std::string("<joint name='j") + child + "' type='fixed'><parent link='" + parent +
            "'/><child link='" + child + "'/></joint>";
  }
  EXPECT_EQ(config_error([&] { read(text + "</robot>"); }).found(), "a cycle of joints");
}

TEST(UrdfReader, PrintsNothing) {
  const ScratchRobot scratch;
  scratch.write("test.urdf",
                R"(<robot><link name="a"><inertial><mass value="1"/></inertial></link></robot>)");
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  const ConfigError error = config_error([&] { read_urdf(scratch.path("test.urdf")); });
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_NE(error.found().find("name"), std::string::npos) << error.what();  // urdfdom's own words
}

TEST(UrdfReader, MayRunInSeveralThreads) {
  const ScratchRobot scratch;
  scratch.write("bad.urdf", R"(<robot><link name="a"><inertial><mass value="1"/></inertial></link></robot>)");
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      for (int k = 0; k < 5; ++k) {
        EXPECT_EQ(read_urdf(kRobotFolder + "robot.urdf").bodies.size(), 21U);
        EXPECT_THROW(read_urdf(scratch.path("bad.urdf")), ConfigError);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
}

}  // namespace
}  // namespace crossgait
