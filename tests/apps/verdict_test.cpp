// `crossgait verdict` and `compare --verdict` on the command line.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "backends/registry.h"
#include "physics/robot_files/data_path.h"
#include "tests/apps/run_program.h"

namespace crossgait {
namespace {

using nlohmann::json;

// Short runs of few starts: what is looked at is the contract, not the word.
const std::string kShort = " --seconds .2 --settle .1 --starts 6";

// Two, comma-separated.
std::optional<std::string> engines_of_one_law() {
  const std::vector<std::string> all = available_engines();
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (find_engine(all[i]).info.laws == find_engine(all[k]).info.laws) return all[k] + "," + all[i];
    }
  }
  return std::nullopt;
}

bool has_two_engines() { return available_engines().size() >= 2; }

TEST(VerdictCommand, KeepsItsContract) {
  if (!has_two_engines()) GTEST_SKIP() << "one engine alone";
  const json verdict = run_json("verdict" + kShort);
  EXPECT_TRUE(verdict["against"].is_null());
  EXPECT_FALSE(verdict["summary"].get<std::string>().empty());
  const json& pair = verdict["pairs"][0];
  EXPECT_EQ(pair["engines"][0], available_engines().front());
  const std::vector<std::string> all = available_engines();
  const auto other = std::find_if(all.begin(), all.end(), [&all](const std::string& name) {
    return find_engine(name).info.laws != find_engine(all.front()).info.laws;
  });
  ASSERT_NE(other, all.end());
  EXPECT_EQ(pair["engines"][1], *other);
  EXPECT_TRUE(pair["models"].empty()) << pair["models"];
  ASSERT_EQ(pair["statistics"].size(), 9U);
  EXPECT_EQ(pair["statistics"].back()["key"], "failures");
  for (const json& s : pair["statistics"]) {
    EXPECT_LE(s["low"].get<double>(), s["gap"].get<double>());
    EXPECT_LE(s["gap"].get<double>(), s["high"].get<double>());
    EXPECT_GT(s["margin"].get<double>(), 0);
    if (s["estimand"] == "mean" && s["key"] != "failures") {
      EXPECT_NEAR(s["gap"], s["values"][1].get<double>() - s["values"][0].get<double>(), 1e-12);
    }
  }
  for (const json& engine : verdict["engines"]) {
    int runs = 0;
    for (const json& count : verdict["outcomes"][engine["name"].get<std::string>()]) runs += count.get<int>();
    EXPECT_EQ(runs, 6);
  }
}

TEST(VerdictCommand, JudgesPolicies) {
  if (!has_two_engines()) GTEST_SKIP() << "one engine alone";
  const json verdict = run_json("verdict --policy zero" + kShort);
  const json& statistics = verdict["pairs"][0]["statistics"];
  ASSERT_EQ(statistics.size(), 10U);
  EXPECT_EQ(statistics[8]["key"], "total_reward");
  EXPECT_EQ(verdict["behaviour"], "policy zero on flat, 0.2 s");
}

TEST(VerdictCommand, JudgesAPolicyInTheWorldOfItsConfiguration) {
  if (!has_two_engines()) GTEST_SKIP() << "one engine alone";
  const std::string file = write_file(
      "verdict_env.yaml", "terrain: rough\nfriction: .3\nepisode_seconds: .2\nsettle_seconds: .1\n");
  const json verdict = run_json("verdict --starts 6 --policy zero --config " + file);
  EXPECT_EQ(verdict["behaviour"], "policy zero on rough, 0.2 s");
  // As one that the options describe, which is the same world.
  const json typed = run_json("verdict --policy zero --terrain rough --friction .3" + kShort);
  EXPECT_EQ(verdict["pairs"][0]["statistics"], typed["pairs"][0]["statistics"]);
  const json other = run_json("verdict --policy zero" + kShort);
  EXPECT_NE(verdict["pairs"][0]["statistics"], other["pairs"][0]["statistics"]);
  std::filesystem::remove(file);
}

TEST(VerdictCommand, PushesPoliciesAsItPushesWalks) {
  if (!has_two_engines()) GTEST_SKIP() << "one engine alone";
  const json soft = run_json("verdict --policy zero --push 0" + kShort);
  const json hard = run_json("verdict --policy zero --push .5" + kShort);
  EXPECT_EQ(soft["provenance"]["starts"]["push_mps"], 0);
  EXPECT_NE(soft["pairs"][0]["statistics"][0]["values"], hard["pairs"][0]["statistics"][0]["values"]);
}

TEST(VerdictCommand, FromStoredRunsGivesTheSameAndMakesNoRun) {
  if (!has_two_engines()) GTEST_SKIP() << "one engine alone";
  const std::string file = "verdict_stored_runs.jsonl";
  std::filesystem::remove(file);
  const std::string arguments = std::string("verdict --workers 2 --runs ") + file + kShort;
  const json first = run_json(arguments);
  const std::string runs = read_file(file);
  EXPECT_GT(std::count(runs.begin(), runs.end(), '\n'), 8);
  const json second = run_json(arguments);
  EXPECT_EQ(second, first);
  EXPECT_EQ(read_file(file), runs);  // what is made is added, so nothing was
  // Stopped halfway through a line.
  std::filesystem::resize_file(file, runs.size() / 2);
  EXPECT_EQ(run_json(arguments), first);
  EXPECT_EQ(read_file(file).size(), runs.size());
  std::ofstream(file) << "garbage\n";
  expect_bad_input(arguments, {file, "line 1"});
  std::filesystem::remove(file);
}

TEST(VerdictCommand, ExplainsWhereThereIsAFamily) {
  if (engine_families().empty()) GTEST_SKIP() << "no engine is made of factors";
  const EngineFamily family =
      family_for(engine_families().front(), load_robot(find_robot("scara_quadruped")));
  const json verdict =
      run_json("verdict --explain --engines " + family.from + "," + family.to + " " + kShort);
  const json& attribution = verdict["pairs"][0]["attribution"];
  EXPECT_EQ(attribution["factors"].size(), family.factors.size());
  ASSERT_EQ(attribution["statistics"].size(), 9U);
  for (const json& s : attribution["statistics"]) {
    ASSERT_EQ(s["factors"].size(), family.factors.size());
    double effects = 0, steps = 0;
    for (const json& i : s["factors"]) {
      effects += i["effect"]["estimate"].get<double>();
      steps += i["step"]["estimate"].get<double>();
    }
    // Both ways of sharing out sum to the gap.
    const double gap = s["gap"]["estimate"];
    EXPECT_NEAR(effects, gap, 1e-9 * (1 + std::abs(gap))) << s["name"];
    EXPECT_NEAR(steps, gap, 1e-9 * (1 + std::abs(gap))) << s["name"];
  }
}

// One engine under two setups, from stored runs too, which setups do not share.
TEST(VerdictCommand, HoldsTwoSetupsAgainstEachOther) {
  const std::string engine = available_engines().front(), file = "verdict_setups.jsonl";
  std::filesystem::remove(file);
  const std::string arguments = "verdict --explain --runs " + file + kShort + " --against ";
  const json verdict = run_json(arguments + "gravity=x0.5,inertia=x1.01");
  EXPECT_EQ(verdict["engines"][0]["name"], engine);
  EXPECT_EQ(verdict["engines"][1]["name"], engine + " with gravity=x0.5,inertia=x1.01");
  EXPECT_EQ(verdict["against"]["changes"][0]["from"], "9.81");
  const json& pair = verdict["pairs"][0];
  EXPECT_EQ(pair["models"][0]["quantity"], "inertia");
  EXPECT_EQ(pair["attribution"]["factors"][0]["name"], "gravity");
  EXPECT_EQ(pair["attribution"]["factors"][1]["name"], "inertia");
  const std::string runs = read_file(file);
  EXPECT_EQ(run_json(arguments + "gravity=x0.5,inertia=x1.01"), verdict);
  EXPECT_EQ(read_file(file), runs);
  const json other = run_json(arguments + "gravity=x0.6,inertia=x1.01");
  EXPECT_NE(other["pairs"][0]["statistics"], pair["statistics"]);
  std::filesystem::remove(file);
}

TEST(VerdictCommand, RefusesSetupsThatAreNone) {
  expect_bad_input("verdict --against frction=0.4" + kShort, {"--against", "did you mean friction?"});
  expect_bad_input("verdict --against friction=0.6" + kShort, {"friction", "not so already"});
  expect_bad_input("verdict --against delay=0.0005" + kShort, {"delay", "0.0005"});
  expect_bad_input("verdict --against robot=nowhere.urdf" + kShort, {"nowhere.urdf"});
  expect_bad_input("verdict --against physics_dt=0.003" + kShort, {"control_dt"});
}

// The user's margins are what is judged against, and stand in the result.
TEST(VerdictCommand, TakesMarginsFromTheLineAndFromAFile) {
  if (!has_two_engines()) GTEST_SKIP() << "one engine alone";
  const std::string file = write_file("verdict_margins.yaml", "slip_m: 7\nduty_factor: 50%\n");
  const json verdict =
      run_json("verdict --margins " + file + " --margin slip_m=8 --margin rms_roll_deg=0.5/s" + kShort);
  std::map<std::string, double> margins;
  for (const json& s : verdict["pairs"][0]["statistics"]) margins[s["key"]] = s["margin"];
  EXPECT_EQ(margins["slip_m"], 8) << "the line after the file";
  EXPECT_NEAR(margins["rms_roll_deg"], 0.1, 1e-9);
  EXPECT_GT(margins["duty_factor"], 0.1);
  std::filesystem::remove(file);
}

TEST(VerdictCommand, EndsWithACodeForEveryWordThatIsNotRequired) {
  if (!has_two_engines()) GTEST_SKIP() << "one engine alone";
  const std::map<std::string, int> codes{
      {"agrees", 3}, {"differs", 4}, {"step-dependent", 5}, {"unresolved", 6}};
  const std::string word = run_json("verdict" + kShort)["word"];
  for (const auto& [required, code] : codes) {
    const ProgramResult result = run_program("verdict --require " + required + kShort);
    EXPECT_EQ(result.exit_code, required == word ? 0 : codes.at(word)) << required;
    EXPECT_EQ(result.err.empty(), required == word) << result.err;
  }
}

TEST(VerdictCommand, RefusesWhatItCannotJudge) {
  const std::string one = available_engines().front();
  for (const std::string& arguments :
       {"--engines " + one, "--engines " + one + "," + one, "--engines " + one + ",nonsense",
        std::string("--starts 2"), std::string("--confidence 1"), std::string("--confidence 0.5"),
        std::string("--looks 0"), std::string("--margin distance_m"), std::string("--margin distance_m=far"),
        std::string("--margin no_such=5%"), std::string("--margins nowhere.yaml"),
        std::string("--require maybe"), std::string("--config env.yaml"),
        std::string("--policy zero --config env.yaml --terrain rough"), std::string("--policy nonsense"),
        std::string("--policy zero --no-compensation"), std::string("--runs nowhere/at/all.jsonl")}) {
    EXPECT_EQ(run_program("verdict --seconds .1 " + arguments).exit_code, 2) << arguments;
  }
}

TEST(CompareCommand, JudgesPairsOfDifferentContactLaws) {
  if (!has_two_engines()) GTEST_SKIP() << "one engine alone";
  const json plain = run_json("compare --seconds .2");
  EXPECT_FALSE(plain.contains("verdict"));
  const json judged = run_json("compare --seconds .2 --verdict --engines " + available_engines().front() +
                               "," + available_engines().back());
  EXPECT_EQ(judged["verdict"]["pairs"].size(), 1U);
  EXPECT_EQ(judged["verdict"]["starts"], 6);
}

TEST(CompareCommand, AsksForParityWhereLawsAreTheSame) {
  const auto same = engines_of_one_law();
  if (!same) GTEST_SKIP() << "no two engines of one law";
  const std::string compare = "compare --seconds .3 --engines " + *same;
  const ProgramResult judged = run_program(compare + " --verdict --require");
  EXPECT_EQ(judged.exit_code, 0) << judged.err;
  EXPECT_NE(judged.out.find("follow the same laws"), std::string::npos) << judged.out;
  const json result = run_json(compare + " --verdict");
  EXPECT_TRUE(result["pairs"][0]["same_laws"]);
  EXPECT_FALSE(result.contains("verdict"));
}

TEST(CompareCommand, RequiredParityIsNotMissedByChaos) {
  const auto same = engines_of_one_law();
  if (!same) GTEST_SKIP() << "no two engines of one law";
  // Tumbling over high bumps, rounding grows from 1e-15 m to beyond 1e-6 m within some seconds.
  const std::string compare =
      "compare --terrain rough:amplitude=.08 --gait trot:guide --seconds 10 --engines " + *same;
  const json result = run_json(compare);
  ASSERT_TRUE(result["pairs"][0]["first_divergence"].is_object()) << result["pairs"];
  EXPECT_LT(result["pairs"][0]["one_step"]["joint_rad"], 1e-9);
  EXPECT_GT(result["pairs"][0]["growth"]["per_half_second"], 1.5);
  const ProgramResult required = run_program(compare + " --require");
  EXPECT_EQ(required.exit_code, 0) << required.err;
}

TEST(CompareCommand, RequiresParityOfEnginesOfOneLawAlone) {
  if (!has_two_engines()) GTEST_SKIP() << "one engine alone";
  const std::string engines = available_engines().front() + "," + available_engines().back();
  if (find_engine(available_engines().front()).info.laws == find_engine(available_engines().back()).info.laws)
    GTEST_SKIP() << "all of one law";
  expect_bad_input("compare --require --engines " + engines, {"--require", "same laws"});
}

}  // namespace
}  // namespace crossgait
