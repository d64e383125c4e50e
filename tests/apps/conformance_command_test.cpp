// crossgait conformance: what it prints, and how it ends.
#include <cstdlib>

#include <gtest/gtest.h>

#include "backends/registry.h"
#include "conformance/card.h"
#include "tests/apps/run_program.h"

namespace crossgait {
namespace {

TEST(ConformanceCommand, PrintsACardOfTheChosenChecks) {
  const auto result =
      run_program("conformance --only free_fall,push --engine " + available_engines().front());
  EXPECT_EQ(result.exit_code, 0) << result.err;
  for (const char* said :
       {"passed  free_fall: ", "passed  push: ", "\n2 checks passed, 0 failed, 0 skipped\n"})
    EXPECT_NE(result.out.find(said), std::string::npos) << said << " in\n" << result.out;
  EXPECT_EQ(result.out.find("tumbling"), std::string::npos) << result.out;
}

TEST(ConformanceCommand, EndsWithOneWhereACheckFails) {
  setenv("CROSSGAIT_ENGINE_PATH", CROSSGAIT_TEST_PLUGINS, 1);  // an engine of stone, which does not fall
  const auto result = run_program("conformance --engine stone@1 --only mass_properties,free_fall,standing");
  unsetenv("CROSSGAIT_ENGINE_PATH");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.out.find("1 check passed, 2 failed (free_fall, standing), 0 skipped"), std::string::npos)
      << result.out;
  EXPECT_NE(result.err.find("stone@1: 2 checks failed"), std::string::npos) << result.err;
}

TEST(ConformanceCommand, ListsWhatTheGuideSays) {
  EXPECT_EQ(run_program("conformance --list").out, conformance::markdown_of_checks(conformance::topics()));
}

TEST(ConformanceCommand, RefusesWhatIsNotThere) {
  expect_bad_input("conformance", {"--engine", available_engines().front()});
  expect_bad_input("conformance --engine abacus", {"abacus", available_engines().front()});
  expect_bad_input("conformance --only fre_fall --engine " + available_engines().front(),
                   {"only", "fre_fall"});
  expect_bad_input("conformance --list --only free_fall", {"--list", "--only"});
}

}  // namespace
}  // namespace crossgait
