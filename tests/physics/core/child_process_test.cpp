#include "physics/core/child_process.h"

#include <csignal>

#include <gtest/gtest.h>

namespace crossgait {
namespace {

TEST(ChildProcess, KeepsWhatItSays) {
  const auto done = run_child({"sh", "-c", "echo out; echo errors >&2; exit 3"});
  ASSERT_TRUE(done);
  EXPECT_EQ(done->exit_code, 3);
  EXPECT_EQ(done->out, "out\n");
  EXPECT_EQ(done->errors, "errors\n");
  EXPECT_FALSE(done->over_limit);
  EXPECT_FALSE(run_child({"crossgait-no-such-program"}));
  EXPECT_EQ(run_child({"sh", "-c", "kill -9 $$"})->exit_code, -1);
}

TEST(ChildProcess, IsHandedSignalsOn) {
  static int raised;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    raised = 0;
    const auto before = std::signal(signal, [](int number) { raised = number; });
    // It ends by the signal of its parent, which nobody sends to it.
    const std::string name = signal == SIGINT ? "INT" : signal == SIGTERM ? "TERM" : "HUP";
    const auto done =
        run_child({"bash", "-c", "trap 'exit 7' " + name + "; kill -" + name + " $PPID; sleep 20 & wait"},
                  ChildErrors::kShown, std::nullopt, ChildSignals::kHandedOn);
    std::signal(signal, before);
    ASSERT_TRUE(done);
    EXPECT_EQ(done->exit_code, 7);
    EXPECT_EQ(raised, signal);  // and then by its own
  }
}

constexpr ChildLimits kLimits{std::chrono::seconds(1), 100'000};

TEST(ChildProcess, IsLeftAloneWithinItsLimits) {
  const auto done = run_child({"sh", "-c", "echo out"}, ChildErrors::kKept, kLimits);
  ASSERT_TRUE(done);
  EXPECT_EQ(done->exit_code, 0);
  EXPECT_EQ(done->out, "out\n");
  EXPECT_FALSE(done->over_limit);
}

/// One that waits, one that computes and one that writes.
TEST(ChildProcess, IsEndedBeyondThem) {
  for (const char* command : {"exec sleep 600", "while :; do :; done", "exec yes"}) {
    const auto done = run_child({"sh", "-c", command}, ChildErrors::kKept, kLimits);
    ASSERT_TRUE(done) << command;
    EXPECT_TRUE(done->over_limit) << command;
    EXPECT_LE(done->out.size(), kLimits.bytes) << command;
  }
}

}  // namespace
}  // namespace crossgait
