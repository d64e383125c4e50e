// `crossgait report` and `--report`: the page that is written, and what is refused.
#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "backends/registry.h"
#include "report/page_template.h"
#include "tests/apps/run_program.h"

namespace crossgait {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

class Report : public testing::Test {
 protected:
  void SetUp() override {
    if (page_template().empty()) GTEST_SKIP() << "built without the page";
    if (available_engines().empty()) GTEST_SKIP() << "no engine";
  }
};

TEST_F(Report, AWalkAndItsResultGiveTheSamePage) {
  ASSERT_EQ(run_program("walk --seconds .3 --report report_walk.html --json report_walk.json").exit_code, 0);
  const ProgramResult again = run_program("report report_walk.json --out report_again.html");
  ASSERT_EQ(again.exit_code, 0) << again.err;
  json one = document_of("report_walk.html"), two = document_of("report_again.html");
  // Nothing but the time of the clock, in the table, differs.
  for (json* document : {&one, &two})
    document->at("tables").at(0).at("rows").erase(document->at("tables").at(0).at("rows").size() - 1);
  EXPECT_EQ(one, two);
  EXPECT_EQ(one.at("motions").at(0).at("runs").size(), 1U);
  EXPECT_EQ(one.at("provenances").at(0).at("command"), "walk");
  const std::string first = read_file("report_walk.html"), second = read_file("report_again.html");
  EXPECT_EQ(first.substr(first.find("id=\"numbers\"")), second.substr(second.find("id=\"numbers\"")));
}

TEST_F(Report, TracesOfSeveralRunsAreReplayedTogether) {
  ASSERT_EQ(
      run_program("walk --seconds .3 --terrain rough --trace report_a.csv --json report_a.json").exit_code,
      0);
  ASSERT_EQ(
      run_program("walk --seconds .3 --terrain rough --set step_length=.05 --trace report_b.csv").exit_code,
      0);
  const ProgramResult result =
      run_program("report report_a.csv report_b.csv report_a.json --terrain rough --out report_traces.html");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json document = document_of("report_traces.html");
  EXPECT_EQ(document.at("motions").at(0).at("runs").at(1).at("name"), "report_b");
  EXPECT_TRUE(document.at("motions").at(0).at("runs").at(0).at("force_directions"));
  EXPECT_FALSE(document.at("motions").at(0).at("pairs").at(0).at("parting").at("time_s").is_null());
  EXPECT_FALSE(document.at("motions").at(0).at("scene").at("ground").is_null());
  EXPECT_EQ(document.at("tables").at(0).at("header").size(), 2U);
}

TEST_F(Report, LeavesOutTouchesOfATraceThatAreShorterThanAsked) {
  ASSERT_EQ(run_program("walk --seconds 1 --terrain rough --trace report_touches.csv").exit_code, 0);
  std::vector<std::size_t> stances;
  for (const char* shortest : {"", " --shortest-contact 0", " --shortest-contact 1"}) {
    const std::string report = "report report_touches.csv --out report_touches.html";
    ASSERT_EQ(run_program(report + shortest).exit_code, 0);
    const json motion = document_of("report_touches.html").at("motions").at(0);
    std::size_t& count = stances.emplace_back(0);
    for (const json& leg : motion.at("runs").at(0).at("contact")) count += leg.size() / 2;
  }
  EXPECT_GT(stances[1], stances[0]) << "feet chatter on rough ground";
  EXPECT_GT(stances[0], stances[2]);
  expect_bad_input("report report_touches.csv --out x.html --shortest-contact 2",
                   {"--shortest-contact", "2"});
}

TEST_F(Report, AComparisonShowsWhatItSays) {
  if (available_engines().size() < 2) GTEST_SKIP() << "one engine";
  ASSERT_EQ(
      run_program("compare --seconds .3 --report report_compare.html --json report_compare.json").exit_code,
      0);
  const json document = document_of("report_compare.html"),
             result = json::parse(read_file("report_compare.json"));
  const json& pairs = document.at("motions").at(0).at("pairs");
  ASSERT_EQ(pairs.size(), result.at("pairs").size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const json& pair = result.at("pairs")[i];
    EXPECT_EQ(pairs[i].at("parting").at("standing_m"), pair.at("standing_difference_m"));
    EXPECT_EQ(pairs[i].at("parting").at("time_s").is_null(), pair.at("parted_at_s").is_null());
  }
  EXPECT_EQ(document.at("summary"), result.at("summary"));
  const json& groups = document.at("groups");
  ASSERT_EQ(groups.size(), result.at("groups").size());
  for (std::size_t i = 0; i < groups.size(); ++i) EXPECT_EQ(groups[i], result.at("groups")[i].at("sentence"));
  // Engines that are one group are those that the page draws once.
  std::size_t same = 0, grouped = 0;
  for (const json& pair : pairs) same += pair.at("same").get<bool>();
  for (const json& group : result.at("groups")) {
    const std::size_t n = group.at("engines").size();
    grouped += n * (n - 1) / 2;
  }
  EXPECT_EQ(same, grouped);
}

TEST_F(Report, AVerdictAndItsResultGiveTheSamePage) {
  if (available_engines().size() < 2) GTEST_SKIP() << "one engine";
  const std::string verdict = "verdict --seconds .1 --settle .1 --starts 4";
  ASSERT_EQ(run_program(verdict + " --report report_v.html --json report_v.json").exit_code, 0);
  ASSERT_EQ(run_program("report report_v.json --out report_v_again.html").exit_code, 0);
  const json document = document_of("report_v.html");
  EXPECT_EQ(document, document_of("report_v_again.html"));
  EXPECT_EQ(document.at("verdicts").at(0).at("statistics").size(),
            json::parse(read_file("report_v.json")).at("pairs").at(0).at("statistics").size());
  EXPECT_TRUE(document.at("motions").empty());
}

TEST_F(Report, ARolloutReplaysEveryPolicyAndWhatItEarned) {
  const std::string rollout = "rollout --policy random --baseline --episodes 2 --episode-seconds .3";
  ASSERT_EQ(run_program(rollout + " --report report_r.html --json report_r.json").exit_code, 0);
  ASSERT_EQ(run_program("report report_r.json --out report_r_again.html").exit_code, 0);
  const json document = document_of("report_r.html"), result = json::parse(read_file("report_r.json"));
  EXPECT_EQ(document, document_of("report_r_again.html"));
  const json& runs = document.at("motions").at(0).at("runs");
  ASSERT_EQ(runs.size(), 2U);
  EXPECT_EQ(runs.at(0).at("name"), "random");
  EXPECT_EQ(runs.at(1).at("name"), "zero");
  EXPECT_EQ(document.at("tables").at(0).at("header").size(), 3U);
  std::size_t terms = 0;
  for (const json& panel : document.at("motions").at(0).at("panels")) {
    if (panel.at("group") != "rewards") continue;
    ++terms;
    EXPECT_EQ(panel.at("series").size(), 2U);
  }
  EXPECT_EQ(terms, result.at("policies").at(0).at("all").at("reward_terms").size());
}

TEST_F(Report, ATransferReplaysEveryEngine) {
  const std::string transfer = "transfer --terrains rough --episodes 1 --episode-seconds .3";
  ASSERT_EQ(run_program(transfer + " --report report_t.html --json report_t.json").exit_code, 0);
  const json document = document_of("report_t.html");
  const std::vector<std::string> engines = available_engines();
  ASSERT_EQ(document.at("motions").at(0).at("runs").size(), engines.size());
  for (std::size_t i = 0; i < engines.size(); ++i)
    EXPECT_EQ(document.at("motions").at(0).at("runs").at(i).at("name"), engines[i]);
  EXPECT_FALSE(document.at("motions").at(0).at("scene").at("ground").is_null());
}

TEST_F(Report, ATunedGaitStandsBesideTheOneItWasMadeFrom) {
  const std::string tune =
      "tune --terrain flat --episode-seconds .3 --iterations 2 --population 4 --terrains 1 --unseen 0 "
      "--adapt step_length";
  ASSERT_EQ(run_program(tune + " --report report_u.html --json report_u.json").exit_code, 0);
  const json document = document_of("report_u.html"), result = json::parse(read_file("report_u.json"));
  ASSERT_EQ(document.at("motions").at(0).at("runs").size(), 2U);
  EXPECT_EQ(document.at("motions").at(0).at("runs").at(1).at("name"), "tuned");
  EXPECT_EQ(document.at("tables").size(), 2U);
  const json& points = document.at("charts").at(0).at("charts").at(0).at("series").at(0).at("points");
  ASSERT_EQ(points.size(), result.at("history").size());
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(points[i].at(1), result.at("history")[i]);
}

TEST_F(Report, ABenchmarkShowsItsCurves) {
  const std::string stored = std::string(CROSSGAIT_SOURCE_DIR) + "/benchmarks/results/amd-epyc-2-cores.json";
  ASSERT_EQ(run_program("bench --from " + stored + " --report report_b.html").exit_code, 0);
  ASSERT_EQ(run_program("report " + stored + " --out report_b_again.html").exit_code, 0);
  const json document = document_of("report_b.html"), result = json::parse(read_file(stored));
  EXPECT_EQ(document.at("charts"), document_of("report_b_again.html").at("charts"));
  std::size_t points = 0;  // of the position's errors, one for each that is known
  for (const json& chart : document.at("charts").at(1).at("charts")) {
    if (!chart.at("title").get<std::string>().starts_with("base")) continue;
    for (const json& series : chart.at("series")) points += series.at("points").size();
  }
  std::size_t known = 0;
  for (const json& point : result.at("accuracy").at("points"))
    known += point.at("position_error_m").is_null() ? 0 : 1;
  EXPECT_EQ(points, known);
  EXPECT_FALSE(document.at("texts").empty());
  // A bar for every share of an engine, as long as it is.
  const json& eta = result.at("speed").at("eta");
  std::vector<double> shares, bars;
  for (const json& r : eta) shares.push_back(r.at("eta"));
  for (const json& boxes : document.at("charts").at(0).at("charts").at(1).at("boxes")) {
    for (const json& box : boxes.at("boxes")) bars.push_back(box.at(2));
  }
  std::sort(shares.begin(), shares.end());
  std::sort(bars.begin(), bars.end());
  EXPECT_EQ(bars, shares);
  std::vector<std::string> titles;
  for (const json& section : document.at("charts")) titles.push_back(section.at("title"));
  ASSERT_EQ(titles.size(), 4U);
  EXPECT_EQ(titles[0], "Speed");
  EXPECT_TRUE(titles[1].starts_with("Speed against accuracy")) << titles[1];
  EXPECT_EQ(titles[2], "Errors against closed forms");
  EXPECT_EQ(titles[3], "Feet");
}

TEST_F(Report, ARobotWithAHostileNameIsShownNotRun) {
  const std::string folder = std::string(CROSSGAIT_SOURCE_DIR) + "/models/robots/scara_quadruped/";
  std::string yaml = read_file(folder + "robot.yaml");
  const std::string name = "name: scara_quadruped\nurdf: robot.urdf";
  ASSERT_NE(yaml.find(name), std::string::npos);
  yaml.replace(yaml.find(name), name.size(),
               "name: \"</script><script>alert(1)</script>\"\nurdf: " + folder + "robot.urdf");
  write_file("report_hostile.yaml", yaml);
  const ProgramResult result =
      run_program("walk --seconds .1 --robot report_hostile.yaml --report report_hostile.html");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(read_file("report_hostile.html").find("<script>alert"), std::string::npos);
  EXPECT_EQ(document_of("report_hostile.html").at("motions").at(0).at("scene").at("robot"),
            "</script><script>alert(1)</script>");
}

TEST_F(Report, BadInputLeavesNoPage) {
  write_file("report_broken.json", "{\"schema\": ");
  write_file("report_other.json", R"({"schema": {"name": "ik", "version": "draft"}})");
  write_file("report_none.json", "{}");
  write_file("report_verdict.json",
             R"({"schema": {"name": "verdict", "version": "draft"}, "statistics": [{}]})");
  write_file("report_walk_alone.json", R"({"schema": {"name": "walk", "version": "draft"}})");
  write_file(
      "report_walk_as_tune.json",
      R"({"schema": {"name": "walk", "version": "draft"}, "provenance": {"command": "tune", "arguments": []}})");
  write_file("report_short.csv", "time,q.a\n0,1\n1\n");
  write_file("report_strange.csv", "time,q.a\n0,1\n");
  const std::string out = " --out report_never.html";
  expect_bad_input("report report_broken.json" + out, {"report_broken.json", "JSON"});
  expect_bad_input("report report_other.json report_none.json" + out,
                   {"report_other.json", "schema.name", "ik"});
  expect_bad_input("report report_none.json" + out, {"report_none.json", "schema"});
  expect_bad_input("report report_verdict.json" + out, {"report_verdict.json", "verdict"});
  expect_bad_input("report report_walk_alone.json" + out, {"report_walk_alone.json", "provenance"});
  expect_bad_input("report report_walk_as_tune.json" + out, {"provenance.command", "tune"});
  expect_bad_input("report report_short.csv" + out, {"report_short.csv", "line 3"});
  expect_bad_input("report report_strange.csv" + out, {"report_strange.csv", "p_WB.x"});
  expect_bad_input("report no_such.csv" + out, {"no_such.csv"});
  ASSERT_EQ(run_program("rollout --episodes 1 --episode-seconds .1 --json report_rollout.json").exit_code, 0);
  ASSERT_EQ(run_program("walk --seconds .1 --json report_w.json").exit_code, 0);
  expect_bad_input("report report_rollout.json report_w.json" + out, {"report_rollout.json", "rollout"});
  expect_bad_input("rollout --episode-seconds 300 --report report_never.html",
                   {"--report", "--episode-seconds"});
  expect_bad_input("walk --seconds 300 --report report_never.html", {"--report", "200 s", "300 s"});
  EXPECT_FALSE(fs::exists("report_never.html"));
}

TEST(ReportWithoutAPage, SaysSo) {
  if (!page_template().empty()) GTEST_SKIP() << "built with the page";
  expect_bad_input("walk --seconds .1 --report no_page.html", {"report", "Node.js", "CROSSGAIT_WITH_PAGE"});
}

}  // namespace
}  // namespace crossgait
