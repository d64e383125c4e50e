// The traps that real robots' files hold: each is read, and told of in one sentence per kind.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <regex>
#include <sstream>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "physics/robot_files/urdf/urdf_reader.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"
#include "tests/physics/robot_files/mesh_bytes.h"
#include "tests/physics/robot_files/scratch_robot.h"

namespace crossgait {
namespace {

using Warnings = std::vector<std::string>;

/// Without the numbers of lines, which change with the file.
Warnings warnings_of(const ParsedRobot& robot) {
  Warnings warnings = robot.warnings;
  for (std::string& warning : warnings) {
    warning = std::regex_replace(warning, std::regex(R"( \(line \d+\))"), "");
  }
  return warnings;
}

TEST(UrdfRealFiles, NothingToSayOfTheBundledRobots) {
  for (const char* name : {"scara_quadruped", "scara_quadruped_long"}) {
    const std::string urdf = CROSSGAIT_SOURCE_DIR "/models/robots/" + std::string(name) + "/robot.urdf";
    EXPECT_EQ(read_urdf(urdf).warnings, Warnings{}) << name;
  }
}

/// One change to the default robot's URDF, and what is said of it.
struct OddInput {
  const char* name;
  const char* from;
  const char* to;
  Warnings warnings;
};

void PrintTo(const OddInput& odd, std::ostream* stream) { *stream << odd.name; }

class OddUrdf : public ::testing::TestWithParam<OddInput> {};

TEST_P(OddUrdf, IsReadAndToldOf) {
  const ScratchRobot scratch;
  scratch.replace("robot.urdf", GetParam().from, GetParam().to);
  const ParsedRobot robot = read_urdf(scratch.path("robot.urdf"));
  EXPECT_EQ(robot.bodies.size(), 21U);
  EXPECT_EQ(warnings_of(robot), GetParam().warnings);
  EXPECT_NO_THROW(load_robot(scratch.path("robot.yaml")));
}

const char* const kDynamics = "<dynamics damping=\"0.02\"/>";
const char* const kKnee = "<geometry><sphere radius=\"0.005\"/></geometry>";
const char* const kNoLimit =
    "took limits that are missing or not lower < upper for +-pi rad in 1 joint(s), first in joint 'FL_tilt'";
const char* const kRaised =
    "1 moving link(s) whose small principal moments are raised to what a real body has: 'FL_tilt_link'";
const char* const kNegative =
    "1 moving link(s) with negative principal moments, raised to what a real body has: 'FL_tilt_link'";
const char* const kDropped =
    "dropped 1 <collision> without a sphere, box, cylinder, capsule or mesh, first in link 'FL_upper_left'";

const OddInput kOddUrdfs[] = {
    {"UnknownElement",
     "<dynamics damping=\"0.02\"/>",
     "<dynamic damping=\"0.02\"/>",
     {"ignored 1 <dynamic>, first in joint 'FL_tilt': damping=\"0.02\""}},
    {"UnknownElementDeepInside",
     "<link name=\"FL_tilt_link\">",
     "<link name=\"FL_tilt_link\"><cushion><softness value=\"x\"/></cushion><cushion/>",
     {"ignored 2 <cushion>, first in link 'FL_tilt_link'"}},
    {"UnknownAttribute",
     kDynamics,
     "<dynamics damping=\"0.02\" K=\"x\"/>",
     {"ignored 1 attribute(s) 'K' of <dynamics>, first in joint 'FL_tilt': K=\"x\""}},
    {"EmptyDynamics", kDynamics, "<dynamics/>", {}},
    {"SafetyController",
     kDynamics,
     "<safety_controller k_velocity=\"\"/><calibration/>",
     {"ignored 1 <safety_controller>, first in joint 'FL_tilt'",
      "ignored 1 <calibration>, first in joint 'FL_tilt'"}},
    {"NumbersOfWhatIsIgnored",
     kDynamics,
     "<safety_controller k_velocity=\"10\" soft_upper_limit=\" .5\"/><calibration rising=\"1e-3\"/><dynamics "
     "gain=\"7\"/>",
     {"ignored 1 <safety_controller>, first in joint 'FL_tilt': k_velocity=\"10\" soft_upper_limit=\".5\"",
      "ignored 1 <calibration>, first in joint 'FL_tilt': rising=\"1e-3\"",
      "ignored 1 attribute(s) 'gain' of <dynamics>, first in joint 'FL_tilt': gain=\"7\""}},
    {"TwoAxes",
     "<axis xyz=\"1 0 0\"/>",
     "<axis xyz=\"1 0 0\"/><axis xyz=\"0 1 0\"/>",
     {"ignored 1 further <axis>, first in joint 'FL_tilt'"}},
    {"BrokenVisual",
     "<link name=\"FL_tilt_link\">",
     "<link name=\"FL_tilt_link\"><visual><origin xyz=\"1\"/><geometry/><material/></visual>",
     {"dropped 1 <visual> without a shape or with numbers that are none, first in link 'FL_tilt_link'"}},
    {"BrokenMaterial", "<link name=\"trunk\">", "<material/><gazebo/><link name=\"trunk\">", {}},
    {"ReversedLimits", "lower=\"-1\" upper=\"1\"", "lower=\"1\" upper=\"-1\"", {kNoLimit}},
    {"EqualLimits", "lower=\"-1\" upper=\"1\"", "lower=\"0\" upper=\"0\"", {kNoLimit}},
    {"NoLimits",
     "<limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"10\"/>",
     "<limit effort=\"1\"/>",
     {kNoLimit}},
    {"LimitsBeyondATurn",
     "lower=\"-1\" upper=\"1\"",
     "lower=\"-10\" upper=\"10\"",
     {"took limits beyond +-2 pi rad for +-pi in 1 joint(s), first in joint 'FL_tilt'"}},
    {"JointFriction", kDynamics, "<dynamics damping=\"0.02\" friction=\"0.1\"/>", {}},
    {"IndefiniteInertia", "iyy=\"1.53e-05\"", "iyy=\"-1.53e-05\"", {kNegative}},
    {"NonOrthogonalInertia",
     "ixy=\"0\" ixz=\"0\" iyy=\"1.53e-05\"",
     "ixy=\"2e-05\" ixz=\"0\" iyy=\"1.53e-05\"",
     {kNegative}},
    {"ImpossibleInertia", "iyy=\"1.53e-05\"", "iyy=\"1.53e-04\"", {kRaised}},
    {"DuplicateShape",
     "<collision name=\"trunk_rear_left\">",
     "<collision name=\"trunk_front_left\">",
     {"renamed 1 collision shape(s) whose name was taken, first in link 'trunk'"}},
    {"MissingMesh",
     kKnee,
     "<geometry><mesh filename=\"knee.stl\"/></geometry>",
     {"dropped 1 collision mesh(es) whose file is not there, first in link 'FL_upper_left' ('knee.stl')"}},
    {"ForeignMesh",
     kKnee,
     "<geometry><mesh filename=\"knee.ply\" scale=\"1 1 1\"/></geometry>",
     {"dropped 1 collision mesh(es) that are no STL, OBJ or DAE, first in link 'FL_upper_left' "
      "('knee.ply')"}},
    {"Cone",
     kKnee,
     "<geometry><cone radius=\"0.005\" length=\"0.1\"/></geometry>",
     {"ignored 1 <cone>, first in link 'FL_upper_left': radius=\"0.005\" length=\"0.1\"", kDropped}},
    {"NoGeometry", kKnee, "", {kDropped}},
    {"TwoShapesInOne",
     kKnee,
     "<geometry><sphere radius=\"0.005\"/><box size=\"1 1 1\"/></geometry>",
     {"ignored 1 further <box>, first in link 'FL_upper_left'"}},
    {"Material",
     kKnee,
     "<geometry><sphere radius=\"0.005\"/></geometry><material name=\"\"/>",
     {"ignored 1 <material>, first in link 'FL_upper_left'"}},
    {"UnusedXacroNamespace", "<robot ", "<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\" ", {}},
};
const auto kOddCase = [](const auto& info) { return info.param.name; };
INSTANTIATE_TEST_SUITE_P(UrdfRealFiles, OddUrdf, ::testing::ValuesIn(kOddUrdfs), kOddCase);

class UrdfTraps : public ScratchFolder {
 protected:
  /// A base of 1 kg, and what is put into <robot> besides.
  ParsedRobot read_with_base(const std::string& more) const {
    return read_urdf(
        write("robot.urdf", "<robot name='r'>" + link("base", inertial(1, "1 1 1")) + more + "</robot>"));
  }
  static std::string link(const std::string& name, const std::string& content) {
    return "<link name='" + name + "'>" + content + "</link>";
  }
  /// @param moments  three numbers
  static std::string inertial(double mass, const std::string& moments) {
    std::istringstream words(moments);
    std::string ixx, iyy, izz;
    words >> ixx >> iyy >> izz;
    return "<inertial><mass value='" + std::to_string(mass) + "'/><inertia ixy='0' ixz='0' iyz='0' ixx='" +
           ixx + "' iyy='" + iyy + "' izz='" + izz + "'/></inertial>";
  }
  static std::string joint(const std::string& type, const std::string& parent, const std::string& child,
                           const std::string& content = "") {
    return "<joint name='to_" + child + "' type='" + type + "'><parent link='" + parent + "'/><child link='" +
           child + "'/>" + content + "</joint>";
  }
};

TEST_F(UrdfTraps, LimitsAreThoseThatHold) {
  std::string text;
  const auto add = [&](const std::string& name, const std::string& content) {
    text += link(name, inertial(1, "1 1 1")) + joint("revolute", "base", name, content);
  };
  add("a", "<limit lower='-1' upper='10' effort='-5'/><dynamics friction='0.3'/>");
  add("b", "<limit lower='4' upper='10' effort='7' velocity='1'/>");
  add("c", "");
  add("d", "<limit lower='-6.2831' upper=' +6.28&#10;'/>");
  const ParsedRobot robot = read_with_base(text);
  constexpr double kUnlimited = std::numbers::pi;
  const double expected[][4] = {{-1, kUnlimited, 0, 0.3},
                                {-kUnlimited, kUnlimited, 7, 0},
                                {-kUnlimited, kUnlimited, 0, 0},
                                {-6.2831, 6.28, 0, 0}};
  for (std::size_t i = 0; i < 4; ++i) {
    const Joint& j = robot.bodies.at(i + 1).joint;
    EXPECT_EQ(Eigen::Vector4d(j.lower, j.upper, j.effort_limit, j.friction), Eigen::Vector4d(expected[i]))
        << j.name;
  }
}

TEST_F(UrdfTraps, NumbersMayBeApartByAnySpace) {
  const ParsedRobot robot =
      read_with_base(link("rod", inertial(1, "1 1 1")) +
                     joint("continuous", "base", "rod", "<axis xyz='\n 0\t\t+1 \r\n 0 '/>"));
  EXPECT_EQ(robot.bodies[1].joint.axis, Vector3(0, 1, 0));
}

TEST_F(UrdfTraps, NamesMayHoldAnyCharacter) {
  const ParsedRobot robot = read_with_base(link("a&lt;&quot;&amp;b&gt;\xc3\xa9", inertial(1, "1 1 1")) +
                                           joint("fixed", "base", "a&lt;&quot;&amp;b&gt;\xc3\xa9"));
  EXPECT_EQ(robot.links.count("a<\"&b>\xc3\xa9"), 1U);
}

// Dummies of a sensor or a foot: only the whole body has to be one that can be.
TEST_F(UrdfTraps, InertiaIsThatOfTheWholeBody) {
  const ParsedRobot robot =
      read_with_base(link("imu", inertial(0, "0 0 0")) + joint("fixed", "base", "imu") +
                     link("camera", inertial(0.1, "1e-6 0 0")) + joint("fixed", "base", "camera") +
                     link("frame", "") + joint("fixed", "base", "frame"));
  EXPECT_EQ(robot.warnings, Warnings{});
  EXPECT_DOUBLE_EQ(robot.bodies[0].inertia.mass, 1.1);
}

TEST_F(UrdfTraps, MassIsWhatMakesInertiaCount) {
  const ParsedRobot robot = read_with_base(link("odd", inertial(0, "5 5 5")) + joint("fixed", "base", "odd") +
                                           link("point", "<inertial><mass value='1'/></inertial>") +
                                           joint("fixed", "base", "point"));
  EXPECT_EQ(robot.bodies[0].inertia.I_C, Matrix3::Identity());
  EXPECT_EQ(warnings_of(robot),
            (Warnings{"took 1 <inertial> without <inertia> for point mass(es), first in link 'point'",
                      "left out the inertia of 1 link(s) without mass, first in link 'odd'"}));
}

TEST_F(UrdfTraps, AbsentInertiaIsThatOfTheShapes) {
  const std::string mass = "<inertial><mass value='12'/></inertial>";
  const ParsedRobot robot = read_with_base(
      link("box", mass +
                      "<collision><origin xyz='.5 0 0'/><geometry><box size='1 2 3'/></geometry></collision>"
                      "<collision><origin xyz='-.5 0 0' rpy='0 1.5707963267948966 0'/>"
                      "<geometry><cylinder length='1' radius='.1'/></geometry></collision>") +
      joint("continuous", "base", "box") + link("ball", mass) + joint("continuous", "base", "ball"));
  // Boxed as 2 x 2 x 3 m; a sphere of water of 12 kg. Rounding of the turned cylinder.
  const double radius = std::cbrt(12 / 1000.0 * 3 / (4 * std::numbers::pi));
  EXPECT_LT((robot.bodies[2].inertia.I_C - Matrix3(Vector3(13, 13, 8).asDiagonal())).norm(), 1e-14);
  EXPECT_LT((robot.bodies[1].inertia.I_C - 0.4 * 12 * radius * radius * Matrix3::Identity()).norm(), 1e-14);
  EXPECT_EQ(
      warnings_of(robot),
      (Warnings{"took 2 <inertial> without <inertia> for point mass(es), first in link 'box'",
                "1 moving link(s) without inertia or shapes, given that of a solid sphere of water: 'ball'",
                "1 moving link(s) without inertia, given that of the bounding box of their shapes: 'box'"}));
}

TEST_F(UrdfTraps, ImpossibleInertiaIsRaisedByTheLeast) {
  const auto raised = [&](const std::string& moments) {
    const ParsedRobot robot =
        read_with_base(link("rod", inertial(1, moments)) + joint("continuous", "base", "rod"));
    EXPECT_EQ(robot.warnings.size(), 1U);
    const Matrix3& I = robot.bodies[1].inertia.I_C;
    EXPECT_EQ(I, I.transpose());
    return Vector3(Eigen::SelfAdjointEigenSolver<Matrix3>(I, Eigen::EigenvaluesOnly).eigenvalues());
  };
  // A thousandth above what the largest needs; rounding.
  EXPECT_LT((raised("0 0 1e-6") - Vector3(0.5005e-6, 0.5005e-6, 1e-6)).norm(), 1e-20);
  EXPECT_LT((raised("4 1 8") - Vector3(4.004, 4.004, 8)).norm(), 1e-14);
  EXPECT_LT((raised("1 6 8") - Vector3(2.008, 6, 8)).norm(), 1e-14);
  EXPECT_LT((raised("0 2 2") - Vector3(0.002, 2, 2)).norm(), 1e-14);
}

TEST_F(UrdfTraps, AMovingBodyNeedsMass) {
  const ConfigError error = config_error([&] {
    read_with_base(link("leg", inertial(0, "1 1 1")) + joint("continuous", "base", "leg") + link("foot", "") +
                   joint("fixed", "leg", "foot"));
  });
  EXPECT_EQ(error.element(), "link 'leg'");
  EXPECT_EQ(error.expected(), "mass (kg) > 0 on a moving link");
}

TEST_F(UrdfTraps, ABaseThatIsFixedToTheWorldIsFreeAndThatIsSaid) {
  const ParsedRobot robot = read_with_base(link("world", "") + joint("fixed", "world", "base"));
  EXPECT_EQ(robot.warnings, Warnings{"the file fixes its base to link 'world'; here the base is free"});
}

TEST_F(UrdfTraps, AMasslessRootLetsItsChildFloat) {
  const std::string world = link("world", "") + joint("floating", "world", "base", "<origin xyz='0 0 9'/>");
  const ParsedRobot robot = read_with_base(world);
  ASSERT_EQ(robot.bodies.size(), 1U);
  EXPECT_EQ(robot.bodies[0].name, "base");
  EXPECT_EQ(robot.bodies[0].parent, -1);
  EXPECT_EQ(robot.bodies[0].inertia.p_BC, Vector3(Vector3::Zero()));
  EXPECT_EQ(robot.links.count("world"), 0U);
  EXPECT_EQ(robot.warnings,
            Warnings{"left out root link 'world' and joint 'to_base': link 'base' is the free base"});

  const auto refused = [&](const std::string& text, const std::string& element) {
    const ConfigError error = config_error([&] { read_with_base(text); });
    EXPECT_EQ(error.found(), "'floating'") << error.what();
    EXPECT_NE(error.element().find(element), std::string::npos) << error.what();
  };
  refused(world + link("lamp", "") + joint("fixed", "world", "lamp"), "joint 'to_base'");
  refused(link("world", inertial(1, "1 1 1")) + joint("floating", "world", "base"), "joint 'to_base'");
  refused(world + link("ball", "") + joint("floating", "base", "ball"), "joint 'to_ball'");
}

TEST_F(UrdfTraps, CapsulesAreRead) {
  const ParsedRobot robot = read_with_base(
      link("shin", inertial(1, "1 1 1") +
                       "<collision name='rod'><origin xyz='0 0 1' rpy='1.5707963267948966 0 0'/>"
                       "<geometry><capsule radius=' .1 ' length='.6'/></geometry></collision>") +
      joint("continuous", "base", "shin"));
  ASSERT_EQ(robot.bodies[1].shapes.size(), 1U);
  const CollisionShape& capsule = robot.bodies[1].shapes[0];
  EXPECT_EQ(capsule.type, ShapeType::kCapsule);
  EXPECT_EQ(capsule.name, "rod");
  EXPECT_EQ(capsule.size, Vector3(0.1, 0.3, 0)) << "half the length between the centres of its ends";
  EXPECT_EQ(capsule.X_BG.translation(), Vector3(0, 0, 1));
  EXPECT_LT((capsule.X_BG.linear().col(2) - Vector3(0, -1, 0)).norm(), 1e-15);
  EXPECT_TRUE(robot.warnings.empty());

  const auto refused = [&](const std::string& attributes) {
    return config_error([&] {
      read_with_base(link("shin", inertial(1, "1 1 1") + "<collision name='rod'><geometry><capsule " +
                                      attributes + "/></geometry></collision>") +
                     joint("continuous", "base", "shin"));
    });
  };
  EXPECT_EQ(refused("radius='.1'").expected(), "attribute 'length'");
  EXPECT_EQ(refused("radius='x' length='1'").expected(), "1 finite number(s)");
  EXPECT_EQ(refused("radius='-.1' length='1'").element(), "link 'shin', collision 'rod'");
  EXPECT_EQ(refused("radius='.1' length='0'").expected(), "size (m) > 0");
}

TEST_F(UrdfTraps, AbsentInertiaIsThatOfCapsulesAndHulls) {
  // A capsule from -0.5 to 0.5 along y, 0.2 across; a disc as a mesh, whose hull reaches to +-0.4, +-0.4 and
  // +-0.1.
  write("disc.obj", [] {
    std::string text;
    for (int i = 0; i < 16; ++i) {
      const double angle = 2 * std::numbers::pi * i / 16;
      for (const double z : {-0.1, 0.1})
        text += fmt::format("v {:.17g} {:.17g} {}\n", 0.4 * std::cos(angle), 0.4 * std::sin(angle), z);
    }
    return text;
  }());
  const ParsedRobot robot = read_with_base(
      link("rod",
           "<inertial><mass value='12'/></inertial><collision><origin rpy='1.5707963267948966 0 0'/>"
           "<geometry><capsule radius='.1' length='.8'/></geometry></collision>") +
      joint("continuous", "base", "rod") +
      link("disc",
           "<inertial><mass value='12'/></inertial><collision><geometry>"
           "<mesh filename='disc.obj'/></geometry></collision>") +
      joint("continuous", "base", "disc"));
  ASSERT_EQ(robot.bodies[1].name, "disc");
  EXPECT_EQ(robot.bodies[1].shapes[0].type, ShapeType::kHull);
  // m / 12 (a^2 + b^2) of the box around it; rounding.
  EXPECT_LT((robot.bodies[1].inertia.I_C - Matrix3(Vector3(0.68, 0.68, 1.28).asDiagonal())).norm(), 1e-12);
  EXPECT_LT((robot.bodies[2].inertia.I_C - Matrix3(Vector3(1.04, 0.08, 1.04).asDiagonal())).norm(), 1e-12);
  EXPECT_EQ(
      robot.warnings.back(),
      "2 moving link(s) without inertia, given that of the bounding box of their shapes: 'disc', 'rod'");
  EXPECT_EQ(std::count(robot.warnings.begin(), robot.warnings.end(),
                       "took 1 collision mesh(es) for their convex hull, first in link 'disc' ('disc.obj')"),
            1);
}

TEST_F(UrdfTraps, MeshesStandForTheirBox) {
  std::filesystem::create_directories(folder_ / "dog" / "meshes");
  write("dog/meshes/shin.obj", box_obj({2, 4, 6}));
  write("dog/meshes/plate.stl", text_stl({{1, 0, 7}, {3, 0, 7}, {1, 8, 7}}));
  const ParsedRobot robot = read_with_base(
      link("shin",
           inertial(1, "1 1 1") +
               "<collision name='shin'><origin xyz='0 0 1' rpy='0 0 1.5707963267948966'/><geometry>"
               "<mesh filename='package://dog/meshes/shin.obj' scale='.1 0.1 -0.1'/></geometry></collision>"
               "<collision><geometry><mesh filename='dog/meshes/plate.stl'/></geometry></collision>") +
      joint("fixed", "base", "shin", "<origin xyz='5 0 0'/>"));
  const std::vector<CollisionShape>& shapes = robot.bodies[0].shapes;
  ASSERT_EQ(shapes.size(), 2U);
  EXPECT_EQ(shapes[0].type, ShapeType::kBox);
  EXPECT_LT((shapes[0].size - Vector3(0.1, 0.2, 0.3)).norm(), 1e-15);  // rounding, here and below
  EXPECT_LT((shapes[0].X_BG.translation() - Vector3(5, 0, 1)).norm(), 1e-15);
  EXPECT_EQ(shapes[1].size, Vector3(1, 4, 1e-4)) << "a flat one is given some thickness";
  EXPECT_EQ(shapes[1].X_BG.translation(), Vector3(7, 4, 7));
  EXPECT_EQ(robot.links.at("shin").shapes, (std::vector<int>{0, 1}));

  ASSERT_EQ(robot.mesh_vertices.size(), 2U);
  const std::vector<Vector3>& corners = robot.mesh_vertices.at("shin");
  ASSERT_EQ(corners.size(), 8U);
  for (const Vector3& corner : corners) {
    const Vector3 from_centre = corner - shapes[0].X_BG.translation();
    EXPECT_LT((from_centre.cwiseAbs() - Vector3(0.2, 0.1, 0.3)).norm(), 1e-15) << "turned by 90 degrees";
  }
  EXPECT_EQ(robot.mesh_vertices.at("shin_collision_1").front(), Vector3(6, 0, 7));
  EXPECT_EQ(robot.warnings,
            Warnings{"took 2 collision mesh(es) for the box around them, first in link 'shin' "
                     "('package://dog/meshes/shin.obj')"});
}

TEST_F(UrdfTraps, MeshesTogetherHaveABudget) {
  std::string many;
  for (int i = 0; i < 400'000; ++i) many += "v 0 1 " + std::to_string(i) + "\n";
  write("many.obj", many);
  const auto mesh = [](const std::string& file) {
    return "<collision><geometry><mesh filename='" + file +
           "' scale='1e-6 1e-6 1e-6'/></geometry></collision>";
  };
  const auto refused = [&](const std::string& shapes) {
    return config_error([&] { read_with_base(link("a", shapes) + joint("fixed", "base", "a")); });
  };
  EXPECT_EQ(refused(mesh("many.obj") + mesh("many.obj") + mesh("many.obj")).expected(),
            "at most 1000000 vertices of collision meshes");
  const std::string large = "v 0 0 0\nv 1 1 1\n" + std::string(22 * kMebibyte, '#');
  for (const char* file : {"a.obj", "b.obj", "c.obj"}) write(file, large);
  EXPECT_EQ(refused(mesh("a.obj") + mesh("b.obj") + mesh("c.obj")).expected(),
            "files of at most 64 MiB together");
  // A mesh that is there, and is none, is a mistake.
  EXPECT_EQ(refused(mesh(write("bad.stl", "none"))).source(), path("bad.stl"));
  const ConfigError flat =
      refused("<collision><geometry><mesh filename='many.obj' scale='0 1 1'/></geometry></collision>");
  EXPECT_EQ(flat.element(), "link 'a' ('many.obj')");
  EXPECT_EQ(flat.expected(), "a scale of three numbers that are not 0");
  EXPECT_EQ(flat.found(), "'0 1 1'");
}

TEST_F(UrdfTraps, XacroIsKnownByTheNameOfTheFile) {
  const std::string file = write("robot.urdf",
                                 "<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'>"
                                 "<link name='a'/><gazebo><xacro:if value='1'/></gazebo></robot>");
  const ConfigError error = config_error([&] { read_urdf(file); });
  EXPECT_EQ(error.expected(), "an expanded URDF, or a file whose name ends in .xacro, which xacro expands");
  EXPECT_EQ(error.found(), "<xacro:if>");
}

TEST_F(UrdfTraps, VeryManyNumbersOfWhatIsIgnoredAreCutShortAndSo) {
  std::string element = "<odd";
  for (int i = 0; i < 40; ++i) element += " number" + std::to_string(i) + "='" + std::to_string(i) + "'";
  const std::string warning = warnings_of(read_with_base(element + "/>")).front();
  EXPECT_NE(warning.find(": number0=\"0\" number1=\"1\""), std::string::npos) << warning;
  EXPECT_TRUE(warning.ends_with("\" ...")) << warning;
  EXPECT_EQ(warning.find("number39"), std::string::npos);
}

TEST_F(UrdfTraps, WarningsStayFew) {
  std::string unknown;
  for (int i = 0; i < 1000; ++i) unknown += "<a" + std::to_string(i) + "/>";
  const ParsedRobot robot = read_with_base(link("x", unknown + unknown) + joint("fixed", "base", "x"));
  ASSERT_EQ(robot.warnings.size(), 65U);
  EXPECT_EQ(warnings_of(robot).front(), "ignored 2 <a0>, first in link 'x'");
  EXPECT_EQ(robot.warnings.back(), "there are 1872 more things of other kinds");
  const std::string name(1001, 'n');
  EXPECT_EQ(config_error([&] { read_with_base(link(name, "")); }).expected(), "a name of at most 1000 bytes");
}

}  // namespace
}  // namespace crossgait
