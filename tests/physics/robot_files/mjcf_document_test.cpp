// MJCF files and what they include, before any compiler sees them.
#include "physics/robot_files/mjcf/mjcf_document.h"

#include <filesystem>

#include <fmt/format.h>

#include "physics/core/read_budget.h"
#include "physics/robot_files/mjcf/mjcf_parts.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"

namespace crossgait {
namespace {

class MjcfFiles : public ScratchFolder {
 protected:
  ConfigError refusal(const std::string& text) const {
    const std::string file = write("robot.xml", text);
    return config_error([&] { MjcfDocument document(file); });
  }
  MjcfDocument document(const std::string& text) const { return MjcfDocument(write("robot.xml", text)); }
};

TEST_F(MjcfFiles, IncludesStandWhereTheyAreIncluded) {
  std::filesystem::create_directories(path("parts"));
  write("parts/legs.xml", "<mujocoinclude>\n<body name='b'/><include file='feet.xml'/></mujocoinclude>");
  write("parts/feet.xml", "<mujoco><geom name='f'/></mujoco>");
  MjcfDocument robot = document(
      "<mujoco model='m'>\n<worldbody><body name='a'/><include file='parts/legs.xml'/><body name='c'/>"
      "</worldbody></mujoco>");
  ASSERT_EQ(robot.root().children.size(), 1U);
  std::string order;
  for (const MjcfElement& e : robot.root().children[0].children) order += std::string(e.attribute("name"));
  EXPECT_EQ(order, "abfc");
  EXPECT_EQ(mjcf_place(robot.root().children[0].children[1], robot.path()), "body 'b' (line 2 of legs.xml)");
  EXPECT_EQ(mjcf_place(robot.root().children[0], robot.path()), "worldbody (line 2)");
}

TEST_F(MjcfFiles, ThePrintHasALineForEveryElement) {
  MjcfDocument robot = document("<mujoco><a x='1 &lt; \"2\"\n3'><b/></a><c/></mujoco>");
  const MjcfPrint print = robot.print();
  EXPECT_EQ(print.xml, "<mujoco>\n<a x=\"1 &lt; &quot;2&quot;&#x0A;3\">\n<b/>\n</a>\n<c/>\n</mujoco>\n");
  std::string tags;
  for (const MjcfElement* e : print.lines) tags += e->tag + " ";
  EXPECT_EQ(tags, "mujoco a b a c mujoco ");
}

TEST_F(MjcfFiles, WhatCannotBeReadIsRefusedByLine) {
  EXPECT_EQ(refusal("<mujoco><a></mujoco>").expected(), "well-formed XML");
  EXPECT_EQ(refusal("<robot name='r'/>").found(), "<robot>, as a URDF has it: its name has to end in .urdf");
  EXPECT_EQ(refusal("<wings/>").found(), "<wings>");
  EXPECT_EQ(refusal("").found(), "Error document empty.");
  EXPECT_EQ(refusal("<mujoco>\n<include file='no.xml'/></mujoco>").source(), path("no.xml"));
  EXPECT_EQ(refusal("<mujoco>\n<include file='/etc/passwd'/></mujoco>").element(), "line 2, include");
  EXPECT_EQ(refusal("<mujoco>\n<include/></mujoco>").found(), "''");
}

TEST_F(MjcfFiles, AFileIsIncludedOnce) {
  EXPECT_EQ(refusal("<mujoco>\n<include file='robot.xml'/></mujoco>").expected(), "each file once");
  write("a.xml", "<mujocoinclude><include file='./b.xml'/></mujocoinclude>");
  write("b.xml", "<mujocoinclude><include file='a.xml'/></mujocoinclude>");
  const ConfigError error = refusal("<mujoco><include file='a.xml'/></mujoco>");
  EXPECT_EQ(error.source(), path("b.xml"));
  EXPECT_NE(error.found().find("a.xml' again"), std::string::npos);
}

TEST_F(MjcfFiles, TheBudgetIsThatOfAllFilesTogether) {
  std::string many;
  for (int i = 0; i < 4'000; ++i) many += "<a/>";
  write("one.xml", "<mujoco>" + many + "</mujoco>");
  write("two.xml", "<mujoco>" + many + "</mujoco>");
  EXPECT_NO_THROW(document("<mujoco><include file='one.xml'/></mujoco>"));
  EXPECT_EQ(refusal("<mujoco><include file='one.xml'/><include file='two.xml'/></mujoco>").expected(),
            "at most 6000 elements");
  std::string deep = "<mujoco>", end = "</mujoco>";
  for (int i = 0; i < 40; ++i) {
    deep += "<a>";
    end = "</a>" + end;
  }
  write("deep.xml", deep + end);
  EXPECT_NO_THROW(document("<mujoco><include file='deep.xml'/></mujoco>"));
  write("deeper.xml", deep + "<include file='deep.xml'/>" + end);
  EXPECT_EQ(refusal("<mujoco><include file='deeper.xml'/></mujoco>").found(), "more");
  std::string includes;
  for (std::size_t i = 0; i < kMaxMjcfFiles; ++i) {
    write(fmt::format("{}.xml", i), "<mujoco/>");
    includes += fmt::format("<include file='{}.xml'/>", i);
  }
  EXPECT_EQ(refusal("<mujoco>" + includes + "</mujoco>").expected(), "at most 100 files");
}

TEST_F(MjcfFiles, EveryPartHasANameOfItsOwn) {
  MjcfDocument robot = document(
      "<mujoco><worldbody><body><freejoint/><geom/><geom name='world_body_0_geom_0'/>"
      "<body name='leg'><joint/><geom/></body></body></worldbody></mujoco>");
  ReaderWarnings warnings;
  const MjcfParts parts = take_parts(robot, warnings);
  for (const auto& [tag, name] :
       std::vector<std::pair<std::string, std::string>>{{"body", "world_body_0"},
                                                        {"joint", "world_body_0_joint"},
                                                        {"geom", "world_body_0_geom_1"},
                                                        {"geom", "world_body_0_geom_0"},
                                                        {"body", "leg"},
                                                        {"joint", "leg_joint"},
                                                        {"geom", "leg_geom_0"}})
    EXPECT_TRUE(parts.with_names.contains({tag, name})) << tag << " " << name;
  EXPECT_EQ(parts.with_names.size(), 7U);
}

TEST_F(MjcfFiles, OnlyWhatMakesARobotIsLeft) {
  MjcfDocument robot = document(
      "<mujoco><compiler meshdir='m' angle='radian'/><option/><size njmax='999999999'/><visual/>"
      "<asset><texture name='t' file='t.png'/><material name='m' texture='t'/></asset>"
      "<worldbody><body name='b'><site/><wings/></body></worldbody><sensor><gyro/></sensor></mujoco>");
  ReaderWarnings warnings;
  (void)take_parts(robot, warnings);
  const std::string xml = robot.print().xml;
  for (const char* gone : {"meshdir", "option", "size", "visual", "texture", "site", "sensor"})
    EXPECT_EQ(xml.find(gone), std::string::npos) << gone;
  for (const char* kept : {"autolimits=\"true\"", "angle=\"radian\"", "<material name=\"m\"/>"})
    EXPECT_NE(xml.find(kept), std::string::npos) << kept;
  EXPECT_EQ(warnings.sentences().size(), 2U);
}

TEST_F(MjcfFiles, MeshesOfAClassHaveItsScale) {
  MjcfDocument robot = document(
      "<mujoco><default><mesh scale='2 2 2'/><default class='a'><mesh scale='3 3 3'/><default "
      "class='b'/></default>"
      "<default class='c'/></default><asset><mesh file='x/one.stl'/><mesh name='two' class='b' "
      "file='two.stl'/>"
      "<mesh name='three' class='c' file='c.stl'/><mesh name='four' class='a' file='d.stl' scale='1 -1 1'/>"
      "</asset></mujoco>");
  ReaderWarnings warnings;
  const MjcfParts parts = take_parts(robot, warnings);
  EXPECT_EQ(parts.meshes.at("one").scale, Vector3(2, 2, 2));
  EXPECT_EQ(parts.meshes.at("two").scale, Vector3(3, 3, 3));
  EXPECT_EQ(parts.meshes.at("three").scale, Vector3(2, 2, 2));
  EXPECT_EQ(parts.meshes.at("four").scale, Vector3(1, -1, 1));
}

}  // namespace
}  // namespace crossgait
