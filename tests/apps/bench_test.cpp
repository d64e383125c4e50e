// `crossgait bench` as its users run it. How long anything takes is never looked at.
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
namespace fs = std::filesystem;

TEST(Bench, MeasuresStoresComparesAndShows) {
  const std::string engine = available_engines().front();
  const ProgramResult first =
      run_program("bench --quick --only analytic --engine " + engine + " --json bench_app.json");
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_NE(first.out.find("pendulum_period"), std::string::npos);

  // Analytic errors are the same on every run.
  const ProgramResult again = run_program("bench --quick --only analytic --engine " + engine +
                                          " --compare bench_app.json --worse-than 1.001 --json -");
  ASSERT_EQ(again.exit_code, 0) << again.err;
  const json result = json::parse(again.out);
  EXPECT_EQ(result["comparison"]["worse"].size(), 0U);
  EXPECT_GT(result["comparison"]["compared"], 10);
  EXPECT_FALSE(result.contains("speed"));

  if (page_template().empty()) GTEST_SKIP() << "built without the page";
  const ProgramResult drawn = run_program("bench --from bench_app.json --report bench_app.html");
  EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
  const json charts = document_of("bench_app.html").at("charts");
  ASSERT_EQ(charts.size(), 1U) << "a group for what was measured alone";
  EXPECT_EQ(charts.at(0).at("title"), "Errors against closed forms");
  fs::remove("bench_app.html");
  fs::remove("bench_app.json");
}

TEST(Bench, FailsWhereAFigureGotWorse) {
  const std::string engine = available_engines().front();
  const ProgramResult first =
      run_program("bench --quick --only analytic --engine " + engine + " --json bench_worse.json");
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

TEST(Bench, StoredResultsOfTheProjectAreRead) {
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
  }
  EXPECT_GE(files, 1);
}

TEST(Bench, NamesWhatWasWrong) {
  expect_bad_input("bench --only beauty", {"beauty", "analytic"});
  expect_bad_input("bench --only feet --only feet", {"feet", "again"});
  expect_bad_input("bench --engine nonsense", {"nonsense", available_engines().front()});
  expect_bad_input("bench --compare bench_nowhere.json", {"bench_nowhere.json"});
  expect_bad_input("bench --from bench_nowhere.json", {"bench_nowhere.json"});
  expect_bad_input("bench --from x.json --quick", {"--quick"});
  expect_bad_input("bench --worse-than .5", {"--worse-than", "0.5"});
  expect_bad_input("bench --worse-than soon", {"--worse-than"});
  std::ofstream("bench_broken.json") << "{\"schema\": \"crossgait-bench\", \"version\": 1, \"engines\": 3}";
  expect_bad_input("bench --from bench_broken.json", {"bench_broken.json"});
  fs::remove("bench_broken.json");
}

}  // namespace
}  // namespace crossgait
