#include "physics/robot_files/mesh/dae_reader.h"

#include <algorithm>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"

namespace crossgait {
namespace {

class DaeFiles : public ScratchFolder {
 protected:
  TriangleMesh read(const std::string& text) { return read_dae(write("a.dae", text)); }
};

/// A square of four corners with normals between them, and what its primitive is.
std::string dae(const std::string& primitive, const std::string& scene = "", const std::string& asset = "") {
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<COLLADA version=\"1.4.1\"><asset>{}<up_axis>Y_UP</up_axis></asset>\n"
      "<library_geometries><geometry id=\"g\"><mesh>"
      "<source id=\"p\"><float_array count=\"12\">0 0 0 1 0 0\n1 2 0 0 2 0</float_array><technique_common>"
      "<accessor source=\"#pa\" count=\"4\" stride=\"3\"/></technique_common></source>"
      "<source id=\"n\"><float_array>0 0 1</float_array></source>"
      "<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>\n{}"
      "</mesh></geometry></library_geometries>\n{}</COLLADA>",
      asset, primitive, scene);
}

constexpr const char* kInputs =
    "<input semantic=\"NORMAL\" source=\"#n\" offset=\"0\"/><input semantic=\"VERTEX\" source=\"#v\" "
    "offset=\"1\"/>";
const std::string kTriangles =
    fmt::format("<triangles count=\"2\">{}<p>0 0 0 1 0 2 0 0 0 2 0 3</p></triangles>", kInputs);

std::string scene(const std::string& nodes) {
  return "<library_visual_scenes><visual_scene id=\"s\">" + nodes +
         "</visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene>";
}

using Numbers = std::vector<std::uint32_t>;

/// Every primitive of the same square: its corners are the file's, in its axes, whatever is up.
TEST_F(DaeFiles, HavePolygonsOfEveryKind) {
  const Numbers fan{0, 1, 2, 0, 2, 3};
  const std::vector<Vector3> corners{{0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {0, 2, 0}};
  for (const std::string& primitive :
       {kTriangles,
        fmt::format("<polylist count=\"1\">{}<vcount>4</vcount><p>0 0 0 1 0 2 0 3</p></polylist>", kInputs),
        fmt::format("<polygons count=\"1\">{}<p>0 0 0 1 0 2 0 3</p></polygons>", kInputs),
        fmt::format("<trifans>{}<p>0 0 0 1 0 2 0 3</p></trifans>", kInputs)}) {
    const TriangleMesh mesh = read(dae("<lines count=\"1\"><p>7 7</p></lines>" + primitive));
    EXPECT_EQ(mesh.vertices, corners) << primitive;
    EXPECT_EQ(mesh.triangles, fan) << primitive;
  }
  const TriangleMesh strip =
      read(dae(fmt::format("<tristrips>{}<p>0 0 0 1 0 3 0 2</p></tristrips>", kInputs)));
  EXPECT_EQ(strip.triangles, (Numbers{0, 1, 3, 1, 2, 3}));
}

TEST_F(DaeFiles, ArePutWhereNodesSay) {
  // A quarter turn about z, then 1 along x, of what is twice as large; again in a node of its own; in
  // centimetres.
  const std::string text =
      dae(kTriangles,
          "<library_nodes><node id=\"part\"><matrix>1 0 0 0 0 1 0 0 0 0 1 50 0 0 0 1</matrix>"
          "<instance_geometry url=\"#g\"/></node></library_nodes>" +
              scene("<node><translate>100 0 0</translate><rotate>0 0 1 90</rotate><scale>2 2 2</scale>"
                    "<instance_geometry url=\"#g\"/><node><instance_node url=\"#part\"/></node></node>"),
          "<unit name=\"centimetre\" meter=\"0.01\"/>");
  const TriangleMesh mesh = read(text);
  ASSERT_EQ(mesh.vertices.size(), 8U);
  EXPECT_EQ(mesh.triangles.size(), 12U);
  EXPECT_LT((mesh.vertices[0] - Vector3(1, 0, 0)).norm(), 1e-15);
  EXPECT_LT((mesh.vertices[2] - Vector3(0.96, 0.02, 0)).norm(), 1e-15);  // (1, 2, 0) turned and doubled
  EXPECT_LT((mesh.vertices[6] - Vector3(0.96, 0.02, 1)).norm(), 1e-15);
  std::vector<Vector3> sorted = mesh.vertices;
  EXPECT_EQ(read_mesh_vertices(write("b.DAE", text)).size(), sorted.size());
  EXPECT_EQ(read_mesh_triangles(write("b.DAE", text)).triangles, mesh.triangles);
}

// A triangle of the square, whose fourth corner no face has.
TEST_F(DaeFiles, AreTheVerticesOfTheirFaces) {
  const std::string file =
      write("a.dae", dae(fmt::format("<triangles>{}<p>0 0 0 1 0 2</p></triangles>", kInputs)));
  EXPECT_EQ(read_mesh_vertices(file), (std::vector<Vector3>{{0, 0, 0}, {1, 0, 0}, {1, 2, 0}}));
}

TEST_F(DaeFiles, AreReadInPart) {
  const std::string shown = scene(
      "<node name=\"arm\"><translate>1 0 0</translate><node id=\"hand\"><translate>0 1 0</translate>"
      "<instance_geometry url=\"#g\"/></node></node>"
      "<node name=\"tail\"><translate>7 0 0</translate><instance_geometry url=\"#g\"/></node>");
  const std::string file = write("a.dae", dae(kTriangles, shown));
  const auto first = [&](const std::string& part) { return read_mesh_vertices(file, part).front(); };
  EXPECT_EQ(first("hand"), Vector3(1, 1, 0));
  EXPECT_EQ(first("arm"), Vector3(1, 1, 0)) << "with all that is in it";
  EXPECT_EQ(first("tail"), Vector3(7, 0, 0));
  EXPECT_EQ(read_mesh_vertices(file, "tail").size(), 4U);
  EXPECT_EQ(read_mesh_vertices(file, "g").size(), 8U) << "a geometry, wherever it is shown";
  EXPECT_EQ(first("g"), Vector3(1, 1, 0));
  const ConfigError error = config_error([&] { first("leg"); });
  EXPECT_EQ(error.source(), file);
  EXPECT_EQ(error.expected(), "faces of a part named 'leg'");
  EXPECT_EQ(error.found(), "'arm', 'hand', 'tail'");
}

TEST_F(DaeFiles, NameWhatIsWrong) {
  const auto error = [&](const std::string& text) {
    const ConfigError e = config_error([&] { read(text); });
    EXPECT_EQ(e.source(), path("a.dae"));
    return fmt::format("{}: {}, {}", e.element(), e.expected(), e.found());
  };
  EXPECT_EQ(error("<mesh/>"), "file: a <COLLADA> element, <mesh>");
  EXPECT_EQ(error("<COLLADA/>"), "file: whole triangles, none");
  EXPECT_EQ(error(dae(fmt::format("<triangles>{}<p>0 0 0 1 0 4</p></triangles>", kInputs))),
            "line 5, p: numbers of the 4 vertices, 4");
  EXPECT_EQ(error(dae(fmt::format("<triangles>{}<p>0 0 0 1</p></triangles>", kInputs))),
            "line 5, p: whole triangles, 2 corners");
  EXPECT_EQ(error(dae(fmt::format("<triangles>{}<p>0 0 0 -1 0 1</p></triangles>", kInputs))),
            "line 5, p: whole numbers from 0 on, '-1'");
  EXPECT_EQ(error(dae(fmt::format("<polylist>{}<vcount>5</vcount><p>0 0 0 1 0 2</p></polylist>", kInputs))),
            "line 5, p: as many corners as <vcount> says, fewer");
  EXPECT_EQ(error(dae("<triangles><p>0 1 2</p></triangles>")),
            "line 5, triangles: an input of vertices, none");
  EXPECT_EQ(error(dae(kTriangles, scene("<node><instance_geometry url=\"#h\"/></node>"))),
            "line 6, instance_geometry: url of an element of this file, '#h'");
  EXPECT_EQ(error(dae(kTriangles, scene("<node><scale>1 1</scale></node>"))),
            "line 6, scale: 3 numbers, '2'");
  EXPECT_EQ(error(dae(kTriangles, scene("<node id=\"o\"><instance_node url=\"#o\"/></node>"))),
            "line 6, node: at most 32 levels of nodes, more");
  EXPECT_EQ(error(dae(kTriangles, scene("<node><instance_controller url=\"#c\"/></node>"))),
            "line 6, instance_controller: geometry that is no skin, an instance of a controller");
  EXPECT_EQ(error(dae(kTriangles, "", "<unit meter=\"0\"/>")), "line 2, unit: metres, a number above 0, '0'");
}

}  // namespace
}  // namespace crossgait
