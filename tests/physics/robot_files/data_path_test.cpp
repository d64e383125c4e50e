#include "physics/robot_files/data_path.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "physics/core/error.h"

namespace crossgait {
namespace {

namespace fs = std::filesystem;

/// A folder of models with two robots and something that is none. No variable CROSSGAIT_DATA until a test
/// sets it.
class DataPath : public testing::Test {
 protected:
  void SetUp() override {
    unsetenv("CROSSGAIT_DATA");
    for (const char* robot : {"walker", "ant"}) {
      fs::create_directories(models_ / "robots" / robot);
      std::ofstream(models_ / "robots" / robot / "robot.yaml") << "name: " << robot << "\n";
    }
    fs::create_directories(models_ / "terrains");
  }
  void TearDown() override {
    unsetenv("CROSSGAIT_DATA");
    fs::remove_all(models_);
  }

  const fs::path models_ = fs::temp_directory_path() / ("crossgait_data_path_" + std::to_string(getpid()));
};

TEST_F(DataPath, TheSourceTreeIsBuiltIn) { EXPECT_EQ(models_dir(), CROSSGAIT_SOURCE_DIR "/models"); }

TEST_F(DataPath, TheEnvironmentComesFirst) {
  setenv("CROSSGAIT_DATA", models_.c_str(), 1);
  EXPECT_EQ(models_dir(), models_.string());
}

TEST_F(DataPath, AWrongEnvironmentIsAnErrorAndNotPassedOver) {
  setenv("CROSSGAIT_DATA", "/nonexistent", 1);
  try {
    models_dir();
    FAIL() << "no error";
  } catch (const ConfigError& e) {
    EXPECT_EQ(e.element(), "CROSSGAIT_DATA");
    EXPECT_EQ(e.found(), "'/nonexistent'");
  }
}

TEST_F(DataPath, NoFolderAtAllIsAnErrorThatNamesWhatWasTried) {
  try {
    models_dir("/nonexistent");
    FAIL() << "no error";
  } catch (const ConfigError& e) {
    EXPECT_NE(e.expected().find("/nonexistent"), std::string::npos) << e.what();
    EXPECT_NE(e.expected().find("CROSSGAIT_DATA"), std::string::npos) << e.what();
  }
}

TEST_F(DataPath, RobotsAreTheFoldersWithARobotFile) {
  EXPECT_EQ(robot_names(models_.string()), (std::vector<std::string>{"ant", "walker"}));
}

TEST_F(DataPath, ANameIsARobotAndAFileIsItself) {
  EXPECT_EQ(find_robot("ant", models_.string()), (models_ / "robots" / "ant" / "robot.yaml").string());
  EXPECT_EQ(find_robot("some/where.urdf", models_.string()), "some/where.urdf");
  EXPECT_EQ(find_robot("ant.yaml", models_.string()), "ant.yaml");
  EXPECT_EQ(find_robot("ant.urdf.xacro", models_.string()), "ant.urdf.xacro");
}

TEST_F(DataPath, AnUnknownRobotIsAnErrorThatListsTheKnown) {
  for (const char* text : {"beetle", "terrains", "", "ant/"}) {
    try {
      find_robot(text, models_.string());
      ADD_FAILURE() << "no error for '" << text << "'";
    } catch (const ConfigError& e) {
      EXPECT_NE(e.expected().find("ant, walker"), std::string::npos) << e.what();
      EXPECT_TRUE(e.found().starts_with("'" + std::string(text) + "'")) << e.what();
    }
  }
}

}  // namespace
}  // namespace crossgait
