// crossgait workspace and crossgait gait: what they report and what their pages show; messages for bad input.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "report/page_template.h"
#include "tests/apps/run_program.h"

namespace crossgait {
namespace {

using nlohmann::json;

TEST(Workspace, ReportsWhatALegReaches) {
  const json result = run_json("workspace");
  EXPECT_EQ(result["leg"], "FL");
  EXPECT_EQ(result["gait"], "trot");
  // By hand: links of 0.045 and 0.060 m from a shoulder 0.010 m off the middle.
  EXPECT_NEAR(result["reach_m"]["max"][0], 0.105 - 0.01, 1e-12);
  const double fraction = result["reachable_fraction"];
  EXPECT_GT(fraction, 0.1);
  EXPECT_LT(fraction, 0.9);
  EXPECT_EQ(result["standing_status"], "ok");
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_LE(result["safe_box_m"]["min"][axis], result["standing_foot_m"][axis]);
    EXPECT_GE(result["safe_box_m"]["max"][axis], result["standing_foot_m"][axis]);
  }
  for (const char* margin : {"joint_limit", "serial", "parallel"}) {
    // Standing in the middle of the stance is part of the cycle, up to the spacing of the targets.
    EXPECT_GE(result["standing_margins_rad"][margin].get<double>(),
              result["cycle_margins_rad"][margin].get<double>() - 1e-2)
        << margin;
  }
  EXPECT_EQ(result["cycle"]["unreachable"], 0);
  EXPECT_TRUE(result["cycle"]["first"].is_null());
}

TEST(Workspace, MarginsAgreeWithInverseKinematics) {
  const json result = run_json("workspace --leg RR --gait walk");
  const json& foot = result["standing_foot_m"];
  const json ik =
      run_json("ik --leg RR --target " + foot[0].dump() + "," + foot[1].dump() + "," + foot[2].dump());
  EXPECT_EQ(ik["margins_rad"], result["standing_margins_rad"]);
}

TEST(Workspace, BlamesTheParameterThatLeavesIt) {
  // A swing that lifts the foot by all of the body's height: to the shoulders, where the links cannot fold
  // to.
  const std::string command = "workspace --set swing=matched --set step_height=.09";
  const json result = run_json(command);
  EXPECT_GT(result["cycle"]["unreachable"], 0);
  EXPECT_EQ(result["cycle"]["offending"], json::array({"step_height"}));
  EXPECT_TRUE(result["cycle"]["first"].contains("target_m"));
  const ProgramResult text = run_program(command);
  EXPECT_NE(text.out.find("to blame: step_height"), std::string::npos) << text.out;
}

class ChartPages : public testing::Test {
 protected:
  void SetUp() override {
    if (page_template().empty()) GTEST_SKIP() << "built without the page";
  }
};

using Box = std::array<double, 4>;

Box bounds(const json& points) {
  Box box{HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  for (const json& p : points) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
      box[axis] = std::min(box[axis], p.at(axis).get<double>());
      box[axis + 2] = std::max(box[axis + 2], p.at(axis).get<double>());
    }
  }
  return box;
}

TEST_F(ChartPages, OfAWorkspaceShowWhatItsResultSays) {
  const std::string page = "workspace_page.html", result_file = "workspace_page.json";
  ASSERT_EQ(run_program("workspace --leg RR --report " + page + " --json " + result_file).exit_code, 0);
  ASSERT_EQ(run_program("report " + result_file + " --out workspace_again.html").exit_code, 0);
  const json document = document_of(page), result = json::parse(read_file(result_file));
  EXPECT_EQ(document.at("charts"), document_of("workspace_again.html").at("charts"));
  const json& charts = document.at("charts").at(0).at("charts");
  ASSERT_EQ(charts.size(), 2U);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const json& chart = charts.at(axis);
    EXPECT_TRUE(chart.at("equal_scales"));
    const json &box = chart.at("boxes").at(0).at("boxes").at(0), &path = chart.at("series").at(0),
               &foot = chart.at("series").at(1), &shades = chart.at("shades");
    EXPECT_EQ(path.at("style"), "path");
    const Box around = bounds(path.at("points"));
    // x or y, and z, in mm; nothing but the unit's factor is rounded.
    for (const auto& [shown, of] : {std::pair<std::size_t, std::size_t>{0, axis}, {1, 2}}) {
      const auto metres = [of = of](const json& values) { return 1e3 * values.at(of).get<double>(); };
      EXPECT_DOUBLE_EQ(foot.at("points").at(0).at(shown), metres(result.at("standing_foot_m")));
      EXPECT_DOUBLE_EQ(box.at(shown), metres(result.at("safe_box_m").at("min")));
      EXPECT_DOUBLE_EQ(box.at(shown + 2), metres(result.at("safe_box_m").at("max")));
      EXPECT_DOUBLE_EQ(around[shown], metres(result.at("foot_path_m").at("min")));
      EXPECT_DOUBLE_EQ(around[shown + 2], metres(result.at("foot_path_m").at("max")));
      EXPECT_DOUBLE_EQ(shades.at("min").at(shown), metres(result.at("reach_m").at("min")));
      EXPECT_DOUBLE_EQ(shades.at("max").at(shown), metres(result.at("reach_m").at("max")));
    }
    EXPECT_EQ(shades.at("values").at("count").get<int>(),
              shades.at("count").at(0).get<int>() * shades.at("count").at(1).get<int>());
  }
  for (const char* file : {"workspace_page.html", "workspace_page.json", "workspace_again.html"})
    std::filesystem::remove(file);
}

TEST_F(ChartPages, OfAGaitShowWhatItsResultSays) {
  const std::string gait = "gait --gait walk --dt .01 --report gait_page.html";
  const json samples = run_json(gait).at("samples"), document = document_of("gait_page.html");
  const json &steps = document.at("charts").at(0).at("charts").at(0),
             &paths = document.at("charts").at(1).at("charts"),
             &up = document.at("charts").at(2).at("charts").at(2);
  ASSERT_EQ(paths.size(), 4U);
  const double end = samples.back().at("t");
  for (std::size_t leg = 0; leg < 4; ++leg) {
    const std::string name = steps.at("y_names").at(leg).at(1);
    const json& path = paths.at(leg).at("series").at(0).at("points");
    EXPECT_TRUE(paths.at(leg).at("equal_scales"));
    ASSERT_EQ(path.size(), samples.size());
    double standing = 0, drawn = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const json& foot = samples.at(i).at(name);
      EXPECT_EQ(path.at(i).at(0), 1e3 * foot.at("position_m").at(0).get<double>());
      EXPECT_EQ(path.at(i).at(1), 1e3 * foot.at("position_m").at(2).get<double>());
      EXPECT_EQ(up.at("series").at(leg).at("points").at(i).at(1), path.at(i).at(1));
      if (!foot.at("swing").get<bool>() && i + 1 < samples.size())
        standing += samples.at(i + 1).at("t").get<double>() - samples.at(i).at("t").get<double>();
    }
    for (const json& box : steps.at("boxes").at(0).at("boxes")) {
      const double row = (box.at(1).get<double>() + box.at(3).get<double>()) / 2;
      if (std::lround(row) == static_cast<long>(leg))
        drawn += box.at(2).get<double>() - box.at(0).get<double>();
    }
    EXPECT_NEAR(drawn, standing, 1e-12 * end) << name;  // sums of a hundred times
    EXPECT_GT(drawn, 0.5 * end) << "a walk stands for most of its cycle";
  }
  std::filesystem::remove("gait_page.html");
}

TEST(WorkspaceBadInput, NamesTheOption) {
  expect_bad_input("workspace --leg XX", {"--leg", "XX"});
  expect_bad_input("workspace --mode 5", {"--mode", "5"});
  expect_bad_input("workspace --gait hop", {"hop", "trot"});
  expect_bad_input("workspace --set step_len=1", {"step_len"});
  expect_bad_input("workspace --robot nobody", {"nobody"});
  expect_bad_input("workspace --report nowhere/at/all.html", {"nowhere/at"});
  expect_bad_input("gait --list --report gait_never.html", {"--list", "--report"});
}

}  // namespace
}  // namespace crossgait
