// What files that are dropped on a page are taken for.
#include "view/dropped_files.h"

#include <filesystem>

#include <gtest/gtest.h>

#include "physics/core/text.h"
#include "tests/physics/core/config_error.h"

namespace crossgait {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kUrdf = "<robot name='a'><link name='b'/></robot>";
constexpr std::string_view kScene = "<mujoco><include file='a.xml'/></mujoco>";
constexpr std::string_view kMjcf = "<mujoco><worldbody><body><freejoint/></body></worldbody></mujoco>";

std::string kept(const std::string& path) { return read_text_file(path, ReadBudget{kMebibyte}); }

TEST(DroppedFiles, ARobotIsTheOneFileOfARobot) {
  const ViewSubject robot = keep_dropped({{"go/meshes/base.stl", "solid"}, {"go/go.urdf", kUrdf}});
  EXPECT_TRUE(robot.robot.ends_with("/go/go.urdf")) << robot.robot;
  EXPECT_TRUE(robot.policy.empty());
  EXPECT_EQ(kept(robot.robot), kUrdf);
  EXPECT_EQ(kept(fs::path(robot.robot).parent_path() / "meshes/base.stl"), "solid");
}

TEST(DroppedFiles, AYamlNamesTheOthersAndScenesAreNoRobots) {
  EXPECT_TRUE(
      keep_dropped({{"a.urdf", kUrdf}, {"robot.yaml", "urdf: a.urdf"}}).robot.ends_with("/robot.yaml"));
  EXPECT_TRUE(keep_dropped({{"scene.xml", kScene}, {"a.xml", kMjcf}}).robot.ends_with("/a.xml"));
  EXPECT_TRUE(keep_dropped({{"a.urdf", kUrdf}, {"parts/b.urdf", kUrdf}}).robot.ends_with("/a.urdf"));
}

TEST(DroppedFiles, APolicyIsBesideItsEnvironment) {
  const ViewSubject walk = keep_dropped({{"walk/environment.yaml", "action: joints"},
                                         {"walk/walk.yaml", "kind: onnx"},
                                         {"walk/walk.onnx", "o"}});
  EXPECT_TRUE(walk.policy.ends_with("/walk/walk.yaml")) << walk.policy;
  EXPECT_TRUE(walk.environment.ends_with("/walk/environment.yaml"));
  EXPECT_TRUE(walk.robot.empty());
  EXPECT_TRUE(keep_dropped({{"environment.yaml", "a: 1"}, {"w.safetensors", "s"}, {"w.yaml", "y"}})
                  .policy.ends_with("/w.safetensors"));
}

TEST(DroppedFiles, AreThereAsLongAsTheSubject) {
  ViewSubject first = keep_dropped({{"a.urdf", kUrdf}});
  const std::string path = first.robot;
  ViewSubject second = first;
  first = {};
  EXPECT_TRUE(fs::exists(path));
  second = {};
  EXPECT_FALSE(fs::exists(path));
}

TEST(DroppedFiles, WhatIsNoRobotIsRefused) {
  const auto element = [](const std::vector<DroppedFile>& files) {
    return config_error([&] { keep_dropped(files); }).element();
  };
  EXPECT_EQ(element({}), "files");
  EXPECT_EQ(element(std::vector<DroppedFile>(kMostDroppedFiles + 1, {"a.urdf", kUrdf})), "files");
  EXPECT_EQ(element({{"environment.yaml", "a: 1"}}),
            "policy beside environment.yaml (NAME.safetensors or NAME.yaml)");
  EXPECT_EQ(element({{"a.urdf", kUrdf}, {"b.urdf.XACRO", kUrdf}}), "b.urdf.XACRO") << "runs code";
  EXPECT_NE(element({{"notes.txt", "a"}}).find("environment.yaml"), std::string::npos);
  EXPECT_EQ(config_error([] {
              keep_dropped({{"a.urdf", kUrdf}, {"b.urdf", kUrdf}});
            }).found(),
            "a.urdf, b.urdf");
}

// Whatever a client says, nothing is written beside the folder.
TEST(DroppedFiles, PathsLeadNowhereElse) {
  for (const char* path : {"", "/etc/a.urdf", "../a.urdf", "a/../../b.urdf", "a//b.urdf", "./a.urdf",
                           "a\\b.urdf", "a/b/c/d/e/f/g/h/i.urdf", "a\n.urdf", "folder/"})
    EXPECT_EQ(config_error([&] { keep_dropped({{path, kUrdf}}); }).element(), "path") << path;
  const std::string zero("a\0.urdf", 7);
  EXPECT_EQ(config_error([&] { keep_dropped({{zero, kUrdf}}); }).element(), "path");
}

}  // namespace
}  // namespace crossgait
