// Grounds of scenes, where geometry says what the heights are.
#include "study/scene_terrain.h"

#include <cmath>
#include <cstring>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "backends/registry.h"
#include "physics/core/text.h"
#include "physics/terrain/terrain.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"

namespace crossgait {
namespace {

/// Heights are floats, of which the field drops the last bits.
constexpr double kRounding = 1e-6;

class Scenes : public ScratchFolder {
 protected:
  void SetUp() override {
    ScratchFolder::SetUp();
    if (!compiles_mjcf()) GTEST_SKIP() << "no available engine compiles MJCF";
  }
  SceneTerrain read(const std::string& world, double cell = 0.1, const std::string& before = "") const {
    return read_scene_terrain(
        write("scene.xml", fmt::format("<mujoco>{}<worldbody>{}</worldbody></mujoco>", before, world)), cell);
  }
};

constexpr const char* kPlane = "<geom type='plane' size='0 0 1'/>";

TEST_F(Scenes, BoxesStandOnThePlane) {
  const SceneTerrain scene =
      read(std::string(kPlane) +
           "<geom type='box' size='.2 .1 .05' pos='.3 0 .05'/>"
           "<body pos='-.3 0 0' quat='0 0 0 1'><geom type='box' size='.1 .1 .2'/></body>");
  const HeightField& field = *scene.field;
  EXPECT_EQ(field.columns(), 11);  // as far as the box does, the same both ways: +-0.5 m
  EXPECT_EQ(field.rows(), 3);
  EXPECT_NEAR(field.size_x(), 1, kRounding);
  EXPECT_NEAR(field.height(0.3, 0), 0.1, kRounding);
  EXPECT_NEAR(field.height(0.5, 0.1), 0.1, kRounding) << "its border is on it";
  EXPECT_NEAR(field.height(0, 0), 0, kRounding);
  EXPECT_NEAR(field.height(-0.3, 0), 0.2, kRounding);
  EXPECT_NEAR(field.height(-0.5, 0), 0, kRounding);
  EXPECT_EQ(scene.overhang_ratio, 0);
  EXPECT_TRUE(scene.warnings.empty()) << scene.warnings.front();
}

/// The field's own truth is that of spheres, cylinders and planes.
TEST_F(Scenes, RoundAndTiltedShapesAreAsHighAsGeometrySays) {
  const HeightField dome = *read(std::string(kPlane) + "<geom type='sphere' size='.5'/>").field;
  const HeightField log =
      *read(std::string(kPlane) + "<geom type='capsule' size='.2' fromto='-.5 0 0 .5 0 0'/>").field;
  const HeightField ramp =
      *read(
           "<geom type='plane' size='1 1 1' euler='0 -20 0'/><geom type='box' size='.5 .5 .01' "
           "pos='0 0 -9'/>")
           .field;
  const HeightField tilted = *read("<geom type='box' size='1 .3 .1' euler='0 -20 0'/>", 0.05).field;
  const double slope = std::tan(20 * std::numbers::pi / 180), cosine = std::cos(20 * std::numbers::pi / 180);
  for (int i = -4; i <= 4; ++i) {
    const double x = 0.1 * i;
    EXPECT_NEAR(dome.height(x, 0.1), std::sqrt(0.25 - x * x - 0.01), kRounding) << x;
    EXPECT_NEAR(log.height(x, 0.1), std::sqrt(0.04 - 0.01), kRounding) << x;
    EXPECT_NEAR(ramp.height(x, 0.2), slope * x, kRounding) << x;
    EXPECT_NEAR(tilted.height(x, 0.2), slope * x + 0.1 / cosine, kRounding) << x;
  }
  EXPECT_NEAR(log.height(0.6, 0), std::sqrt(0.04 - 0.01), kRounding) << "the ends are round";
  EXPECT_NEAR(dome.height(0.5, 0.5), 0, kRounding);
}

TEST_F(Scenes, MeshesAreTheirHulls) {
  const HeightField roof =
      *read(std::string(kPlane) + "<body pos='0 0 1'><geom type='mesh' mesh='roof'/></body>", 0.1,
            "<compiler inertiafromgeom='false'/><asset><mesh name='roof' vertex='-1 -1 0 -1 1 0 1 -1 0 1 1 0 "
            "0 -1 1 0 1 1'/>"
            "</asset>")
           .field;
  // Of a mesh without a file the compiler moves the vertices to its own axes, and the geom with them.
  EXPECT_NEAR(roof.height(0, 0.2), 2, 1e-5);
  EXPECT_NEAR(roof.height(0.5, 0.2), 1.5, 1e-5);
}

TEST_F(Scenes, HeightFieldsLieWhereTheyAre) {
  const std::string asset =
      "<asset><hfield name='h' nrow='2' ncol='3' size='.2 .1 .5 .1' elevation='0 0 10  0 5 10'/></asset>";
  const HeightField field = *read("<geom type='hfield' hfield='h' pos='0 0 .25'/>", 0.1, asset).field;
  ASSERT_EQ(field.columns(), 5);
  ASSERT_EQ(field.rows(), 3);
  EXPECT_NEAR(field.height(0.2, 0.1), 0.75, kRounding) << "the largest elevation, at the upper right";
  EXPECT_NEAR(field.height(-0.2, -0.1), 0.25, kRounding);
  EXPECT_NEAR(field.height(0, -0.1), 0.5, kRounding) << "the last row of the text has the least y";
  EXPECT_NEAR(field.height(0, 0.1), 0.25, kRounding);
}

/// Of MuJoCo's own format: rows, columns, floats, the row of the least y first.
std::string binary_field(std::int32_t rows, std::int32_t columns, const std::vector<float>& heights) {
  std::string bytes(sizeof rows + sizeof columns + heights.size() * sizeof(float), 0);
  std::memcpy(bytes.data(), &rows, sizeof rows);
  std::memcpy(bytes.data() + sizeof rows, &columns, sizeof columns);
  std::memcpy(bytes.data() + sizeof rows + sizeof columns, heights.data(), heights.size() * sizeof(float));
  return bytes;
}
constexpr const char* kFieldOfFile = "<asset><hfield name='h' file='h.bin' size='.2 .1 .5 .1'/></asset>";
constexpr const char* kFieldGeom = "<geom type='hfield' hfield='h' pos='0 0 .25'/>";

TEST_F(Scenes, BinaryHeightFieldsAreReadRowByRowFromTheLeastY) {
  write("h.bin", binary_field(2, 3, {0, 5, 10, 0, 0, 10}));
  const HeightField field = *read(kFieldGeom, 0.1, kFieldOfFile).field;
  ASSERT_EQ(field.columns(), 5);
  ASSERT_EQ(field.rows(), 3);
  EXPECT_NEAR(field.height(0.2, 0.1), 0.75, kRounding);
  EXPECT_NEAR(field.height(0, -0.1), 0.5, kRounding);
  EXPECT_NEAR(field.height(0, 0.1), 0.25, kRounding);
}

TEST_F(Scenes, BinaryHeightFieldsThatAreNoneAreRefusedByName) {
  const auto refused = [&](const std::string& bytes) {
    const std::string file = write("h.bin", bytes);
    const ConfigError error = config_error([&] { (void)read(kFieldGeom, 0.1, kFieldOfFile); });
    EXPECT_EQ(error.source(), file);
    return error.expected();
  };
  EXPECT_EQ(refused("short"), "a height field of MuJoCo's: rows, columns, floats");
  EXPECT_EQ(refused(binary_field(2, 3, {0, 1, 2})), "32 bytes for 2 x 3 floats");
  EXPECT_EQ(refused(binary_field(2, 2, {0, 1, 2, NAN})), "finite numbers");
  for (const auto& [rows, columns] : {std::pair(-1, 3), {2, 1 << 30}, {0, 0}, {1, 8}})
    EXPECT_EQ(refused(binary_field(rows, columns, {0, 1})), "2 to 4096 of each");
}

/// A world of SDF: one static model of these collisions at x = 1, turned by half a turn about z.
class SdfGrounds : public ScratchFolder {
 protected:
  SceneTerrain read(const std::string& shapes, const std::string& model = "<static>1</static>") const {
    std::string collisions;
    for (const std::string_view shape : parts_of(shapes, "|"))
      collisions += fmt::format("<collision name='c{}'>{}</collision>", collisions.size(), shape);
    return read_scene_terrain(
        write(
            "scene.sdf",
            fmt::format("<sdf version='1.9'><world name='w'><model name='ground'>{}<pose>1 0 0 0 0 {}</pose>"
                        "<link name='l'>{}</link></model></world></sdf>",
                        model, std::numbers::pi, collisions)),
        0.1);
  }
};

TEST_F(SdfGrounds, ShapesStandWhereTheirModelIs) {
  const SceneTerrain scene = read(
      "<geometry><plane><normal>0 0 1</normal></plane></geometry>|"
      "<pose>.5 0 .1 0 0 0</pose><geometry><box><size>.4 .4 .2</size></box></geometry>|"
      "<geometry><polyline/></geometry>");
  EXPECT_NEAR(scene.field->height(0.5, 0), 0.2, kRounding) << "half a turn about x = 1";
  EXPECT_NEAR(scene.field->height(0, 0), 0, kRounding);
  ASSERT_EQ(scene.warnings.size(), 1U);
  EXPECT_TRUE(scene.warnings[0].starts_with("left out 1 collision(s) that are no plane"))
      << scene.warnings[0];
}

TEST_F(SdfGrounds, HeightMapsReachFromBlackToTheLightest) {
  // 2 x 2: white at the upper right, black else.
  write_png(HeightField(2, 2, 1, 1, {0, 0, 0, 0.05F}), path("map.png"));
  const SceneTerrain scene = read(
      "<geometry><heightmap><uri>map.png</uri><size>2 2 3</size><pos>0 0 1</pos></heightmap></geometry>");
  // The model's half turn takes the upper right to the lower left, around x = 1.
  EXPECT_NEAR(scene.field->height(0, -1), 4, kRounding);
  EXPECT_NEAR(scene.field->height(2, 1), 1, kRounding);
  EXPECT_NEAR(scene.field->height(1, 0), 2.5, 1e-3) << "on the diagonal, but for the picture's steps of grey";
}

TEST_F(SdfGrounds, WhatIsNoGroundIsRefusedOrLeftOut) {
  const auto refused = [&](const std::string& shapes) {
    return config_error([&] { (void)read(shapes); }).expected();
  };
  EXPECT_EQ(refused("<geometry><heightmap><uri>gone.png</uri></heightmap></geometry>"),
            "a file that is there");
  write("map.tif", "any");
  EXPECT_EQ(refused("<geometry><heightmap><uri>map.tif</uri></heightmap></geometry>"), "a height map as PNG");
  std::string many;
  for (int i = 0; i < 30; ++i)
    many += "<geometry><box><size>400 400 1</size></box></geometry>|";  // each over 4001 x 4001 samples
  EXPECT_EQ(refused(many + "<geometry/>"), "at most 2e+07 samples under shapes together, so larger cells");
  EXPECT_EQ(refused("<geometry><sphere><radius>-1</radius></sphere></geometry>"), "a number above 0");
  EXPECT_EQ(refused("<geometry><plane><normal>0 0 -1</normal></plane></geometry>"),
            "a plane that faces upwards");
  EXPECT_EQ(refused("<geometry><plane><normal>0 0 1</normal></plane></geometry>"),
            "shapes that are fixed to the world, beside a plane");
  EXPECT_THROW((void)read("<geometry><sphere><radius>1</radius></sphere></geometry>", ""), ConfigError)
      << "a model that falls is no ground";
}

TEST_F(Scenes, OverhangsAreSaidWithTheirShare) {
  const SceneTerrain table =
      read(std::string(kPlane) + "<geom type='box' size='.5 .5 .05' pos='0 0 .5'/>", 0.25);
  EXPECT_NEAR(table.field->height(0, 0), 0.55, kRounding);
  EXPECT_EQ(table.overhang_ratio, 1);
  ASSERT_EQ(table.warnings.size(), 1U);
  EXPECT_TRUE(table.warnings[0].starts_with("100 % of the samples overhang")) << table.warnings[0];
  const SceneTerrain stack = read(std::string(kPlane) +
                                  "<geom type='box' size='.5 .5 .05' pos='0 0 .05'/>"
                                  "<geom type='box' size='.2 .2 .05' pos='0 0 .15'/>");
  EXPECT_EQ(stack.overhang_ratio, 0);
  EXPECT_NEAR(stack.field->height(0, 0), 0.2, kRounding);
}

TEST_F(Scenes, RobotsAndVisualShapesAreNoGround) {
  const SceneTerrain scene =
      read(std::string(kPlane) +
           "<geom type='box' size='.2 .2 .05'/><geom type='box' size='1 1 1' contype='0' conaffinity='0'/>"
           "<body pos='0 0 1'><freejoint/><geom size='.1'/><body><joint/><geom size='.1'/></body></body>"
           "<body pos='0 0 1'><geom size='.1'/><body><joint/><geom size='.1'/></body></body>");
  EXPECT_NEAR(scene.field->max(), 0.05, kRounding);
  EXPECT_EQ(scene.field->columns(), 5);
}

TEST_F(Scenes, WhatIsNoHeightFieldIsRefused) {
  const auto expected = [&](const std::string& world, double cell = 0.1, const std::string& before = "") {
    return config_error([&] { read(world, cell, before); }).expected();
  };
  EXPECT_EQ(expected(kPlane), "shapes that are fixed to the world, beside a plane");
  EXPECT_EQ(expected("<geom type='plane' size='1 1 1' euler='180 0 0'/>"), "a plane that faces upwards");
  EXPECT_TRUE(expected("<geom type='box' size='1000 1000 1'/>", 1e-3).starts_with("at most"));
  const std::string asset =
      "<asset><hfield name='h' nrow='2' ncol='2' size='.2 .1 .5 .1' elevation='0 0 1 1'/></asset>";
  EXPECT_EQ(expected("<geom type='hfield' hfield='h' euler='10 0 0'/>", 0.1, asset),
            "a height field that lies level");
  EXPECT_EQ(expected("<geom type='hfield' hfield='g'/>", 0.1, asset), "a height field of <asset>");
}

TEST_F(Scenes, WhatHasNothingBelowIsAsHighAsTheLowest) {
  const SceneTerrain scene =
      read("<geom type='box' size='.1 .1 .3'/><geom type='box' size='.1 .1 .1' pos='.5 0 0'/>");
  EXPECT_NEAR(scene.field->height(-0.5, 0), 0.1, kRounding);
  ASSERT_EQ(scene.warnings.size(), 1U);
  EXPECT_NE(scene.warnings[0].find("nothing below them"), std::string::npos);
}

}  // namespace
}  // namespace crossgait
