// `crossgait bench` as its users run it. How long anything takes is never looked at.
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

bool has_gnuplot() { return std::system("gnuplot --version > /dev/null 2>&1") == 0; }

TEST(Bench, MeasuresStoresComparesAndDraws) {
  const std::string engine = available_engines().front();
  const ProgramResult first =
      run_program("bench --quick --only analytic --backend " + engine + " --json bench_app.json");
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_NE(first.out.find("pendulum_period"), std::string::npos);

  // Analytic errors are the same on every run.
  const ProgramResult again = run_program("bench --quick --only analytic --backend " + engine +
                                          " --compare bench_app.json --worse-than 1.001 --json -");
  ASSERT_EQ(again.exit_code, 0) << again.err;
  const json result = json::parse(again.out);
  EXPECT_EQ(result["comparison"]["worse"].size(), 0U);
  EXPECT_GT(result["comparison"]["compared"], 10);
  EXPECT_FALSE(result.contains("speed"));

  if (!has_gnuplot()) GTEST_SKIP() << "no gnuplot: no figures";
  const ProgramResult drawn = run_program("bench --from bench_app.json --figures bench_app_figures");
  EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_TRUE(fs::exists("bench_app_figures/analytic.svg"));
  EXPECT_FALSE(fs::exists("bench_app_figures/speed.svg"));
  EXPECT_EQ(run_program("bench --from bench_app.json --figures bench_app_figures --format png").exit_code, 0);
  EXPECT_EQ(read_file("bench_app_figures/analytic.png").substr(0, 4), "\x89PNG");
  fs::remove_all("bench_app_figures");
  fs::remove("bench_app.json");
}

TEST(Bench, FailsWhereAFigureGotWorse) {
  const std::string engine = available_engines().front();
  const ProgramResult first =
      run_program("bench --quick --only analytic --backend " + engine + " --json bench_worse.json");
  ASSERT_EQ(first.exit_code, 0) << first.err;
  json better;
  std::ifstream("bench_worse.json") >> better;
  for (json& error : better["analytic"]["convergence"][0]["error"]) error = error.get<double>() / 10;
  std::ofstream("bench_better.json") << better;
  const ProgramResult compared = run_program("bench --from bench_worse.json --compare bench_better.json");
  EXPECT_EQ(compared.exit_code, 1);
  EXPECT_NE(compared.out.find("free_fall"), std::string::npos) << compared.out;
  EXPECT_NE(compared.err.find("worse"), std::string::npos);
  EXPECT_EQ(
      run_program("bench --from bench_worse.json --compare bench_better.json --worse-than 11").exit_code, 0);
  fs::remove("bench_worse.json");
  fs::remove("bench_better.json");
}

TEST(Bench, StoredResultsOfTheProjectAreReadAndDrawn) {
  int files = 0;
  for (const auto& entry :
       fs::directory_iterator(fs::path(CROSSGAIT_SOURCE_DIR) / "benchmarks" / "results")) {
    if (entry.path().extension() != ".json") continue;
    ++files;
    const ProgramResult shown =
        run_program("bench --from '" + entry.path().string() + "' --compare '" + entry.path().string() + "'");
    EXPECT_EQ(shown.exit_code, 0) << shown.err;
    for (const char* word : {"trot_rough", "eta", "largest stable step", "tumbling_energy", "creep"}) {
      EXPECT_NE(shown.out.find(word), std::string::npos) << word;
    }
    if (!has_gnuplot()) continue;
    const ProgramResult drawn =
        run_program("bench --from '" + entry.path().string() + "' --figures bench_stored_figures");
    EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
    for (const char* name : {"speed", "accuracy", "analytic", "feet"}) {
      EXPECT_TRUE(fs::exists("bench_stored_figures/" + std::string(name) + ".svg")) << name;
    }
    fs::remove_all("bench_stored_figures");
  }
  EXPECT_GE(files, 1);
}

TEST(Bench, NamesWhatWasWrong) {
  expect_bad_input("bench --only beauty", {"beauty", "analytic"});
  expect_bad_input("bench --only feet --only feet", {"feet", "again"});
  expect_bad_input("bench --backend nonsense", {"nonsense", available_engines().front()});
  expect_bad_input("bench --compare bench_nowhere.json", {"bench_nowhere.json"});
  expect_bad_input("bench --from bench_nowhere.json", {"bench_nowhere.json"});
  expect_bad_input("bench --from x.json --quick", {"--quick"});
  expect_bad_input("bench --from x.json --format bmp", {"--format", "bmp", "png"});
  expect_bad_input("bench --worse-than .5", {"--worse-than", "0.5"});
  expect_bad_input("bench --worse-than soon", {"--worse-than"});
  std::ofstream("bench_broken.json") << "{\"schema\": \"crossgait-bench\", \"version\": 1, \"backends\": 3}";
  expect_bad_input("bench --from bench_broken.json", {"bench_broken.json"});
  fs::remove("bench_broken.json");
}

}  // namespace
}  // namespace crossgait
