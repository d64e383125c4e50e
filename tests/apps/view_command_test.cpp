// `crossgait view` as a person runs it; what its server does is in tests/view.
#include <csignal>

#include <gtest/gtest.h>

#include "tests/apps/run_program.h"

namespace crossgait {
namespace {

TEST(ViewCommandLine, RefusesWhatItCannotBeginWith) {
  for (const char* arguments : {"view --engines none_such", "view --gait hop", "view --port 70000",
                                "view --port -1", "view --terrain sea", "view --robot none_such"}) {
    const ProgramResult result = run_program(arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments;
    EXPECT_EQ(result.out, "") << arguments;
  }
}

TEST(ViewCommandLine, SaysItsAddressAndEndsWithASignal) {
  const std::string missing = run_program("view --engines none_such").err;
  if (missing.find("view: engines") == std::string::npos) GTEST_SKIP() << missing;  // no server, or no page
  const ProgramResult result = run_watched("view", SIGINT, 0.02);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(result.out.starts_with("http://127.0.0.1:")) << result.out;
}

}  // namespace
}  // namespace crossgait
