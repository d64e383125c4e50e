// Meshes of an SDF: parts of files, and scales.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "physics/robot_files/sdf/sdf_reader.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"

namespace crossgait {
namespace {

class SdfMeshes : public ScratchFolder {
 protected:
  /// Two links on a joint, and a mesh on the first. Of box.obj: two tetrahedra, the second 10 m away.
  ParsedRobot read_with(const std::string& mesh, const std::string& tag = "collision") {
    write("box.obj",
          "v 1 0 0\nv 3 0 0\nv 1 2 0\nv 1 0 4\nv 10 0 0\nv 11 0 0\nv 10 1 0\nv 10 0 1\n"
          "o near\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\no far\nf 5 6 7\nf 5 6 8\nf 5 7 8\nf 6 7 8\n");
    constexpr const char* kInertial =
        "<inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz>"
        "</inertia></inertial>";
    return read_sdf(write(
        "a.sdf",
        fmt::format("<sdf version=\"1.9\"><model name=\"m\"><link name=\"a\">{0}<{1} name=\"c\"><geometry>"
                    "<mesh><uri>box.obj</uri>{2}</mesh></geometry></{1}></link><link name=\"b\">{0}</link>"
                    "<joint name=\"j\" type=\"revolute\"><parent>a</parent><child>b</child><axis>"
                    "<xyz>0 1 0</xyz></axis></joint></model></sdf>",
                    kInertial, tag, mesh)));
  }
  Vector3 middle_of(const std::string& mesh) {
    const ParsedRobot robot = read_with(mesh);
    Vector3 low = robot.mesh_vertices.at("c").front(), high = low;
    for (const Vector3& v : robot.mesh_vertices.at("c")) low = low.cwiseMin(v), high = high.cwiseMax(v);
    return (low + high) / 2;
  }
};

TEST_F(SdfMeshes, AreThePartThatIsNamed) {
  EXPECT_EQ(middle_of(""), Vector3(6, 1, 2));
  EXPECT_EQ(middle_of("<submesh><name>__default__</name></submesh>"), Vector3(6, 1, 2));
  EXPECT_EQ(middle_of("<submesh><name>near</name></submesh>"), Vector3(2, 1, 2));
  EXPECT_EQ(middle_of("<submesh><name>far</name><center>0</center></submesh>"), Vector3(10.5, 0.5, 0.5));
  EXPECT_EQ(middle_of("<submesh><name>far</name></submesh><scale>2 -2 1</scale>"), Vector3(21, -1, 0.5));
  EXPECT_EQ(middle_of("<submesh><name>near</name><center>true</center></submesh>"), Vector3::Zero());
  for (const std::string& w : read_with("<submesh><name>near</name><center>1</center></submesh>").warnings)
    EXPECT_EQ(w.find("ignored"), std::string::npos) << w;
  const ConfigError error = config_error([&] { middle_of("<submesh><name>side</name></submesh>"); });
  EXPECT_EQ(error.source(), path("box.obj"));
  EXPECT_EQ(error.expected(), "faces of a part named 'side'");
  EXPECT_EQ(error.found(), "'near', 'far'");
  EXPECT_EQ(config_error([&] { middle_of("<submesh/>"); }).expected(), "an element <name>");
}

// Pictures show whole files: the whole in the place of a part would be another robot.
TEST_F(SdfMeshes, ThatOnlyShowAreWholeOrDropped) {
  EXPECT_EQ(read_with("", "visual").bodies[0].visuals.at(0).mesh, path("box.obj"));
  const ParsedRobot part = read_with("<submesh><name>near</name></submesh>", "visual");
  EXPECT_EQ(part.bodies[0].visuals.at(0).mesh, "");
  EXPECT_EQ(part.warnings,
            std::vector<std::string>{
                "dropped 1 visual mesh(es) that are one <submesh> of their file, first in link "
                "'a', visual 'c', geometry, mesh (line 1) ('box.obj')"});
}

TEST_F(SdfMeshes, HaveVolumeAtTheirScale) {
  const ConfigError error = config_error([&] { middle_of("<scale>0 1 1</scale>"); });
  EXPECT_EQ(error.source(), path("a.sdf"));
  EXPECT_EQ(error.element(), "line 1, link 'a', collision 'c', geometry, mesh, scale");
  EXPECT_EQ(error.expected(), "a scale of three numbers that are not 0");
  EXPECT_EQ(error.found(), "'0 1 1'");
}

}  // namespace
}  // namespace crossgait
