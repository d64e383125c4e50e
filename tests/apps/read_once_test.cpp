// A command reads its robot once, whatever it does with it: a file that changes under way changes nothing.
#include <filesystem>

#include <gtest/gtest.h>

#include "backends/registry.h"
#include "physics/robot_files/data_path.h"
#include "tests/apps/run_program.h"
#include "tests/physics/core/scratch_folder.h"
#include "tests/support/open_counter.h"

namespace crossgait {
namespace {

class ReadOnce : public ScratchFolder {
 protected:
  void SetUp() override {
    ScratchFolder::SetUp();
    std::filesystem::copy(std::filesystem::path(find_robot("scara_quadruped")).parent_path(), path("robot"),
                          std::filesystem::copy_options::recursive);
  }

  /// Files of a robot are opened by whoever reads the robot, and by nobody else: their hashes are of what was
  /// read.
  void expect_one_reading(const std::string& command) const {
    const OpenCounter opened(path("robot"));
    const std::string robot = " --robot " + path("robot/robot.yaml");
    const ProgramResult result = run_program(command + robot + " --json " + path("result.json"));
    ASSERT_EQ(result.exit_code, 0) << command << '\n' << result.err;
    auto counts = opened.take();
    EXPECT_EQ(counts["robot.urdf"], 1) << command;
    EXPECT_EQ(counts["robot.yaml"], 1) << command;
  }
};

TEST_F(ReadOnce, ByWalksWithAllTheyWrite) {
  expect_one_reading("walk --seconds .1 --settle .05");
  expect_one_reading("walk --seconds .1 --settle .05 --terrain rough --trace " + path("t.csv") +
                     " --report " + path("page.html"));
}

TEST_F(ReadOnce, ByComparisonsAndVerdicts) {
  if (available_engines().size() < 2) GTEST_SKIP() << "one engine alone";
  expect_one_reading("compare --seconds .1 --settle .05 --trace " + path("t.csv") + " --report " +
                     path("page.html"));
  expect_one_reading("verdict --seconds .1 --settle .05 --starts 4 --runs " + path("walks.jsonl"));
  expect_one_reading("verdict --policy zero --seconds .1 --settle .05 --starts 4 --runs " +
                     path("episodes.jsonl") + " --report " + path("page.html"));
}

TEST_F(ReadOnce, ByWhatLooksAtTheRobotAlone) {
  for (const char* command : {"gait", "ik --target 0,0,-0.07", "workspace", "robots"})
    expect_one_reading(command);
}

TEST_F(ReadOnce, ByWhatRunsEpisodes) {
  expect_one_reading("rollout --policy zero,random --episode-seconds .1 --episodes 2 --trace " +
                     path("t.csv") + " --report " + path("page.html"));
  expect_one_reading("transfer --terrains flat rough --episode-seconds .1 --episodes 1 --report " +
                     path("page.html"));
  write("course.yaml",
        "seconds: .1\nsections:\n  one: {terrain: flat, speed: .1}\n  two: {terrain: rough, speed: .1}\n");
  expect_one_reading("course --episodes 1 --course " + path("course.yaml"));
  expect_one_reading("tune --iterations 1 --population 4 --terrains 1 --unseen 1 --episode-seconds .1");
}

}  // namespace
}  // namespace crossgait
