// What worlds of every engine leave to the process that made them, and to the machine if that is killed.
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "scenes/scenes.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

namespace fs = std::filesystem;

class EngineProcess : public EngineTest {
 protected:
  static std::unique_ptr<PhysicsBackend> standing() {
    auto world = make(scenes::quadruped());
    EXPECT_EQ(world->step(scenes::home_targets(world->robot()), 20), StepStatus::kOk);
    return world;
  }
};
CROSSGAIT_FOR_EVERY_BACKEND(EngineProcess);

// Of malloc, mapped pieces included.
std::size_t bytes_in_use() {
  const struct mallinfo2 info = ::mallinfo2();
  return info.uordblks + info.hblkhd;
}

TEST_P(EngineProcess, GetsTheMemoryOfItsWorldsBack) {
  if (bytes_in_use() == 0) GTEST_SKIP() << "a sanitizer's allocator, which looks for leaks itself";
  for (int i = 0; i < 5; ++i) standing();  // what an engine keeps for the next world
  const std::size_t before = bytes_in_use();
  std::size_t with_one = 0;
  constexpr std::size_t kWorlds = 300;
  for (std::size_t i = 0; i < kWorlds; ++i) {
    const auto world = standing();
    with_one = bytes_in_use();
  }
  const std::size_t after = bytes_in_use();
  ASSERT_GT(with_one, before + 100'000);  // a world is seen at all
  // Less than an object of 100 bytes lost with every world. Pieces that malloc keeps for the next who asks
  // count as in use: 16 kB of them after 40 worlds, and after 800.
  EXPECT_LT(after, before + 100 * kWorlds);
}

// Walks in `folder` until it is killed, `milliseconds` after its first step.
void walk_and_be_killed(const std::string& engine, const fs::path& folder, int milliseconds) {
  ::setenv("TMPDIR", folder.c_str(), 1);
  fs::current_path(folder);
  const auto world = make_world(engine, scenes::world_of(scenes::quadruped()));
  const scenes::Trot motion(world->robot());
  for (int i = 0;; ++i) {
    if (world->step(motion.targets(i * world->spec().physics_dt)) != StepStatus::kOk) return;
    if (i == 0) {
      std::thread([milliseconds] {
        std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
        ::kill(::getpid(), SIGKILL);
      }).detach();
    }
  }
}

TEST_P(EngineProcess, LeavesNothingWhereItIsKilled) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");  // in a program of its own, as PhysX refuses a fork
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);              // what a killed process had started is this one's then
  const fs::path folder = fs::current_path() / ("killed_" + test_name(GetParam()));
  fs::create_directory(folder);
  for (int kills = 0; kills < 5; ++kills)
    EXPECT_EXIT(walk_and_be_killed(GetParam(), folder, 2 * kills), ::testing::KilledBySignal(SIGKILL), "");
  EXPECT_TRUE(fs::is_empty(folder));
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "a process that it had started lives on";
  fs::remove_all(folder);
}

}  // namespace
}  // namespace crossgait
