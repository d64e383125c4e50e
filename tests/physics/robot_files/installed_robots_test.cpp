// Robots by name, in folders that the environment lists.
#include "physics/robot_files/installed_robots.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

#include "tests/physics/core/scratch_folder.h"

namespace crossgait {
namespace {

namespace fs = std::filesystem;

class InstalledRobots : public ScratchFolder {
 protected:
  void SetUp() override {
    ScratchFolder::SetUp();
    setenv("CROSSGAIT_ROBOT_PATH", folder_.c_str(), 1);
  }
  void TearDown() override {
    unsetenv("CROSSGAIT_ROBOT_PATH");
    ScratchFolder::TearDown();
  }

  void add(const std::string& file, const std::string& text) const {
    fs::create_directories(fs::path(path(file)).parent_path());
    write(file, text);
  }
  /// The names of those that are in the folder, in order.
  std::vector<std::string> names() const {
    std::vector<std::string> found;
    for (const InstalledRobot& robot : installed_robots())
      if (robot.from == folder_) found.push_back(robot.name);
    return found;
  }
};

TEST_F(InstalledRobots, AreOfEveryFormatAndNeitherPartsNorScenes) {
  add("a.urdf", "<robot/>");
  add("b.xml", "<mujoco><worldbody><body/></worldbody></mujoco>");
  add("c.mjcf", "<mujoco><worldbody><body/></worldbody></mujoco>");
  add("scene.xml", "<mujoco><include file='b.xml'/><worldbody><body/></worldbody></mujoco>");
  add("package.xml", "<package/>");
  add("d.sdf", "<sdf version='1.9'><model name='d'/></sdf>");
  add("e.urdf.xacro", "<?xml version='1.0'?><robot xmlns:xacro='x' name='e'/>");
  add("macros.xacro", "<robot xmlns:xacro='x'><xacro:macro name='leg'/></robot>");
  EXPECT_EQ(names(), (std::vector<std::string>{"a", "b", "c", "d", "e"}));
}

TEST_F(InstalledRobots, AXacroIsTheLastOfThoseThatAreMeantAlike) {
  add("first/my_dog.urdf.xacro", "<robot name='d'/>");
  add("second/my_dog.urdf", "<robot/>");
  EXPECT_EQ(find_installed_robot("my_dog")->file, path("second/my_dog.urdf"));
  add("third/other_dog.urdf.xacro", "<robot name='d'/>");
  EXPECT_EQ(find_installed_robot("Other_Dog")->file, path("third/other_dog.urdf.xacro"));
  add("only_description/robot.sdf", "<sdf><model/></sdf>");
  EXPECT_EQ(find_installed_robot("only")->file, path("only_description/robot.sdf"));
}

}  // namespace
}  // namespace crossgait
