// crossgait workspace and crossgait plot: what they report, that they draw, and messages for bad input.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "backends/registry.h"
#include "tests/apps/run_program.h"

namespace crossgait {
namespace {

using nlohmann::json;

bool can_draw() {
  return std::system("gnuplot --version >/dev/null 2>&1") == 0;
}  // NOLINT(concurrency-mt-unsafe)

void expect_picture(const std::string& name) {
  const std::string bytes = read_file(name);
  if (name.ends_with(".png")) {
    EXPECT_EQ(bytes.substr(0, 8), "\x89PNG\r\n\x1a\n") << name;
    EXPECT_EQ(bytes.substr(bytes.size() < 8 ? 0 : bytes.size() - 8, 4), "IEND") << name;
  } else {
    EXPECT_EQ(bytes.rfind("<?xml", 0), 0U) << name;
    EXPECT_NE(bytes.find("<svg"), std::string::npos) << name;
    EXPECT_NE(bytes.find("</svg>"), std::string::npos) << name;
  }
  std::filesystem::remove(name);
}

// Half a second of a walk; its name is the test's own, since tests run side by side.
class PlotTest : public testing::Test {
 protected:
  void SetUp() override {
    trace_ = std::string("plot_") + testing::UnitTest::GetInstance()->current_test_info()->name() + ".csv";
    ASSERT_EQ(run_program("walk --seconds .5 --set step_length=.07 --trace " + trace_ + " --backend " +
                          available_engines().front())
                  .exit_code,
              0);
  }
  void TearDown() override { std::filesystem::remove(trace_); }

  std::string trace_;
};

TEST(Workspace, ReportsWhatALegReaches) {
  const json result = run_json("workspace");
  EXPECT_EQ(result["leg"], "FL");
  EXPECT_EQ(result["gait"], "trot");
  // By hand: links of .045 and .060 m from a shoulder .010 m off the middle.
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

TEST(Workspace, DrawsPictures) {
  if (!can_draw()) GTEST_SKIP() << "gnuplot is not installed";
  for (const std::string name : {"plot_workspace.png", "plot_workspace.svg"}) {
    EXPECT_EQ(run_program("workspace --out " + name).exit_code, 0);
    expect_picture(name);
  }
}

TEST_F(PlotTest, DrawsEveryKind) {
  if (!can_draw()) GTEST_SKIP() << "gnuplot is not installed";
  // Panels as documented: one gait diagram, four of the base, one per leg, one per parameter that changes,
  // and of a walk none does.
  const int parameters = static_cast<int>(run_json("gait --parameters")["parameters"].size());
  const std::vector<std::pair<std::string, int>> kinds{{"gait", 1},
                                                       {"attitude", 4},
                                                       {"joints", 4},
                                                       {"feet", 4},
                                                       {"parameters --constant", parameters},
                                                       {"all", 13},
                                                       {"all --constant", 13 + parameters}};
  for (const auto& [what, panels] : kinds) {
    const std::string out = "plot_kind_" + std::to_string(panels) + ".svg";
    const json result = run_json("plot " + trace_ + " --what " + what + " --out " + out);
    EXPECT_EQ(result["panels"], panels) << what;
    EXPECT_EQ(result["rows"], 250) << what;
    expect_picture(out);
  }
}

TEST_F(PlotTest, HidesParametersThatNeverChangeAndSaysSo) {
  if (!can_draw()) GTEST_SKIP() << "gnuplot is not installed";
  expect_bad_input("plot " + trace_ + " --what parameters --out plot_hidden.svg", {trace_, "--constant"});
  ASSERT_EQ(
      run_program("rollout --policy random --adapt step_length --episodes 1 --episode-seconds .2 --trace " +
                  trace_)
          .exit_code,
      0);
  const std::string plot = "plot " + trace_ + " --what parameters --out plot_hidden.svg";
  const json result = run_json(plot);
  const std::size_t parameters = run_json("gait --parameters")["parameters"].size();
  EXPECT_EQ(result["panels"], 1);
  EXPECT_EQ(result["constant_parameters"].size(), parameters - 1);
  EXPECT_NE(run_program(plot).out.find("body_height"), std::string::npos);
  EXPECT_EQ(run_json(plot + " --constant")["panels"], parameters);
  std::filesystem::remove("plot_hidden.svg");
}

// Boxes of one colour in a picture.
std::size_t boxes(const std::string& picture, const std::string& colour) {
  const std::string text = read_file(picture);
  std::size_t count = 0;
  for (std::size_t at = text.find("<polygon"); at != std::string::npos; at = text.find("<polygon", at + 1)) {
    if (text.substr(at, text.find('>', at) - at).find(colour) != std::string::npos) ++count;
  }
  return count;
}

TEST(GaitDiagram, LeavesOutTouchesAndGapsThatNoFootMeant) {
  if (!can_draw()) GTEST_SKIP() << "gnuplot is not installed";
  // Steps of 10 ms. FL: a touch of 10 ms, then a stance with a gap of 10 ms in it. The others stand
  // throughout.
  std::string trace =
      "time,contact.FL,contact.FR,contact.RL,contact.RR,planned.FL,planned.FR,planned.RL,planned.RR\n";
  const std::string touches = "0010000111101111";
  for (std::size_t i = 0; i < touches.size(); ++i)
    trace += fmt::format("{},{},1,1,1,{},1,1,1\n", 0.01 * static_cast<double>(i), touches[i], i < 7 ? 0 : 1);
  write_file("plot_chatter.csv", trace);
  const std::string plot = "plot plot_chatter.csv --what gait --out plot_chatter.svg";
  const std::string actual = "rgb( 86, 180, 233)";
  ASSERT_EQ(run_program(plot).exit_code, 0);
  const std::size_t legend = 1;
  EXPECT_EQ(boxes("plot_chatter.svg", actual), 4 + legend);
  EXPECT_NE(read_file("plot_chatter.svg").find("under 20 ms left out"), std::string::npos);
  EXPECT_NE(read_file("plot_chatter.svg").find("planned stance"), std::string::npos);
  ASSERT_EQ(run_program(plot + " --shortest-contact 0").exit_code, 0);
  EXPECT_EQ(boxes("plot_chatter.svg", actual), 6 + legend);
  EXPECT_EQ(read_file("plot_chatter.svg").find("left out"), std::string::npos);
  std::filesystem::remove("plot_chatter.csv");
  std::filesystem::remove("plot_chatter.svg");
}

TEST_F(PlotTest, DrawsPng) {
  if (!can_draw()) GTEST_SKIP() << "gnuplot is not installed";
  const ProgramResult result = run_program("plot " + trace_ + " --what gait,feet --out plot_some.png");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("5 panels"), std::string::npos) << result.out;
  expect_picture("plot_some.png");
}

// A search path without programs, for as long as it lives.
class NoPrograms {
 public:
  NoPrograms() { setenv("PATH", "/nonexistent", 1); }  // NOLINT(concurrency-mt-unsafe)
  ~NoPrograms() { setenv("PATH", path_.c_str(), 1); }  // NOLINT(concurrency-mt-unsafe)
  NoPrograms(const NoPrograms&) = delete;
  NoPrograms& operator=(const NoPrograms&) = delete;

 private:
  const std::string path_ = std::getenv("PATH");  // NOLINT(concurrency-mt-unsafe)
};

TEST(PlotBadInput, SaysWhichPackageIsMissing) {
  write_file("plot_old.svg", "precious");
  {
    const NoPrograms none;
    expect_bad_input("workspace --out plot_old.svg", {"gnuplot-nox"});
  }
  EXPECT_EQ(read_file("plot_old.svg"), "precious");
  std::filesystem::remove("plot_old.svg");
}

TEST(PlotBadInput, NamesTheOption) {
  expect_bad_input("workspace --out picture.bmp", {"--out", ".svg", "picture.bmp"});
  expect_bad_input("workspace --leg XX", {"--leg", "XX"});
  expect_bad_input("workspace --mode 5", {"--mode", "5"});
  expect_bad_input("workspace --gait hop", {"hop", "trot"});
  expect_bad_input("workspace --set step_len=1", {"step_len"});
  expect_bad_input("workspace --robot nobody", {"nobody"});
  expect_bad_input("plot", {"trace"});
  expect_bad_input("plot missing.csv --out plot.svg", {"missing.csv"});
  write_file("plot_wide.csv", std::string(5000, ','));
  expect_bad_input("plot plot_wide.csv --out plot.svg", {"plot_wide.csv", "at most 4096 columns"});
  write_file("plot_long.csv", "time,a\n" + std::string(4000001, '\n'));
  expect_bad_input("plot plot_long.csv --out plot.svg", {"plot_long.csv", "at most 8000000 cells"});
  write_file("plot_name.csv", "time," + std::string(2 << 20, 'a') + "\n");
  expect_bad_input("plot plot_name.csv --out plot.svg", {"plot_name.csv", "line 1", "at most 1 MiB"});
  for (const char* file : {"plot_wide.csv", "plot_long.csv", "plot_name.csv"}) std::filesystem::remove(file);
  expect_bad_input("plot missing.csv --out plot.bmp", {"--out", "plot.bmp"});
  expect_bad_input("plot missing.csv --out plot.svg --what wings", {"--what", "wings", "feet"});
}

TEST(PlotBadInput, NamesLineAndColumn) {
  const std::string file = "plot_bad.csv";
  const std::string header = "time,contact.FL,contact.FR,contact.RL,contact.RR\n";
  const auto expect_bad = [&file](const std::string& text, const std::vector<std::string>& words,
                                  const std::string& what = "gait") {
    write_file(file, text);
    expect_bad_input("plot " + file + " --out plot_bad.svg --what " + what, words);
    EXPECT_FALSE(std::filesystem::exists("plot_bad.svg"));
  };
  expect_bad("", {file, "empty"});
  expect_bad(header, {file, "empty"});
  expect_bad(header + "0,1,1,1,1\n.1,1,x,1,1\n", {file, "line 3", "contact.FR", "\"x\""});
  expect_bad(header + "0,1,1,nan,1\n", {file, "line 2", "contact.RL", "nan"});
  expect_bad(header + "0,1,1,1\n", {file, "line 2", "5 cells", "4"});
  expect_bad(header + "0,1,1,1,1\n0,1,1,1,1\n", {file, "line 3", "time", "after 0"});
  expect_bad("t,contact.FL\n0,1\n", {file, "line 1", "\"time\""});
  expect_bad("time,time\n0,1\n", {file, "line 1", "column 2", "time"});
  expect_bad("time,contact.FL\n0,1\n", {file, "line 1", "contact.FR"});
  expect_bad(header + "0,1,1,1,1\n", {file, "param."}, "parameters");
  expect_bad(header + "0,1,1,1,1\n", {file, "q.FL_tilt"}, "joints");
  expect_bad(header + "0,1,1,1,1\n", {file, "q_WB.z"}, "attitude");
  std::filesystem::remove(file);
}

TEST(PlotBadInput, NamesOfColumnsAreNoGnuplotCommands) {
  if (!can_draw()) GTEST_SKIP() << "gnuplot is not installed";
  write_file("plot_quoted.csv", "time,param.it's `touch plot_touched` @x\n0,1\n1,2\n");
  const json result = run_json("plot plot_quoted.csv --what parameters --out plot_quoted.svg");
  EXPECT_EQ(result["panels"], 1);
  EXPECT_NE(read_file("plot_quoted.svg").find("`touch plot_touched` @x"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists("plot_touched"));
  std::filesystem::remove("plot_quoted.csv");
  expect_picture("plot_quoted.svg");
}

}  // namespace
}  // namespace crossgait
