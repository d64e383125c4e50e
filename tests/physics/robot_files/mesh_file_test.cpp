#include <cctype>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <limits>

#include <gtest/gtest.h>

#include "physics/core/read_budget.h"
#include "physics/robot_files/mesh/mesh_path.h"
#include "physics/robot_files/mesh/mesh_vertices.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"
#include "tests/physics/robot_files/mesh_bytes.h"

namespace crossgait {
namespace {

class MeshFiles : public ScratchFolder {};

// The corner that both triangles share is one vertex.
const std::vector<Vector3> kSquare{{0, 0, 0.5}, {0, 1, 0.5}, {1, 0, 0.5}, {1, 1, 0.5}};
const std::vector<Vector3> kTwoTriangles{{0, 0, 0.5}, {1, 0, 0.5}, {0, 1, 0.5},
                                         {1, 1, 0.5}, {0, 1, 0.5}, {1, 0, 0.5}};

TEST_F(MeshFiles, AreReadInEveryFormat) {
  EXPECT_EQ(read_mesh_vertices(write("a.stl", binary_stl(kTwoTriangles))), kSquare);
  EXPECT_EQ(read_mesh_vertices(write("b.STL", text_stl(kTwoTriangles))), kSquare);
  EXPECT_EQ(
      read_mesh_vertices(write("c.obj",
                               "# v 9 9 9\r\nmtllib none.mtl\no square\r\nv 0 0 .5\r\nv 1 0 0.5\n"
                               "\tv\t0 1 5e-1 1.0\nvn 0 0 1\nvt 0 0\nv 1 1 +0.5 .2 .2 .2\nf 1 2 4 3\n")),
      kSquare);
  EXPECT_TRUE(is_mesh_format("a/b.Obj"));
  for (const char* other : {"a.ply", "stl", "a.stl/b", ""}) EXPECT_FALSE(is_mesh_format(other)) << other;
}

// Exporters write any header, and some a few bytes more than the triangles take.
TEST_F(MeshFiles, MayBeBinaryAndBeginAsText) {
  std::string stl = binary_stl(kTwoTriangles);
  std::memcpy(stl.data(), "solid", 5);
  EXPECT_EQ(read_mesh_vertices(write("a.stl", stl)), kSquare);
  EXPECT_EQ(read_mesh_vertices(write("b.stl", binary_stl(kTwoTriangles) + "end")), kSquare);
  EXPECT_EQ(read_mesh_vertices(write("c.stl", stl + "end")), kSquare);
}

TEST_F(MeshFiles, AreTextWhoseLinesEndAsOnAnySystem) {
  const std::string obj = "v 0 0 .5\nv 1 0 .5\nv 0 1 .5\nv 1 1 .5\nf 1 2 4 3\n",
                    stl = text_stl(kTwoTriangles);
  for (const char* end : {"\n", "\r\n", "\r"}) {
    EXPECT_EQ(read_mesh_vertices(write("a.obj", with_line_ends(obj, end))), kSquare) << end;
    EXPECT_EQ(read_mesh_vertices(write("a.stl", with_line_ends(stl, end))), kSquare) << end;
    const std::string bad = write("b.obj", with_line_ends("v 0 0 0\n\nv 1 0 x\n", end));
    EXPECT_EQ(config_error([&] { read_mesh_vertices(bad); }).element(), "line 3");
  }
}

// As some exporters write it: in capitals, without line ends, named by a keyword.
TEST_F(MeshFiles, MayBeTextOfAnyLook) {
  const std::string text = text_stl(kTwoTriangles);
  std::string capitals = text;
  for (char& c : capitals) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::string named = text;
  named.replace(0, std::strlen("solid mesh"), " solid my vertex list");
  for (const std::string& stl : {capitals, named, with_line_ends(text, " "), with_line_ends(named, " ")})
    EXPECT_EQ(read_mesh_vertices(write("a.stl", stl)), kSquare) << stl;
  // Two solids, of which each is half.
  std::string two = text;
  two.insert(two.find("  facet", 20), "endsolid vertex\nsolid vertex 2\n");
  EXPECT_EQ(read_mesh_vertices(write("a.stl", two)), kSquare);
}

// What an edit left over stands anywhere; points without any face are what there is.
TEST_F(MeshFiles, AreTheVerticesOfTheirFaces) {
  const std::string points = "v 0 0 .5\nv 1 0 .5\nv 9 9 9\nv 0 1 .5\nv 1 1 .5\n";
  EXPECT_EQ(read_mesh_vertices(write("a.obj", points + "f 1 2 4\nf -1 -2 -4\n")), kSquare);
  EXPECT_EQ(read_mesh_vertices(write("b.obj", points)).size(), 5U);
  const std::string bad = write("c.obj", points + "f 1 2 6\n");
  EXPECT_EQ(config_error([&] { read_mesh_vertices(bad); }).element(), "line 6");
}

TEST_F(MeshFiles, AreReadInPart) {
  const std::string file = write("a.obj",
                                 "v 0 0 .5\nv 1 0 .5\nv 0 1 .5\nv 1 1 .5\nv 5 5 5\nv 6 5 5\nv 5 6 5\n"
                                 "o left wheel\nf 1 2 3\ng tyre rim\nf 2 3 4\no body\nf 5 6 7\n");
  const auto first = [&](const std::string& part) { return read_mesh_vertices(file, part); };
  EXPECT_EQ(first("left wheel"), kSquare) << "with its groups";
  EXPECT_EQ(first("tyre"), (std::vector<Vector3>{kSquare[1], kSquare[2], kSquare[3]}));
  EXPECT_EQ(first("rim"), first("tyre"));
  EXPECT_EQ(first("body"), (std::vector<Vector3>{{5, 5, 5}, {5, 6, 5}, {6, 5, 5}}));
  const ConfigError error = config_error([&] { first("left"); });
  EXPECT_EQ(error.source(), file);
  EXPECT_EQ(error.expected(), "faces of a part named 'left'");
  EXPECT_EQ(error.found(), "'left wheel', 'tyre rim', 'body'");
  const std::string stl = write("a.stl", text_stl(kTwoTriangles));
  EXPECT_EQ(config_error([&] { read_mesh_vertices(stl, "mesh"); }).found(), "no part with a name");
}

TEST_F(MeshFiles, HaveTrianglesThatShareCorners) {
  for (const TriangleMesh& mesh : {read_mesh_triangles(write("a.stl", binary_stl(kTwoTriangles))),
                                   read_mesh_triangles(write("b.stl", text_stl(kTwoTriangles)))}) {
    EXPECT_EQ(mesh.vertices.size(), 4U);
    ASSERT_EQ(mesh.triangles.size(), 6U);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(mesh.vertices.at(mesh.triangles[i]), kTwoTriangles[i]);
  }
  // A polygon becomes a fan; numbers may have others behind slashes, and count from the end.
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  const TriangleMesh fan = read_mesh_triangles(write("c.obj", corners + "f 1/7/8 2//9 3 -1\r\n"));
  EXPECT_EQ(fan.triangles, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}));
  for (const char* face : {"f 1 2 5\n", "f 0 1 2\n", "f 1 2 -5\n", "f 1 2 x\n", "f 1 2 2.5\n"}) {
    const ConfigError error = config_error([&] { read_mesh_triangles(write("d.obj", corners + face)); });
    EXPECT_EQ(error.source(), path("d.obj"));
    EXPECT_EQ(error.element(), "line 5") << face;
  }
  EXPECT_EQ(config_error([&] { read_mesh_triangles(write("e.obj", corners)); }).element(), "file");
}

TEST_F(MeshFiles, AreRefusedByFileAndLine) {
  const auto what = [&](const std::string& name, const std::string& bytes) {
    const std::string file = write(name, bytes);
    return std::string(config_error([&] { read_mesh_vertices(file); }).what()).substr(file.size() + 2);
  };
  const std::string stl = binary_stl(kTwoTriangles);
  EXPECT_EQ(what("a.stl", stl.substr(0, stl.size() - 1)), "file: expected a whole STL mesh, found 183 bytes");
  EXPECT_EQ(what("a.stl", ""), "file: expected a whole STL mesh, found 0 bytes");
  EXPECT_EQ(what("a.stl", binary_stl({})), "file: expected a mesh with vertices, found none");
  EXPECT_EQ(
      what("a.stl", binary_stl({{0, 0, 0}, {0, std::numeric_limits<double>::quiet_NaN(), 0}, {0, 0, 0}})),
      "file: expected finite coordinates, found others");
  EXPECT_EQ(what("a.stl", "solid\nvertex 1 2"), "line 2: expected three finite coordinates, found ''");
  EXPECT_EQ(what("a.obj", "v 1 2 3\nv 1 two 3"), "line 2: expected three finite coordinates, found 'two'");
  EXPECT_EQ(what("a.obj", "v 1 2 inf"), "line 1: expected three finite coordinates, found 'inf'");
  EXPECT_EQ(what("a.obj", "f 1 2 3"), "file: expected a mesh with vertices, found none");
}

TEST_F(MeshFiles, StayWithinTheirBudget) {
  const std::string huge = write("huge.stl", "solid");
  std::filesystem::resize_file(huge, std::uintmax_t{1} << 40U);  // a hole
  EXPECT_EQ(config_error([&] { read_mesh_vertices(huge); }).expected(), "at most 32 MiB");
  std::string many_triangles = binary_stl({});
  many_triangles.replace(80, 4, "\xff\xff\xff\xff");
  EXPECT_EQ(config_error([&] { read_mesh_vertices(write("declared.stl", many_triangles)); }).expected(),
            "a whole STL mesh");
  std::string many;
  for (std::size_t i = 0; i <= kMeshBudget.values; ++i) many += "v 1 1 1\n";
  EXPECT_EQ(config_error([&] { read_mesh_vertices(write("many.obj", many)); }).expected(),
            "at most 2000000 vertices");
}

/// An environment variable for as long as this lives.
class SetVariable {
 public:
  SetVariable(const char* name, const std::string& value) : name_(name) { ::setenv(name, value.c_str(), 1); }
  ~SetVariable() { ::unsetenv(name_); }
  SetVariable(const SetVariable&) = delete;
  SetVariable& operator=(const SetVariable&) = delete;

 private:
  const char* name_;
};

TEST_F(MeshFiles, AreFoundFromTheUrdfUpwards) {
  for (const char* folder : {"share/dog/urdf", "share/dog/meshes", "share/cat/meshes"}) {
    std::filesystem::create_directories(folder_ / folder);
  }
  const std::string urdf = path("share/dog/urdf/robot.urdf");
  const std::string shin = write("share/dog/meshes/shin.stl", "1"),
                    tail = write("share/cat/meshes/tail.stl", "1");
  const std::string beside = write("share/dog/urdf/foot.stl", "1");
  const auto finds = [&](const std::string& name, const std::string& file) {
    EXPECT_EQ(find_named_file(name, urdf).value_or("none"), file) << name;
  };
  finds("package://dog/meshes/shin.stl", shin);
  finds("model://renamed/meshes/shin.stl", shin);
  finds("package://cat/meshes/tail.stl", tail);
  finds("../meshes/shin.stl", shin);
  finds("meshes/shin.stl", shin);
  finds("foot.stl", beside);
  finds("file://" + tail, tail);
  finds(tail, tail);
  for (const char* none : {"package://cat/meshes/shin.stl/", "package://cat", "meshes", "",
                           "/meshes/shin.stl", "package://dog/none.stl", "http://dog/meshes/shin.stl"}) {
    finds(none, "none");
  }
  finds(std::string(100000, 'a') + ".stl", "none");
  // URIs: one slash is enough of an absolute one, escapes are undone, and ".." leaves a package.
  finds("file:" + tail, tail);
  const std::string blank = write("share/dog/meshes/left shin (1).stl", "1"),
                    percent = write("share/dog/meshes/100%25.stl", "1");
  finds("package://dog/meshes/left%20shin%20(1).stl", blank);
  finds("file://" + path("share/dog/meshes/left%20shin%20%281%29.stl"), blank);
  finds("meshes/left%20shin%20(1).stl", "none");  // no URI
  finds("meshes/100%25.stl", percent);
  finds("package://dog/meshes/100%25.stl", percent);
  finds("package://dog/meshes/shin.stl%00.stl", "none");
  finds("package://dog/meshes/shin.stl%", "none");
  finds("package://no_package/../meshes/shin.stl", shin);
  finds("package://dog/../cat/meshes/tail.stl", tail);
}

TEST_F(MeshFiles, AreFoundThroughTheEnvironment) {
  for (const char* folder : {"urdf", "ros/cat", "own/cat"})
    std::filesystem::create_directories(folder_ / folder);
  const std::string ros = write("ros/cat/tail.stl", "1"), own = write("own/cat/tail.stl", "1");
  const auto found = [&] {
    return find_named_file("package://cat/tail.stl", path("urdf/robot.urdf")).value_or("none");
  };
  EXPECT_EQ(found(), "none");
  const SetVariable of_ros("ROS_PACKAGE_PATH", ":/nowhere::" + path("ros/cat"));  // the package's own folder
  EXPECT_EQ(found(), ros);
  const SetVariable of_crossgait("CROSSGAIT_PACKAGE_PATH", path("own"));
  EXPECT_EQ(found(), own);
}

}  // namespace
}  // namespace crossgait
