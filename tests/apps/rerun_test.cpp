// Results say how they were made, and can be made again from that alone.
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "backends/registry.h"
#include "physics/core/files_read.h"
#include "physics/core/sha256.h"
#include "physics/robot_files/data_path.h"
#include "study/version.h"
#include "tests/apps/run_program.h"

namespace crossgait {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

std::string first_and_last_engine() { return available_engines().front() + "," + available_engines().back(); }

struct Command {
  std::string name, arguments;
};

std::vector<Command> commands() {
  std::vector<Command> all{
      {"walk", "walk --terrain rough --seed 7 --seconds .3 --set step_length=.07 --command .1,-.01,.2"},
      {"walk_automatic", "walk --seconds .3 --gait auto --speed -.05 --terminations fell,collapsed"},
      {"rollout",
       "rollout --policy random --baseline --episodes 2 --episode-seconds .2 --seed 5 --workers 2"},
      {"transfer", "transfer --episodes 1 --episode-seconds .1 --terrains 'flat;stairs:rise=.005,run=.1'"},
      {"course", "course --sections payload-30,rough-30mm --episodes 2 --set cycle_time=.3"},
      {"diagnose", "diagnose serial_joints --engine " + available_engines().front()},
      {"matrix", "matrix serial_joints --starts 2 --seconds 1.5 --engines " + available_engines().front()},
      {"score", "score serial_joints --starts 2 --seconds 1.5 --engines " + available_engines().front()},
      {"tune", "tune --iterations 1 --population 4 --terrains 1 --unseen 0 --episode-seconds .1"},
      {"gait", "gait --seconds .1"},
      {"ik", "ik --target -.01,.02,-.07"},
      {"robots", "robots scara_quadruped"},
      {"terrain", "terrain rough --seed 3 --sample -.1,.2"},
      {"env", "env --adapt step_length,step_height"},
  };
  if (available_engines().size() > 1) {
    all.push_back({"compare", "compare --seconds .3 --terrain waves --friction .4"});
    all.push_back(
        {"verdict", "verdict --seconds .2 --settle .1 --starts 4 --engines " + first_and_last_engine()});
    all.push_back({"verdict_policy", "verdict --policy zero --seconds .2 --settle .1 --starts 4"});
  }
  if (available_engines().size() > 2) {
    const std::vector<std::string> engines = available_engines();
    all.push_back({"verdict_many", "verdict --seconds .2 --settle .1 --starts 4 --engines " + engines[0] +
                                       "," + engines[1] + "," + engines[2]});
  }
  return all;
}

class Rerun : public testing::TestWithParam<Command> {};

TEST_P(Rerun, GivesTheSameBits) {
  const std::string first = "rerun_" + GetParam().name + ".json",
                    second = "rerun_again_" + GetParam().name + ".json";
  ASSERT_EQ(run_program(GetParam().arguments + " --json " + first).exit_code, 0);
  const ProgramResult again = run_program("rerun " + first + " --json " + second);
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_NE(again.err.find("the same result"), std::string::npos) << again.err;
  const json one = json::parse(read_file(first)), two = json::parse(read_file(second));
  EXPECT_EQ(without_times(one), without_times(two));
  EXPECT_EQ(one["provenance"]["crossgait"], crossgait_version());
  EXPECT_EQ(one["provenance"]["hash"].get<std::string>().size(), 16U);
  fs::remove(first);
  fs::remove(second);
}

INSTANTIATE_TEST_SUITE_P(Commands, Rerun, testing::ValuesIn(commands()),
                         [](const auto& test) { return test.param.name; });

// A walk, and what it says of itself.
class Provenances : public testing::Test {
 protected:
  void SetUp() override {
    file_ =
        std::string("provenance_") + testing::UnitTest::GetInstance()->current_test_info()->name() + ".json";
    write_file(kTerrain, "0,0\n0,.001\n");
    ASSERT_EQ(run_program("walk --seconds .1 --terrain " + kTerrain + " --json " + file_).exit_code, 0);
    result_ = json::parse(read_file(file_));
  }
  void TearDown() override {
    fs::remove(file_);
    fs::remove(kTerrain);
  }
  void expect_refused(const json& changed, const std::vector<std::string>& words) {
    write_file(file_, changed.dump());
    expect_bad_input("rerun " + file_, words);
  }

  const std::string kTerrain =
      std::string("provenance_") + testing::UnitTest::GetInstance()->current_test_info()->name() + ".csv";
  std::string file_;
  json result_;
};

TEST_F(Provenances, HoldWhatTheWalkWasMadeOf) {
  const json& p = result_["provenance"];
  EXPECT_EQ(p["command"], "walk");
  EXPECT_EQ(p["engines"][0]["name"], available_engines().front());
  EXPECT_EQ(p["engines"][0]["version"], find_engine(available_engines().front()).info.version);
  // What was really read, with what `sha256sum` says of it.
  EXPECT_EQ(p["files"][kTerrain], sha256_hex("0,0\n0,.001\n"));
  for (const char* file :
       {"<models>/robots/scara_quadruped/robot.yaml", "<models>/robots/scara_quadruped/robot.urdf"})
    EXPECT_EQ(p["files"].value(file, ""), file_sha256(models_dir() + std::string(file).substr(8))) << file;
  EXPECT_EQ(p["files"].size(), 3U);
  const json& walk = p["behaviour"];
  EXPECT_EQ(walk["robot"]["name"], "scara_quadruped");
  for (const char* key : {"terrain", "terrain_seed", "contact", "physics_dt", "control_dt", "gait",
                          "parameters", "seconds", "settle_seconds", "terminations", "compensation"}) {
    EXPECT_TRUE(walk.contains(key)) << key;
  }
}

// What is damaged says nothing, though the walk be the same.
TEST_F(Provenances, ThatAreDamagedAreRefused) {
  json changed = result_;
  changed["provenance"]["hash"] = std::string(16, '0');
  expect_refused(changed, {"provenance.hash", result_["provenance"]["hash"]});
  changed = result_;
  changed["provenance"]["files"] = json::object();
  expect_refused(changed, {"provenance.hash"});
  std::string twice = result_.dump();
  twice.insert(1, "\"distance_m\": 55.0, ");
  write_file(file_, twice);
  expect_bad_input("rerun " + file_, {"distance_m", "each key once", "twice"});
}

TEST_F(Provenances, OfGroundsAndGaitsHoldSeedsAndParameters) {
  const json ground = run_json("terrain rough")["provenance"];
  EXPECT_EQ(ground["seed"], 0);
  EXPECT_EQ(ground["terrains"], json::array({"rough"}));
  for (const char* command : {"gait --gait walk", "workspace --gait walk"}) {
    const json walk = run_json(command)["provenance"];
    EXPECT_EQ(walk["behaviour"]["gait"], "walk") << command;
    EXPECT_TRUE(walk["behaviour"]["parameters"].contains("step_length")) << command;
    EXPECT_EQ(walk["robot"]["name"], "scara_quadruped") << command;
  }
}

TEST_F(Provenances, HoldThePoliciesAndFilesThatOthersName) {
  const auto files_of = [](const std::string& command) {
    std::vector<std::string> names;
    const json result = run_json(command);
    for (const auto& [name, hash] : result["provenance"]["files"].items()) names.push_back(name);
    return names;
  };
  write_file("provenance_member.yaml", "{kind: scripted, layout_version: 3, steps: [{time: 0.2}]}\n");
  write_file("provenance_whole.yaml",
             "kind: hierarchical  # not provenance_other.yaml\nlayout_version: 3\n"
             "planner: {policy: zero}\nresidual: {policy: provenance_member.yaml}\n");
  write_file("provenance_other.yaml", "{}");
  write_file("provenance_environment.yaml", "episode_seconds: .1\nterrain: " + kTerrain + "\n");
  EXPECT_EQ(
      files_of("rollout --config provenance_environment.yaml --policy provenance_whole.yaml --episodes 1"),
      (std::vector<std::string>{
          "<models>/robots/scara_quadruped/robot.urdf", "<models>/robots/scara_quadruped/robot.yaml",
          kTerrain, "provenance_environment.yaml", "provenance_member.yaml", "provenance_whole.yaml"}));
  for (const char* name : {"member", "whole", "other", "environment"})
    fs::remove(std::string("provenance_") + name + ".yaml");
}

TEST_F(Provenances, DoNotHangOnWhereResultsGoOrOnThreads) {
  const std::string arguments = "rollout --episodes 2 --episode-seconds .1";
  EXPECT_EQ(run_json(arguments + " --workers 1 --trace provenance_trace.csv")["provenance"],
            run_json(arguments + " --workers 2")["provenance"]);
  fs::remove("provenance_trace.csv");
}

TEST(RerunOfXacro, ExpandsItAgain) {
  fs::create_directories("rerun_bin");
  write_file("rerun_bin/xacro",
             "#!/bin/sh\nexec cat " CROSSGAIT_SOURCE_DIR "/models/robots/serial_quadruped/robot.urdf\n");
  fs::permissions("rerun_bin/xacro", fs::perms::owner_all);
  write_file("rerun.urdf.xacro", "<robot/>");
  const std::string path = std::getenv("PATH");
  setenv("PATH", ("./rerun_bin:" + path).c_str(), 1);
  setenv("CROSSGAIT_PYTHON", "./no_such_python", 1);
  ASSERT_EQ(run_program("walk --seconds .1 --robot rerun.urdf.xacro --json rerun_xacro.json").exit_code, 0);
  EXPECT_TRUE(json::parse(read_file("rerun_xacro.json"))["provenance"]["files"].contains(
      "rerun.urdf.xacro (expanded)"));
  EXPECT_EQ(run_program("rerun rerun_xacro.json").exit_code, 0);
  setenv("PATH", path.c_str(), 1);
  unsetenv("CROSSGAIT_PYTHON");
}

TEST_F(Provenances, TrustNothing) {
  json changed = result_;
  for (const char* word : {"--trust", "--trust=/"}) {
    changed["provenance"]["arguments"] = {"--seconds", ".1", word, "/"};
    expect_refused(changed, {file_, "provenance.arguments", word});
  }
  write_file(file_, result_.dump());
  EXPECT_EQ(run_program("rerun " + file_ + " --trust .").exit_code, 0);
  const json trusting = json::parse(run_program("walk --seconds .1 --trust . --json -").out);
  EXPECT_EQ(trusting["provenance"].dump().find("trust"), std::string::npos);
}

TEST_F(Provenances, RefuseWhatIsNoLongerThere) {
  json changed = result_;
  changed["provenance"]["crossgait"] = "0.0.1";
  expect_refused(changed, {file_, "provenance.crossgait", "0.0.1", std::string(crossgait_version())});
  changed = result_;
  changed["provenance"]["engines"][0]["version"] = "0.1";
  expect_refused(changed, {"provenance.engines.0.version", "0.1"});
  changed = result_;
  changed["provenance"]["behaviour"]["parameters"]["step_length"] = 1;
  expect_refused(changed, {"provenance.behaviour.parameters.step_length"});
  changed.erase("provenance");
  expect_refused(changed, {file_, "provenance"});
  expect_refused(json(3), {file_});
  write_file(file_, result_.dump());
  EXPECT_EQ(run_program("rerun " + file_).exit_code, 0);
  write_file(kTerrain, "0,0\n0,.002\n");
  expect_bad_input("rerun " + file_, {"provenance.", kTerrain});
}

TEST_F(Provenances, SayWhereAResultCameOutOtherwise) {
  json changed = result_;
  changed["distance_m"] = 3.0;
  write_file(file_, changed.dump());
  const ProgramResult again = run_program("rerun " + file_);
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_NE(again.err.find("distance_m"), std::string::npos) << again.err;
}

// A result is a file, and may come from anybody: what it says to run makes a result and does nothing else.
TEST(RerunBadInput, WritesNowhereAndStartsNothing) {
  write_file("rerun_precious", "precious");
  const auto made_by = [](const std::string& command, const json& arguments) {
    write_file("rerun_evil.json", json{{"schema", {{"name", command}}},
                                       {"provenance", {{"command", command}, {"arguments", arguments}}}}
                                      .dump());
  };
  const std::vector<std::pair<std::string, json>> evil{
      {"gait", {"--csv=rerun_precious"}},
      {"gait", {"--csv", "rerun_precious"}},
      {"gait", {"--report=rerun_precious"}},
      {"gait", {"--json=rerun_precious"}},
      {"walk", {"--trace=rerun_precious"}},
      {"terrain", {"rough", "--png=rerun_precious"}},
      {"terrain", {"rough", "--csv=rerun_precious"}},
      {"verdict", {"--runs=rerun_precious"}},
      {"tune", {"--out=rerun_precious"}},
      {"rollout", {"--workers=1000"}},
      {"report", {"x.json", "--out=rerun_precious"}},
      {"view", {"--port=0"}},
      {"video", {"rerun_precious"}},
      {"conformance", {"--nothing"}},
      {"gait", {"-csv=rerun_precious"}},
      {"nothing", json::array()},
      {"rerun", {"rerun_evil.json"}},
  };
  for (const auto& [command, arguments] : evil) {
    made_by(command, arguments);
    expect_bad_input("rerun rerun_evil.json", {"rerun_evil.json", "provenance."});
    EXPECT_EQ(read_file("rerun_precious"), "precious") << command << arguments;
  }
  made_by("gait", {"--csv=rerun_precious"});
  expect_bad_input("report rerun_evil.json --out rerun_page.html",
                   {"rerun_evil.json", "provenance.arguments"});
  EXPECT_EQ(read_file("rerun_precious"), "precious");
  EXPECT_FALSE(fs::exists("rerun_page.html"));
  fs::remove("rerun_evil.json");
  fs::remove("rerun_precious");
}

// What is refused because it is not the same has written nothing yet.
TEST(RerunBadInput, IsRefusedBeforeAnythingIsWritten) {
  for (const std::string command : {"terrain rough", "gait"}) {
    ASSERT_EQ(run_program(command + " --json rerun_other.json").exit_code, 0);
    json other = json::parse(read_file("rerun_other.json"));
    other["provenance"]["crossgait"] = "0.0.1";
    write_file("rerun_other.json", other.dump());
    expect_bad_input("rerun rerun_other.json --csv rerun_new.csv", {"provenance.crossgait"});
    EXPECT_FALSE(fs::exists("rerun_new.csv")) << command;
  }
  fs::remove("rerun_other.json");
}

TEST(RerunBadInput, NamesTheFile) {
  expect_bad_input("rerun", {"result"});
  expect_bad_input("rerun rerun_nowhere.json", {"rerun_nowhere.json"});
  write_file("rerun_of_rerun.json",
             R"({"provenance": {"command": "rerun", "arguments": ["rerun_of_rerun.json"]}})");
  expect_bad_input("rerun rerun_of_rerun.json", {"rerun_of_rerun.json", "a command that makes results"});
  fs::remove("rerun_of_rerun.json");
}

}  // namespace
}  // namespace crossgait
