// Inside the MuJoCo world: errors of MuJoCo end as errors of ours, and what MuJoCo has once per process
// (its handlers and its collision table) stays as others left it.
#include "backends/mujoco/engine_call.h"

#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "backends/mujoco/mujoco_backend.h"
#include "physics/core/error.h"
#include "scenes/scenes.h"
#include "tests/backends/mujoco/foreign_model.h"

namespace crossgait::mujoco {
namespace {

/// A callback that MuJoCo runs in every step of every model, as long as this lives.
struct ControlCallback {
  explicit ControlCallback(mjfGeneric callback) { mjcb_control = callback; }
  ~ControlCallback() { mjcb_control = nullptr; }
  ControlCallback(const ControlCallback&) = delete;
  ControlCallback& operator=(const ControlCallback&) = delete;
};

/// MuJoCo's own error for a stack that is too small, with part of the stack taken.
void overflow_stack(const mjModel* /*m*/, mjData* d) {
#if mjVERSION_HEADER < 300
  mj_stackAlloc(d, d->nstack / 2);
  mj_stackAlloc(d, d->nstack);
#else
  mj_markStack(d);
  mj_stackAllocByte(d, static_cast<std::size_t>(d->narena) / 2, 8);
  mj_stackAllocByte(d, static_cast<std::size_t>(d->narena), 8);
#endif
}

WorldSpec on_a_field() {
  WorldSpec spec = scenes::world_of(scenes::quadruped());
  spec.terrain = make_terrain("rough");
  return spec;
}

TEST(MujocoErrors, InAStepAreDivergenceAndTheWorldWorksAfterAReset) {
  const auto fresh = engine().make(on_a_field()), world = engine().make(on_a_field());
  const JointTargets home = scenes::home_targets(world->robot());
  ASSERT_EQ(world->step(home, 50), StepStatus::kOk);
  const RobotState before = world->state();
  {
    const ControlCallback callback(overflow_stack);
    EXPECT_EQ(world->step(home), StepStatus::kDiverged);
  }
  EXPECT_TRUE(scenes::identical(world->state(), before));  // the last good one
  EXPECT_EQ(world->step(home), StepStatus::kDiverged);     // until reset
  world->reset();
  ASSERT_EQ(world->step(home, 200), StepStatus::kOk);
  ASSERT_EQ(fresh->step(home, 200), StepStatus::kOk);
  EXPECT_TRUE(scenes::identical(world->state(), fresh->state()));
}

TEST(MujocoErrors, InCompilationAreConfigErrors) {
  const ControlCallback callback([](const mjModel*, mjData*) { mju_error("a planted error"); });
  try {
    engine().make(on_a_field());
    FAIL() << "no error";
  } catch (const ConfigError& error) {
    EXPECT_NE(error.found().find("a planted error"), std::string::npos) << error.what();
  }
}

int allocations = 0, allocations_that_work = 0;

/// Memory of MuJoCo's, as long as this lives: so much of it as `allocations_that_work` says.
struct ScarceMemory {
  ScarceMemory() {
    mju_user_malloc = [](std::size_t size) -> void* {
      constexpr std::size_t kAlignment = 64;  // MuJoCo's own
      if (++allocations > allocations_that_work) return nullptr;
      return std::aligned_alloc(kAlignment, (size + kAlignment - 1) / kAlignment * kAlignment);
    };
    mju_user_free = std::free;
  }
  ~ScarceMemory() {
    mju_user_malloc = nullptr;
    mju_user_free = nullptr;
  }
  ScarceMemory(const ScarceMemory&) = delete;
  ScarceMemory& operator=(const ScarceMemory&) = delete;
};

TEST(MujocoErrors, AtConstructionAreExceptionsInMujocosWords) {
  const ScarceMemory memory;
  allocations = 0;
  allocations_that_work = std::numeric_limits<int>::max();
  const ModelPtr model = compile_model(on_a_field());
  allocations_that_work = allocations;  // enough for the model, and none for what is simulated
  allocations = 0;
  try {
    engine().make(on_a_field());
    FAIL() << "no error";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()).rfind("MuJoCo: ", 0), 0) << error.what();
    EXPECT_NE(std::string(error.what()).find("allocate"), std::string::npos) << error.what();
  }
}

TEST(MujocoErrors, LongOnesAreCut) {
  ErrorText text{};
  const CalledFor nobody{nullptr, nullptr};
  const std::string long_words(1000, 'x');  // out here: what an error jumps over is not destroyed
  EXPECT_FALSE(try_in_mujoco(
      nobody, [words = long_words.c_str()] { mju_error(words); }, &text));
  EXPECT_EQ(std::string(text.data()), std::string(text.size() - 1, 'x'));
  EXPECT_TRUE(try_in_mujoco(nobody, [] {}));
}

struct Planted {};
int errors_heard = 0, warnings_heard = 0;

/// Somebody else's handlers of the process, as long as this lives.
struct Handlers {
  Handlers() {
    mju_user_error = hear_error;
    mju_user_warning = hear_warning;
    errors_heard = warnings_heard = 0;
  }
  ~Handlers() {
    mju_user_error = nullptr;
    mju_user_warning = nullptr;
  }
  Handlers(const Handlers&) = delete;
  Handlers& operator=(const Handlers&) = delete;
  static void hear_error(const char* /*message*/) {
    ++errors_heard;
    throw Planted();
  }
  static void hear_warning(const char* /*message*/) { ++warnings_heard; }
};

TEST(MujocoErrors, HandlersOfOthersHearOfWhatIsTheirsAndOfNothingElse) {
  const Handlers handlers;
  const auto world = engine().make(on_a_field());
  const JointTargets home = scenes::home_targets(world->robot());
  {
    const ControlCallback callback([](const mjModel*, mjData*) {
      mju_warning("ours");
      mju_error("ours");
    });
    EXPECT_EQ(world->step(home), StepStatus::kDiverged);
  }
  EXPECT_EQ(errors_heard, 0);
  EXPECT_EQ(warnings_heard, 0);
  EXPECT_EQ(mju_user_error, &Handlers::hear_error);
  EXPECT_EQ(mju_user_warning, &Handlers::hear_warning);
  EXPECT_THROW(mju_error("theirs"), Planted);
  mju_warning("theirs");
  EXPECT_EQ(errors_heard, 1);
  EXPECT_EQ(warnings_heard, 1);
}

TEST(MujocoErrors, AWorldTouchesNoHandlerOfTheProcess) {
  ASSERT_EQ(mju_user_error, nullptr);
  ASSERT_EQ(mju_user_warning, nullptr);
  const auto world = engine().make(on_a_field());
  static_cast<void>(world->step(scenes::home_targets(world->robot())));
  EXPECT_EQ(mju_user_error, nullptr);
  EXPECT_EQ(mju_user_warning, nullptr);
}

TEST(MujocoCollision, LeavesOtherModelsAlone) {
  const ModelPtr plain = foreign_model(0), with_data = foreign_model(1);
  // MuJoCo's own routine gives several contacts where Crossgait's gives one.
  const std::vector<double> before = contacts_of(*plain);
  ASSERT_GT(before.size(), 2 * kNumbersPerContact);
  const auto world = engine().make(on_a_field());
  EXPECT_EQ(contacts_of(*plain), before);
  EXPECT_EQ(contacts_of(*with_data), before);  // user data that nobody set
  for (const double theirs : {1.0, 5e-324, 1e-310, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_EQ(contacts_of(*with_data, theirs), before) << theirs;
}

const mjModel* stepped_inside = nullptr;
std::vector<double> contacts_inside;

TEST(MujocoCollision, LeavesOtherModelsAloneWithinAStepOfOurs) {
  const ModelPtr foreign = foreign_model(1);
  const std::vector<double> before = contacts_of(*foreign, 1.0);
  const auto world = engine().make(on_a_field());
  stepped_inside = foreign.get();
  const ControlCallback callback([](const mjModel* m, mjData* /*d*/) {
    if (m != stepped_inside) contacts_inside = contacts_of(*stepped_inside, 1.0);
  });
  ASSERT_EQ(world->step(scenes::home_targets(world->robot())), StepStatus::kOk);
  EXPECT_EQ(contacts_inside, before);
}

}  // namespace
}  // namespace crossgait::mujoco
