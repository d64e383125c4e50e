// Engines in processes of their own: what they may do wrong at any moment is a clear error, in time, and
// leaves nothing.
#include "backends/served_engine.h"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "backends/served_memory.h"
#include "physics/core/interruption.h"
#include "physics/core/progress.h"
#include "physics/core/served_process.h"
#include "physics/core/worker_pool.h"
#include "physics/engine/lost_engine.h"
#include "scenes/robots.h"
#include "scenes/scenes.h"
#include "tests/physics/core/config_error.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

namespace fs = std::filesystem;
using Seconds = std::chrono::duration<double>;

// Of what hangs short, so that it is found out soon, though long beside the milliseconds that a program takes
// to start; of others far beyond what a busy machine makes of these.
constexpr double kShortLimit = 0.5, kLimit = 30;

struct Fault {
  std::string request, fault, says;  // where and how it goes wrong, and what the message has to have
};

/// A file that the faulty program serves: it does what the file says. In a folder below the current one,
/// whose files may run.
std::string file_of(const std::string& request, const std::string& fault) {
  const fs::path folder = "served_faults";
  fs::create_directories(folder);
  fs::path file = folder / (request + "_" + fault + ".py");
  std::ofstream(file) << request << ' ' << fault << '\n';
  return file.string();
}

class ServedEngines : public ::testing::Test {
 protected:
  void SetUp() override {
    setenv("CROSSGAIT_PYTHON", CROSSGAIT_FAULTY_ENGINE, 1);
    setenv(kServedLimitVariable, std::to_string(kLimit).c_str(), 1);
  }
  void TearDown() override {
    unsetenv("CROSSGAIT_PYTHON");
    unsetenv(kServedLimitVariable);
  }
};

/// Makes a world, steps it and asks it everything.
void run(const std::string& file) {
  const std::optional<Engine> engine = find_served_engine("python:" + file);
  ASSERT_TRUE(engine);
  const auto world = engine->make(scenes::world_of(scenes::sled()));
  for (int i = 0; i < 3; ++i)
    if (world->step({}) != StepStatus::kOk) throw_if_lost(*world);
  static_cast<void>(world->mass_matrix());
}

TEST_F(ServedEngines, AnHonestOneFalls) {
  const std::optional<Engine> engine = find_served_engine("python:" + file_of("none", "none"));
  ASSERT_TRUE(engine);
  EXPECT_EQ(engine->info.library, "Falls");
  EXPECT_EQ(engine->info.version.substr(0, 2), "1+");  // and a stamp of the file
  EXPECT_TRUE(engine->info.capabilities.allocates);
  const auto world = engine->make(scenes::world_of(scenes::sled()));
  const double before = world->state().p_WB.z();
  constexpr int kSteps = 100;
  ASSERT_EQ(world->step({}, kSteps), StepStatus::kOk);
  const double h = world->spec().physics_dt, t = kSteps * h;
  EXPECT_NEAR(world->state().p_WB.z() - before, -kGravity * t * (t + h) / 2,
              1e-12);  // rounding of 100 additions
}

// What two engines agree in because Crossgait's code is in both is no evidence, so it has to be told apart.
TEST_F(ServedEngines, WhoTakesThePointsAloneSharesNoEquationsOfMotion) {
  const auto parts = [](const std::string& how) {
    return find_served_engine("python:" + file_of("hello", how))->info.own_parts;
  };
  EXPECT_EQ(parts("equations"), (std::vector<std::string>{"equations of motion", "soft loops"}));
  EXPECT_TRUE(parts("equations, its own dynamics").empty());
}

void expect_errors(std::initializer_list<Fault> faults, double limit) {
  setenv(kServedLimitVariable, std::to_string(limit).c_str(), 1);
  for (const Fault& fault : faults) {
    const std::string file = file_of(fault.request, fault.fault);
    const auto begin = std::chrono::steady_clock::now();
    const ConfigError error = config_error([&] { run(file); });
    EXPECT_EQ(error.source(), file) << error.what();
    EXPECT_NE(std::string(error.what()).find(fault.says), std::string::npos) << error.what();
    // Nothing but a hang waits for the limit, and that would never come back without a watchdog.
    EXPECT_LT(Seconds(std::chrono::steady_clock::now() - begin).count(), kLimit) << file;
  }
}

TEST_F(ServedEngines, EveryFaultIsAClearError) {
  expect_errors(
      {
          {"start", "exit", "ended with exit code 7"},
          {"start", "flood", "1048576 bytes of output"},
          {"hello", "no json", "the engine"},
          {"hello", "deep json", "at most 32 levels"},
          {"hello", "protocol", "version 1, of this Crossgait"},
          {"hello", "unknown key", "laws.contacts"},
          {"hello", "precision", "'float64' or 'float32'"},
          {"hello", "text size", "text"},
          {"make", "error", "ValueError: no such thing"},
          {"reset", "nan state", "one that is not finite"},
          {"reset", "exit", "reset: expected an answer, found that it ended with exit code 7"},
          {"reset", "twice", "step: expected an answer to request 4, found one to request 3"},
          {"step", "kill", "step: expected an answer, found that signal 9 (Killed) ended it"},
          {"step", "exit", "ended with exit code 7"},
          {"step", "flood", "1048576 bytes of output"},
          {"step", "error", "step: expected an answer, found ValueError: no such thing"},
          {"step", "long answer", "an answer of 8 bytes, found 16 bytes"},
          {"step", "short answer", "found 3 bytes"},
          {"step", "another number", "an answer to request"},
          {"step", "no attitude", "a unit quaternion"},
          {"step", "many contacts", "at most 64 contacts"},
          {"step", "half a contact", "found 0.5 and 0"},
          {"step", "nan contact", "finite numbers"},
          {"step", "no body", "contacts of a body"},
          {"mass_matrix", "nan answer", "finite numbers, found some that are not"},
      },
      kLimit);
}

// Waits, for as long as these hang.
TEST_F(ServedEngines, WhatHangsIsAClearErrorInTime) {
  expect_errors(
      {
          {"start", "hang", "within 0.5 s"},
          {"make", "hang", "within 0.5 s"},
          {"step", "close", "closed its socket"},
          {"step", "hang", "within 0.5 s (CROSSGAIT_ENGINE_TIMEOUT sets it), found none"},
      },
      kShortLimit);
}

// The limit is far: only who gives up sooner comes back within it.
TEST_F(ServedEngines, WhoIsToEndWaitsNoLongerForWhatHangs) {
  const auto engine = find_served_engine("python:" + file_of("step", "hang"));
  const auto begin = std::chrono::steady_clock::now();
  {
    const Interruptible caller([] { return true; });
    const auto world = engine->make(scenes::world_of(scenes::sled()));
    EXPECT_EQ(world->step({}), StepStatus::kDiverged);
    EXPECT_THROW(throw_if_lost(*world), Interrupted);
  }
  {
    // Whoever works for others has them asked, on their own thread, though they wait for it.
    const std::thread::id here = std::this_thread::get_id();
    bool elsewhere = false;
    const Interruptible caller([&] { return elsewhere |= std::this_thread::get_id() != here, true; });
    WorkerPool pool(2);
    EXPECT_THROW(pool.run(2,
                          [&](std::size_t) {
                            const auto world = engine->make(scenes::world_of(scenes::sled()));
                            if (world->step({}) != StepStatus::kOk) throw_if_lost(*world);
                          }),
                 Interrupted);
    EXPECT_FALSE(elsewhere);
  }
  interruption_is_asked = true;
  EXPECT_THROW(run(file_of("mass_matrix", "hang")), Interrupted);
  interruption_is_asked = false;
  EXPECT_LT(Seconds(std::chrono::steady_clock::now() - begin).count(), kLimit);
}

TEST_F(ServedEngines, AStateThatIsNotFiniteIsADivergenceAsOfAnyEngine) {
  const auto engine = find_served_engine("python:" + file_of("step", "nan state"));
  const auto world = engine->make(scenes::world_of(scenes::sled()));
  const RobotState before = world->state();
  EXPECT_EQ(world->step({}), StepStatus::kDiverged);
  EXPECT_NO_THROW(throw_if_lost(*world));
  EXPECT_EQ(world->state().p_WB, before.p_WB);
  EXPECT_NO_THROW(world->reset());
}

TEST_F(ServedEngines, CannotCutOffTheMemory) {
  const auto engine = find_served_engine("python:" + file_of("step", "cut off"));
  const auto world = engine->make(scenes::world_of(scenes::sled()));
  EXPECT_EQ(world->step({}), StepStatus::kOk);  // refused by the system: the program goes on
}

TEST_F(ServedEngines, ALostOneStaysLostAndOthersGoOn) {
  const auto engine = find_served_engine("python:" + file_of("step", "kill"));
  const auto lost = engine->make(scenes::world_of(scenes::sled()));
  EXPECT_EQ(lost->step({}), StepStatus::kDiverged);
  EXPECT_THROW(lost->reset(), ConfigError);
  EXPECT_THROW(throw_if_lost(*lost), ConfigError);
  EXPECT_NO_THROW(engine->make(scenes::world_of(scenes::sled())));  // in a process of its own
}

TEST_F(ServedEngines, AForkRefuses) {
  const auto engine = find_served_engine("python:" + file_of("none", "none"));
  const auto world = engine->make(scenes::world_of(scenes::sled()));
  const pid_t child = fork();
  if (child == 0) {
    bool refused = world->step({}) == StepStatus::kDiverged;
    try {
      throw_if_lost(*world);
      refused = false;
    } catch (const ConfigError& error) {
      refused = refused && std::string(error.what()).find("a fork of it") != std::string::npos;
    }
    _exit(refused ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(world->step({}), StepStatus::kOk);
}

/// How many processes of a group live; who has ended and was not waited for (a zombie) does not.
int lives_of(pid_t group) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    std::ifstream about(entry.path() / "stat");
    std::string id, name, state, parent, its_group;
    if (about >> id >> name >> state >> parent >> its_group)
      count += its_group == std::to_string(group) && state != "Z" && state != "X" ? 1 : 0;
  }
  return count;
}

bool becomes(pid_t group, int lives) {
  for (int i = 0; i < 1000; ++i) {
    if (lives_of(group) == lives) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

/// Killed, this side has no time to end its program: the system does, whatever that does then.
void expect_end_of_all(const std::string& request, const std::string& fault, int lives, int signal) {
  SCOPED_TRACE(request + " " + fault);
  constexpr int kLongLimit = 60;
  int pipe_ends[2];
  ASSERT_EQ(pipe(pipe_ends), 0);
  const pid_t child = fork();
  if (child == 0) {
    ServedProcess process("a file", {CROSSGAIT_FAULTY_ENGINE, file_of(request, fault)}, kServedBytes,
                          Seconds(kLongLimit));
    const pid_t id = process.id();
    if (write(pipe_ends[1], &id, sizeof id) != sizeof id) _exit(1);
    process.request(static_cast<unsigned>(ServedRequest::kHello), "the beginning");  // which hangs
    _exit(1);
  }
  pid_t served = 0;
  ASSERT_EQ(read(pipe_ends[0], &served, sizeof served), static_cast<ssize_t>(sizeof served));
  EXPECT_TRUE(becomes(served, lives));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));  // until it hangs, or it was not asked yet
  ASSERT_EQ(kill(child, signal), 0);
  ASSERT_EQ(waitpid(child, nullptr, 0), child);
  EXPECT_TRUE(becomes(served, 0));
  close(pipe_ends[0]);
  close(pipe_ends[1]);
}

TEST_F(ServedEngines, EndsWithTheProcessThatItServes) {
  expect_end_of_all("hello", "hang", 1, SIGKILL);
  expect_end_of_all("start", "hang", 1, SIGKILL);  // it serves nothing yet
  for (const int signal : {SIGKILL, SIGINT, SIGTERM}) expect_end_of_all("start", "start one", 2, signal);
}

TEST_F(ServedEngines, WhatTheyStartedEndsWithThem) {
  pid_t group = 0;
  {
    ServedProcess process("a file", {CROSSGAIT_FAULTY_ENGINE, file_of("start", "start one")}, kServedBytes,
                          Seconds(kLimit));
    group = process.id();
    EXPECT_TRUE(becomes(group, 2));
  }
  EXPECT_TRUE(becomes(group, 0));
  ServedProcess process("a file", {CROSSGAIT_FAULTY_ENGINE, file_of("start", "leave one")}, kServedBytes,
                        Seconds(kShortLimit));
  group = process.id();
  EXPECT_FALSE(process.request(static_cast<unsigned>(ServedRequest::kHello), "the beginning"));
  EXPECT_TRUE(becomes(group, 0));
}

TEST_F(ServedEngines, WhatIsNoFileOrHasNoConsentIsRefused) {
  EXPECT_FALSE(find_served_engine("mujoco"));
  EXPECT_NE(std::string(config_error([] { find_served_engine("python:My Engine"); }).what())
                .find("'python:FILE.py'"),
            std::string::npos);
  EXPECT_EQ(config_error([] { find_served_engine("python:none_such.py"); }).source(), "none_such.py");
  const fs::path elsewhere = fs::temp_directory_path() / "crossgait_served_elsewhere.py";
  std::ofstream(elsewhere) << "none none\n";
  EXPECT_EQ(config_error([&] { find_served_engine("python:" + elsewhere.string()); }).element(), "code");
  fs::remove(elsewhere);
  const std::string file = file_of("none", "none for the limit");
  setenv(kServedLimitVariable, "soon", 1);
  EXPECT_EQ(config_error([&] { find_served_engine("python:" + file); }).element(), kServedLimitVariable);
  setenv(kServedLimitVariable, "1", 1);
  setenv("CROSSGAIT_PYTHON", "/nowhere/python3", 1);
  EXPECT_EQ(config_error([&] { find_served_engine("python:" + file); }).element(), "program");
}

}  // namespace
}  // namespace crossgait
