// Nothing is lost in silence: outputs that cannot be written, and commands that are ended early.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "backends/registry.h"
#include "tests/apps/run_program.h"

namespace crossgait {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

// Of a walk that nobody waits for: what is refused has to be refused before it.
const std::string kEndless = " --seconds 900000 ";

long lines(const std::string& file) {
  const std::string text = read_file(file);
  return std::count(text.begin(), text.end(), '\n');
}

void remove_all_of(const std::string& prefix) {
  const std::vector<fs::directory_entry> entries(fs::directory_iterator("."), fs::directory_iterator());
  for (const fs::directory_entry& entry : entries) {
    if (entry.path().filename().string().starts_with(prefix)) fs::remove(entry.path());
  }
}

bool leaves_a_temporary() {
  for (const auto& entry : fs::directory_iterator(".")) {
    if (entry.path().filename().string().starts_with("outputs_walk") && entry.path().extension() == ".tmp")
      return true;
  }
  return false;
}

TEST(Outputs, StandardOutputThatIsFullOrClosedIsAFailure) {
  for (const char* command : {"gait --list", "--help", "--version", "gait --csv -",
                              "ik --target 0,0,-.07 --json -", "gait --seconds 100 --csv -"}) {
    for (const char* where : {" >/dev/full", " >&-"}) {
      const ProgramResult result = run_program(std::string(command) + where);
      EXPECT_EQ(result.exit_code, 1) << command << where;
      EXPECT_NE(result.err.find("crossgait: "), std::string::npos) << command << where << result.err;
    }
  }
}

TEST(Outputs, AFileIsWrittenAlthoughStandardOutputIsNot) {
  EXPECT_EQ(run_program("ik --target 0,0,-.07 --json outputs_ik.json >&-").exit_code, 1);
  EXPECT_EQ(json::parse(read_file("outputs_ik.json"))["status"], "ok");  // and nothing else is in it
  fs::remove("outputs_ik.json");
}

TEST(Outputs, StandardErrorMayBeClosed) {
  EXPECT_EQ(run_program("gait --list 2>&-").exit_code, 0);
  EXPECT_EQ(run_program("walk --gait hop 2>&-").exit_code, 2);
}

TEST(Outputs, AreTriedBeforeTheWork) {
  for (const std::string option : {"--trace", "--json"}) {
    expect_bad_input("walk" + kEndless + option + " nowhere/at/all.csv", {"nowhere/at/all.csv"});
    expect_bad_input("walk" + kEndless + option + " .", {"."});
    expect_bad_input("rollout --episode-seconds 900000 " + option + " nowhere/at/all.csv", {"nowhere/at"});
  }
  if (available_engines().size() > 1) {
    expect_bad_input("compare" + kEndless + "--trace nowhere/at/all.csv", {"nowhere/at"});
    expect_bad_input("verdict" + kEndless + "--runs nowhere/at/all.jsonl", {"nowhere/at"});
    expect_bad_input("verdict" + kEndless + "--json nowhere/at/all.json", {"nowhere/at"});
  }
  expect_bad_input("tune --iterations 10000 --out nowhere/at/all.yaml", {"nowhere/at"});
  expect_bad_input("transfer --episodes 100000 --json nowhere/at/all.json", {"nowhere/at"});
  expect_bad_input("bench --json nowhere/at/all.json", {"nowhere/at"});
  expect_bad_input("bench --report nowhere/at/all.html", {"nowhere/at"});
  expect_bad_input("walk" + kEndless + "--trace outputs_same --json outputs_same", {"outputs_same", "own"});
  EXPECT_FALSE(fs::exists("outputs_same"));
}

TEST(Interrupted, AWalkKeepsItsTraceAndItsResult) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const ProgramResult result =
        run_watched("walk" + kEndless + "--trace outputs_walk.csv --json outputs_walk.json", signal, 0.5);
    EXPECT_EQ(result.exit_code, 130) << result.err;
    EXPECT_NE(result.err.find("interrupted"), std::string::npos) << result.err;
    const json walk = json::parse(read_file("outputs_walk.json"));
    EXPECT_EQ(walk["interrupted"], true);
    EXPECT_EQ(walk["outcome"], "walked");
    EXPECT_GT(walk["simulated_seconds"], 0);
    EXPECT_EQ(lines("outputs_walk.csv") - 1, std::lround(walk["simulated_seconds"].get<double>() / 2e-3));
    EXPECT_FALSE(leaves_a_temporary());
    fs::remove("outputs_walk.csv");
    fs::remove("outputs_walk.json");
  }
}

TEST(Interrupted, AComparisonKeepsAllWalksUpToTheSameStep) {
  const auto engines = available_engines();
  if (engines.size() < 2) GTEST_SKIP() << "one engine alone";
  const std::string two = "--engines " + engines[0] + "," + engines[1];
  const ProgramResult result =
      run_watched("compare" + kEndless + two + " --trace outputs_c.csv --json outputs_c.json", SIGINT, 0.5);
  EXPECT_EQ(result.exit_code, 130) << result.err;
  const json compared = json::parse(read_file("outputs_c.json"));
  EXPECT_EQ(compared["interrupted"], true);
  EXPECT_EQ(compared["runs"][0]["simulated_seconds"], compared["runs"][1]["simulated_seconds"]);
  int traces = 0;
  for (const auto& entry : fs::directory_iterator(".")) {
    const std::string name = entry.path().filename();
    if (!name.starts_with("outputs_c.") || !name.ends_with(".csv")) continue;
    ++traces;
    EXPECT_EQ(lines(name) - 1, std::lround(compared["runs"][0]["simulated_seconds"].get<double>() / 2e-3));
  }
  EXPECT_EQ(traces, 2);
  remove_all_of("outputs_c.");
}

TEST(Interrupted, ARolloutKeepsTheEpisodesThatAreFinished) {
  const ProgramResult result = run_watched(
      "rollout --episodes 100000 --episode-seconds .1 --workers 2 --json outputs_r.json --trace "
      "outputs_r.csv",
      SIGINT, 1);
  EXPECT_EQ(result.exit_code, 130) << result.err;
  EXPECT_NE(result.err.find("of 100000 episodes"), std::string::npos) << result.err;
  const json rollout = json::parse(read_file("outputs_r.json"));
  EXPECT_EQ(rollout["interrupted"], true);
  ASSERT_EQ(rollout["policies"].size(), 1U);
  const json& policy = rollout["policies"][0];
  EXPECT_GT(policy["episodes"].size(), 0U);
  EXPECT_EQ(policy["all"]["episodes"], policy["episodes"].size());
  // They are those of a rollout that was not interrupted.
  const json one = run_json("rollout --episodes 1 --episode-seconds .1");
  EXPECT_EQ(policy["episodes"][0], one["policies"][0]["episodes"][0]);
  EXPECT_GT(lines("outputs_r.csv"), 1);
  remove_all_of("outputs_r.");
}

TEST(Interrupted, AVerdictGoesOnFromItsRuns) {
  if (available_engines().size() < 2) GTEST_SKIP() << "one engine alone";
  fs::remove("outputs_v.jsonl");
  const std::string command = "verdict --seconds .2 --settle .1 --starts 4 --runs outputs_v.jsonl";
  const ProgramResult ended = run_watched(
      "verdict --seconds .2 --settle .1 --starts 4000 --runs outputs_v.jsonl "
      "--json outputs_v.json",
      SIGTERM, 1);
  EXPECT_EQ(ended.exit_code, 130) << ended.err;
  EXPECT_NE(ended.err.find("outputs_v.jsonl"), std::string::npos) << ended.err;
  EXPECT_FALSE(fs::exists("outputs_v.json"));
  const long kept = lines("outputs_v.jsonl");
  EXPECT_GT(kept, 0);
  EXPECT_NE(ended.err.find(std::to_string(kept)), std::string::npos) << ended.err;
  EXPECT_EQ(run_program(command).exit_code, 0);
  fs::remove("outputs_v.jsonl");
}

TEST(Interrupted, ATransferKeepsItsCells) {
  const ProgramResult result =
      run_watched("transfer --episodes 100000 --episode-seconds .1 --json outputs_t.json", SIGINT, 0.5);
  EXPECT_EQ(result.exit_code, 130) << result.err;
  const json transfer = json::parse(read_file("outputs_t.json"));
  EXPECT_EQ(transfer["interrupted"], true);
  EXPECT_LT(transfer["cells"].size(), 3 * available_engines().size());
  fs::remove("outputs_t.json");
}

TEST(Interrupted, ATuningKeepsTheBestSoFar) {
  const ProgramResult result = run_watched(
      "tune --iterations 10000 --episode-seconds .2 --out outputs_best.yaml --json outputs_tune.json", SIGINT,
      1);
  EXPECT_EQ(result.exit_code, 130) << result.err;
  EXPECT_EQ(json::parse(read_file("outputs_tune.json"))["interrupted"], true);
  EXPECT_EQ(run_program("env --yaml --config outputs_best.yaml").exit_code, 0);
  fs::remove("outputs_best.yaml");
  fs::remove("outputs_tune.json");
}

TEST(Interrupted, ABenchmarkKeepsItsSections) {
  const ProgramResult result = run_watched("bench --only speed --json outputs_bench.json", SIGINT, 0.2);
  EXPECT_EQ(result.exit_code, 130) << result.err;
  const json bench = json::parse(read_file("outputs_bench.json"));
  EXPECT_EQ(bench["interrupted"], true);
  EXPECT_FALSE(bench.contains("speed"));
  fs::remove("outputs_bench.json");
}

// Walks are compared as they go: what a longer one needs more is noise. Kept whole, 30 s of two engines took
// 30 MB more than 3 s of them.
TEST(Compare, MemoryDoesNotGrowWithTheLength) {
  const auto engines = available_engines();
  if (engines.size() < 2) GTEST_SKIP() << "one engine alone";
  const auto peak = [&](const std::string& seconds) {
    const ProgramResult result = run_watched("compare --engines " + engines[0] + "," + engines[1] +
                                             " --seconds " + seconds + " --trace outputs_m.csv");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.peak_kb;
  };
  const long brief = peak("3"), lengthy = peak("30");
  EXPECT_LT(lengthy, brief + 8000);
  remove_all_of("outputs_m.");
}

}  // namespace
}  // namespace crossgait
