// What a URDF's links look like.
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/robot_files/parsed_robot.h"
#include "physics/robot_files/urdf/urdf_reader.h"
#include "tests/physics/core/scratch_folder.h"
#include "tests/physics/robot_files/serial_urdf.h"

namespace crossgait {
namespace {

class UrdfVisuals : public ScratchFolder {
 protected:
  /// A base and a link that turns, 1 m ahead, with a plate fixed to it 0.5 m above.
  ParsedRobot read_links(const std::string& base, const std::string& link, const std::string& plate,
                         const std::string& robot = "") const {
    const std::string inertia = SerialUrdf::inertia(1, Vector3::Zero());
    return read_urdf(
        write("robot.urdf",
              fmt::format("<robot name='r'>{}<link name='base'>{}{}</link><link name='link'>{}{}</link>"
                          "<link name='plate'>{}</link>"
                          "<joint name='j' type='continuous'><parent link='base'/><child link='link'/>"
                          "<origin xyz='1 0 0'/><axis xyz='0 1 0'/></joint>"
                          "<joint name='f' type='fixed'><parent link='link'/><child link='plate'/>"
                          "<origin xyz='0 0 .5'/></joint></robot>",
                          robot, inertia, base, inertia, link, plate)));
  }
};

TEST_F(UrdfVisuals, AreKeptWithTheirShapesPlacesAndColours) {
  write("wheel.dae", "anything");
  const ParsedRobot robot = read_links(
      "<visual><geometry><box size='1 2 3'/></geometry><material name='red'/></visual>"
      "<visual><geometry><sphere radius='.1'/></geometry></visual>",
      "<visual><origin xyz='0 0 1' rpy='0 0 1.5707963267948966'/><geometry><cylinder radius='.2' length='3'/>"
      "</geometry><material name='own'><color rgba='.1 .2 .3 .4'/></material></visual>",
      "<visual><origin xyz='.1 0 0'/><geometry><mesh filename='wheel.dae' scale='1 2 -3'/></geometry>"
      "<material name='own'/></visual><visual><geometry><capsule radius='.1' "
      "length='1'/></geometry></visual>",
      "<material name='red'><color rgba='1 0 0 1'/></material>");
  EXPECT_TRUE(robot.warnings.empty()) << fmt::format("{}", fmt::join(robot.warnings, "; "));
  const std::vector<VisualShape>&base = robot.bodies[0].visuals, &link = robot.bodies[1].visuals;
  ASSERT_EQ(base.size(), 2U);
  EXPECT_EQ(base[0].type, VisualType::kBox);
  EXPECT_EQ(base[0].size, Vector3(0.5, 1, 1.5));
  EXPECT_EQ(base[0].rgba, Eigen::Vector4d(1, 0, 0, 1));
  EXPECT_EQ(base[1].type, VisualType::kSphere);
  EXPECT_FALSE(base[1].rgba.has_value());
  ASSERT_EQ(link.size(), 3U);
  EXPECT_EQ(link[0].type, VisualType::kCylinder);
  EXPECT_EQ(link[0].size, Vector3(0.2, 1.5, 0));
  EXPECT_EQ(link[0].rgba, Eigen::Vector4d(0.1, 0.2, 0.3, 0.4));
  EXPECT_LT((link[0].X_BG * Vector3(1, 0, 0) - Vector3(0, 1, 1)).norm(), 1e-15);
  EXPECT_EQ(link[1].type, VisualType::kMesh);
  EXPECT_EQ(link[1].mesh, path("wheel.dae"));
  EXPECT_EQ(link[1].scale, Vector3(1, 2, -3));
  EXPECT_EQ(link[1].rgba, link[0].rgba);  // named by another visual
  EXPECT_LT((link[1].X_BG.translation() - Vector3(0.1, 0, 0.5)).norm(), 1e-15);
  EXPECT_EQ(link[2].type, VisualType::kCapsule);
}

// Roll, then pitch, then yaw, about fixed axes.
TEST_F(UrdfVisuals, TurnAsTheOriginsOfLinksDo) {
  const std::string origin =
      "<origin xyz='1 2 3' rpy='.3 -.7 1.1'/><geometry><sphere radius='1'/></geometry>";
  const ParsedRobot robot =
      read_links("<visual>" + origin + "</visual><collision>" + origin + "</collision>", "", "");
  EXPECT_LT((robot.bodies[0].visuals[0].X_BG.matrix() - robot.bodies[0].shapes[0].X_BG.matrix()).norm(),
            1e-15);
}

TEST_F(UrdfVisuals, ThatCannotBeShownAreDroppedAndCounted) {
  const ParsedRobot robot = read_links(
      "<visual/><visual><geometry/></visual><visual><geometry><sphere radius='-1'/></geometry></visual>"
      "<visual><origin xyz='0 0'/><geometry><sphere radius='1'/></geometry></visual>"
      "<visual><geometry><box size='1 2 3 "
      "4'/></geometry></visual><visual><geometry><cone/></geometry></visual>",
      "<visual><geometry><mesh filename='package://gone/a.dae'/></geometry></visual>"
      "<visual><geometry><mesh filename='b.stl'/></geometry></visual>",
      "");
  EXPECT_TRUE(robot.bodies[0].visuals.empty());
  // A mesh without a file is known to be missing, so that collision shapes stand in for it.
  ASSERT_EQ(robot.bodies[1].visuals.size(), 2U);
  for (const VisualShape& mesh : robot.bodies[1].visuals) {
    EXPECT_EQ(mesh.type, VisualType::kMesh);
    EXPECT_EQ(mesh.mesh, "");
  }
  EXPECT_EQ(
      robot.warnings,
      (std::vector<std::string>{
          "ignored 1 <cone>, first in link 'base' (line 1)",
          "dropped 6 <visual> without a shape or with numbers that are none, first in link 'base' (line 1)",
          "dropped 2 visual mesh(es) whose file is not there, first in link 'link' (line 1) "
          "('package://gone/a.dae')"}));
}

TEST_F(UrdfVisuals, MoveWithWhatIsLockedOrTurned) {
  const std::string ball = "<visual><geometry><sphere radius='1'/></geometry></visual>";
  const ParsedRobot locked = lock_joints(read_links(ball, ball, ""), {{"j", 0}});
  ASSERT_EQ(locked.bodies.size(), 1U);
  ASSERT_EQ(locked.bodies[0].visuals.size(), 2U);
  EXPECT_EQ(locked.bodies[0].visuals[1].X_BG.translation(), Vector3(1, 0, 0));
  const Matrix3 R = Eigen::AngleAxisd(std::numbers::pi / 2, Vector3::UnitZ()).toRotationMatrix();
  const ParsedRobot turned = turn_base(locked, R);
  EXPECT_LT((turned.bodies[0].visuals[1].X_BG.translation() - Vector3(0, -1, 0)).norm(), 1e-15);
}

}  // namespace
}  // namespace crossgait
