#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "backends/registry.h"
#include "report/page_template.h"
#include "tests/apps/run_program.h"

namespace crossgait {
namespace {

using nlohmann::json;

std::string in_first_engine(const std::string& arguments) {
  return "diagnose " + arguments + " --engine " + available_engines().front();
}

TEST(DiagnoseCommand, EndsWellOfAPolicyThatDoesWhatItIsAsked) {
  const ProgramResult found = run_program(in_first_engine("serial_joints"));
  EXPECT_EQ(found.exit_code, 0) << found.err;
  EXPECT_NE(found.out.find("no cause is named"), std::string::npos) << found.out;
}

TEST(DiagnoseCommand, HasACodeForAPolicyThatDoesNot) {
  const std::string env = "--env " CROSSGAIT_SOURCE_DIR "/models/policies/serial_joints/environment.yaml";
  const ProgramResult found = run_program(in_first_engine("--policy zero --no-search " + env));
  EXPECT_EQ(found.exit_code, 4);
  EXPECT_NE(found.out.find("misses the speed"), std::string::npos) << found.out;
}

TEST(DiagnoseCommand, WritesAPageThatReplaysEveryCommand) {
  if (page_template().empty()) GTEST_SKIP() << "no page";
  const std::string env = "--env " CROSSGAIT_SOURCE_DIR "/models/policies/serial_joints/environment.yaml";
  const ProgramResult found = run_program(in_first_engine(
      "--policy zero --no-search --json diagnose_page.json --report diagnose_page.html " + env));
  EXPECT_EQ(found.exit_code, 4) << found.err;
  const json document = document_of("diagnose_page.html"),
             result = json::parse(std::ifstream("diagnose_page.json"));
  EXPECT_EQ(document.at("summary"), result.at("summary"));
  ASSERT_EQ(document.at("motions").size(), result.at("walks").size());
  for (std::size_t c = 0; c < result.at("walks").size(); ++c) {
    const json &motion = document.at("motions").at(c), &walk = result.at("walks").at(c);
    EXPECT_EQ(motion.at("name"), walk.at("command"));
    EXPECT_EQ(motion.at("runs").at(0).at("name"), "as given");
    // A robot that stands stays where it is: as asked where that is nothing, missed by all of the speed else.
    EXPECT_EQ(walk.at("as_given").at("done"), walk.at("asked").at("vx") == 0);
    EXPECT_NEAR(walk.at("as_given").at("speed_error_mps").get<double>(),
                walk.at("asked").at("vx").get<double>(),
                0.05);  // what it sways by
  }
  for (const char* made : {"diagnose_page.json", "diagnose_page.html"}) std::filesystem::remove(made);
}

TEST(DiagnoseCommand, RefusesBadInput) {
  expect_bad_input("diagnose", {"NAME or --policy", "neither"});
  expect_bad_input("diagnose serial_joints --policy zero", {"NAME or --policy", "both"});
  expect_bad_input("diagnose --policy zero", {"--env"});
  expect_bad_input("diagnose nobody", {"--env"});
  expect_bad_input("diagnose scara_guide", {"action", "joints"});
  expect_bad_input("diagnose serial_joints --home-engine nowhere", {"nowhere"});
}

TEST(DiagnoseCommand, NamesACauseAndWritesWhatWalks) {
  std::ofstream("diagnose_patient.yaml")
      << "robot: serial_quadruped\naction: joints\njoints: {scale: 1}\ncommand: "
         "{vx: .7}\nfriction: .6\npolicy_dt: .02\n";
  const std::string file = CROSSGAIT_SOURCE_DIR "/models/policies/serial_joints/serial_joints.safetensors";
  const ProgramResult found = run_program(in_first_engine(
      "--policy " + file + " --env diagnose_patient.yaml --write diagnose_walks.yaml --json diagnose.json"));
  EXPECT_EQ(found.exit_code, 3) << found.err;
  const json result = json::parse(std::ifstream("diagnose.json"));
  EXPECT_EQ(result.at("cause"), "contract");
  EXPECT_EQ(result.at("ranking").at(0).at("field"), "joints.scale");
  EXPECT_EQ(result.at("environment_file"), "diagnose_walks.yaml");
  EXPECT_EQ(run_program(in_first_engine("--policy " + file + " --env diagnose_walks.yaml")).exit_code, 0);
  for (const char* made : {"diagnose_patient.yaml", "diagnose_walks.yaml", "diagnose.json"})
    std::filesystem::remove(made);
}

}  // namespace
}  // namespace crossgait
