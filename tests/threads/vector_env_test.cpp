#include "env/vector_env.h"

#include <atomic>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "physics/core/error.h"
#include "tests/physics/core/config_error.h"
#include "tests/support/engine_test.h"
#include "tests/support/environments.h"

namespace crossgait {
namespace {

/// The caller's arrays.
struct Arrays {
  explicit Arrays(const VectorEnv& env)
      : observations(env.size() * env.observation_size()),
        finals(observations.size(), -1),
        rewards(env.size()),
        terminated(env.size()),
        truncated(env.size()),
        final_infos(env.size()) {}
  VectorStep view() { return {observations, rewards, terminated, truncated, finals, final_infos}; }
  std::vector<double> observations, finals, rewards;
  std::vector<std::uint8_t> terminated, truncated;
  std::vector<StepInfo> final_infos;
};

class Vectors : public EngineTest {
 protected:
  static VectorEnv make_env(const EnvConfig& config, const VectorEnvOptions& options) {
    return VectorEnv(config, find_engine(GetParam()), options);
  }
  static EnvConfig short_episodes() {
    EnvConfig config;
    config.terrain = "rough";
    config.episode_seconds = 0.1;
    config.settle_seconds = 0.05;
    config.randomisation[Randomised::kStartYaw] = {-1, 1};
    return config;
  }
  static std::vector<double> run(VectorEnv& env, std::uint64_t seed, int steps) {
    Arrays arrays(env);
    env.reset(seed, arrays.observations);
    std::vector<double> all = arrays.observations;
    Random random(1);
    for (int i = 0; i < steps; ++i) {
      env.step(scenes::random_action(random, env.size() * env.action_size()), arrays.view());
      all.insert(all.end(), arrays.observations.begin(), arrays.observations.end());
      all.insert(all.end(), arrays.rewards.begin(), arrays.rewards.end());
      all.insert(all.end(), arrays.terminated.begin(), arrays.terminated.end());
      all.insert(all.end(), arrays.truncated.begin(), arrays.truncated.end());
    }
    return all;
  }
};
CROSSGAIT_FOR_EVERY_BACKEND(Vectors);

TEST_P(Vectors, AreTheSameForAnyNumberOfWorkers) {
  for (const AutoReset mode : {AutoReset::kNextStep, AutoReset::kSameStep}) {
    VectorEnv one = make_env(short_episodes(), {5, 1, mode}), two = make_env(short_episodes(), {5, 2, mode}),
              many = make_env(short_episodes(), {5, 7, mode});
    const std::vector<double> expected = run(one, 3, 200);
    EXPECT_EQ(run(two, 3, 200), expected);
    EXPECT_EQ(run(many, 3, 200), expected);
    EXPECT_EQ(run(two, 3, 200), expected);  // and after a reset
    EXPECT_NE(run(two, 4, 200), expected);
  }
}

TEST_P(Vectors, EachIsASingleEnvironmentWithItsOwnSeed) {
  const EnvConfig config = short_episodes();
  VectorEnv env = make_env(config, {.environments = 3, .workers = 2});
  Arrays arrays(env);
  env.reset(11, arrays.observations);
  for (std::size_t i = 0; i < 3; ++i) {
    QuadrupedEnv single(config, find_engine(GetParam()));
    std::vector<double> seen(single.observation_size());
    single.reset(derived_seed(derived_seed(11, i), 0), seen);
    const auto row = std::span(arrays.observations).subspan(i * seen.size(), seen.size());
    EXPECT_TRUE(std::equal(seen.begin(), seen.end(), row.begin()));
  }
}

/// One environment on its own, stepped by the contract of AutoReset and nothing of VectorEnv.
class Single {
 public:
  Single(const EnvConfig& config, const Engine& engine, std::uint64_t seed, AutoReset mode)
      : env_(config, engine), seed_(seed), mode_(mode), seen(env_.observation_size()), last(seen.size(), -1) {
    begin();
  }

  void step(std::span<const double> action) {
    result = {};
    if (ended_) {
      begin();
      return;
    }
    result = env_.step(action, seen);
    if (!result.done()) return;
    (result.terminated ? terminated : truncated) += 1;
    if (mode_ == AutoReset::kNextStep) {
      ended_ = true;
      return;
    }
    last = seen;
    last_info = env_.info();
    begin();
  }

  const QuadrupedEnv& env() const { return env_; }
  std::uint64_t episode_seed() const { return derived_seed(seed_, episode_ - 1); }

 private:
  void begin() {
    env_.reset(derived_seed(seed_, episode_++), seen);
    ended_ = false;
  }

  QuadrupedEnv env_;
  std::uint64_t seed_, episode_ = 0;
  AutoReset mode_;
  bool ended_ = false;

 public:
  std::vector<double> seen, last;
  std::optional<StepInfo> last_info;
  StepResult result;
  int terminated = 0, truncated = 0;
};

void expect_same_info(const StepInfo& a, const StepInfo& b) {
  EXPECT_EQ(a.time, b.time);
  EXPECT_EQ(a.reward_terms, b.reward_terms);
  EXPECT_EQ(a.swing, b.swing);
  EXPECT_EQ(a.distance, b.distance);
  EXPECT_EQ(a.lateral, b.lateral);
  EXPECT_EQ(a.roll_pitch_yaw, b.roll_pitch_yaw);
  EXPECT_EQ(a.power, b.power);
  EXPECT_EQ(a.limit_factor, b.limit_factor);
  EXPECT_EQ(a.ik_clamped, b.ik_clamped);
  EXPECT_EQ(a.invalid_actions, b.invalid_actions);
  EXPECT_EQ(a.clipped_actions, b.clipped_actions);
  EXPECT_EQ(a.outcome, b.outcome);
  for (const ParameterRow& row : gait_parameters())
    EXPECT_EQ((*a.parameters).*row.member, (*b.parameters).*row.member) << row.name;
  for (const Leg leg : kLegs) {
    EXPECT_EQ(a.contacts[leg].touching, b.contacts[leg].touching);
    EXPECT_EQ(a.contacts[leg].force, b.contacts[leg].force);
  }
}

TEST_P(Vectors, AreSingleEnvironmentsBitForBitOverSeveralEpisodes) {
  EnvConfig config = short_episodes();
  config.tilt_limit_deg = 6;  // falls now and then before its time is over
  config.episode_seconds = 0.16;
  config.policy_dt = 0.01;
  config.residual_scale = 0.03;
  constexpr std::size_t kEnvironments = 4;
  constexpr std::uint64_t kSeed = 11;
  for (const AutoReset mode : {AutoReset::kNextStep, AutoReset::kSameStep}) {
    VectorEnv env = make_env(config, {kEnvironments, 3, mode});
    Arrays arrays(env);
    env.reset(kSeed, arrays.observations);
    std::vector<std::unique_ptr<Single>> singles;
    for (std::size_t i = 0; i < kEnvironments; ++i)
      singles.push_back(
          std::make_unique<Single>(config, find_engine(GetParam()), derived_seed(kSeed, i), mode));
    Random random(1);
    const std::size_t n = env.observation_size(), m = env.action_size();
    for (int step = 0; step < 60 && !HasFailure(); ++step) {
      const std::vector<double> actions = scenes::random_action(random, kEnvironments * m);
      env.step(actions, arrays.view());
      for (std::size_t i = 0; i < kEnvironments; ++i) {
        SCOPED_TRACE("environment " + std::to_string(i) + " in step " + std::to_string(step));
        Single& single = *singles[i];
        single.step(std::span(actions).subspan(i * m, m));
        const auto row = [&](const std::vector<double>& matrix) {
          return std::vector<double>(matrix.begin() + static_cast<std::ptrdiff_t>(i * n),
                                     matrix.begin() + static_cast<std::ptrdiff_t>((i + 1) * n));
        };
        EXPECT_EQ(row(arrays.observations), single.seen);
        EXPECT_EQ(row(arrays.finals), single.last);
        EXPECT_EQ(arrays.rewards[i], single.result.reward);
        EXPECT_EQ(arrays.terminated[i], single.result.terminated ? 1 : 0);
        EXPECT_EQ(arrays.truncated[i], single.result.truncated ? 1 : 0);
        expect_same_info(env.environment(i).info(), single.env().info());
        if (single.last_info) expect_same_info(arrays.final_infos[i], *single.last_info);
        EXPECT_EQ(env.episode_seed(i), single.episode_seed());
      }
    }
    int terminated = 0, truncated = 0;
    for (const auto& single : singles) {
      EXPECT_GE(single->terminated + single->truncated, 3);  // several episodes of each
      terminated += single->terminated;
      truncated += single->truncated;
    }
    EXPECT_GT(terminated, 0);
    EXPECT_GT(truncated, 0);
    // Nothing above would notice rows that are all alike.
    for (std::size_t i = 1; i < kEnvironments; ++i) {
      EXPECT_NE(singles[i]->seen, singles[0]->seen);
      EXPECT_NE(singles[i]->last == singles[0]->last, mode == AutoReset::kSameStep);
    }
  }
}

TEST_P(Vectors, ResetInTheNextStep) {
  VectorEnv env = make_env(short_episodes(), {.environments = 2});
  Arrays arrays(env);
  env.reset(1, arrays.observations);
  const std::vector<double> zeros(2 * env.action_size(), 0);
  for (int i = 0; i < 50; ++i) env.step(zeros, arrays.view());
  EXPECT_EQ(arrays.truncated, (std::vector<std::uint8_t>{1, 1}));
  EXPECT_NEAR(env.environment(0).info().time, 0.1, 1e-12);
  env.step(zeros, arrays.view());
  EXPECT_EQ(arrays.truncated, (std::vector<std::uint8_t>{0, 0}));
  EXPECT_EQ(arrays.rewards, (std::vector<double>{0, 0}));
  EXPECT_EQ(env.environment(0).info().time, 0);
  EXPECT_EQ(env.episodes(), 4U);
  EXPECT_EQ(arrays.finals, std::vector<double>(arrays.finals.size(), -1));  // not this mode's
}

TEST_P(Vectors, ResetInTheSameStep) {
  VectorEnv env =
      make_env(short_episodes(), {.environments = 2, .workers = 1, .auto_reset = AutoReset::kSameStep});
  Arrays arrays(env);
  env.reset(1, arrays.observations);
  const std::vector<double> zeros(2 * env.action_size(), 0);
  for (int i = 0; i < 50; ++i) env.step(zeros, arrays.view());
  EXPECT_EQ(arrays.truncated, (std::vector<std::uint8_t>{1, 1}));
  EXPECT_EQ(env.environment(0).info().time, 0);
  EXPECT_NE(arrays.rewards[0], 0);
  const std::size_t x = env.environment(0).observation_layout().find("p_WB.x").value();
  EXPECT_GT(arrays.finals[x], -1);
  EXPECT_NE(arrays.finals[x], arrays.observations[x]);
}

TEST_P(Vectors, ADivergedEnvironmentIsCountedResetAndAlone) {
  // A push of 1e7 N s every now and then throws the robot beyond any state that the worlds accept.
  EnvConfig config = short_episodes();
  config.randomisation[Randomised::kStartYaw] = {0, 0};
  VectorEnv calm = make_env(config, {.environments = 1});
  const Engine explode = with_change(find_engine(GetParam()), [](WorldSpec& world) {
    world.gravity = {0, 0, -1e9};
  });
  Arrays arrays(calm);
  VectorEnv wild(config, explode, {.environments = 3, .workers = 2});
  Arrays out(wild);
  wild.reset(1, out.observations);
  const std::vector<double> zeros(3 * wild.action_size(), 0);
  for (int i = 0; i < 20; ++i) {
    wild.step(zeros, out.view());
    for (const double value : out.observations) ASSERT_TRUE(std::isfinite(value));
    for (const double value : out.rewards) ASSERT_TRUE(std::isfinite(value));
  }
  EXPECT_GE(wild.diverged(), 3U);
  EXPECT_GE(wild.episodes(), 3 + wild.diverged());
}

TEST_P(Vectors, WrongSizesAreErrors) {
  VectorEnv env = make_env(short_episodes(), {.environments = 2});
  Arrays arrays(env);
  std::vector<double> actions(2 * env.action_size(), 0);
  EXPECT_THROW(env.reset(0, std::span(arrays.observations).first(3)), ConfigError);
  EXPECT_THROW(env.step(std::span(actions).first(1), arrays.view()), ConfigError);
  VectorStep view = arrays.view();
  view.rewards = view.rewards.first(1);
  EXPECT_THROW(env.step(actions, view), ConfigError);
  view = arrays.view();
  view.final_observations = view.final_observations.first(1);
  EXPECT_THROW(env.step(actions, view), ConfigError);
  EXPECT_THROW(make_env({}, {.environments = 0}), ConfigError);
  EXPECT_THROW(make_env({}, {.environments = 1, .workers = 0}), ConfigError);
}

TEST(WorkerPool, CallsEveryIndexOnceAndReportsTheFirstError) {
  WorkerPool pool(3);
  EXPECT_EQ(pool.workers(), 3U);
  for (const std::size_t count : {0U, 1U, 2U, 1000U}) {
    std::vector<int> calls(count, 0);
    pool.run(count, [&](std::size_t i) { ++calls[i]; });
    EXPECT_EQ(calls, std::vector<int>(count, 1));
  }
  std::atomic<int> done = 0;
  try {
    pool.run(100, [&](std::size_t i) {
      ++done;
      if (i % 10 == 3) throw std::runtime_error(std::to_string(i));
    });
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "3");
  }
  EXPECT_EQ(done, 100);
  pool.run(1, [](std::size_t) {});  // and goes on
}

TEST_P(Vectors, TooManyAreAnErrorAndMakingThemCanBeEnded) {
  EXPECT_EQ(config_error([&] { make_env(EnvConfig(), {.environments = kMaxEnvironments + 1}); }).element(),
            "environments");
  int told = 0;
  const auto end_at_the_second = [&told](double share) {
    EXPECT_EQ(share, told == 0 ? 0 : 0.5);
    if (++told == 2) throw Interrupted();
  };
  const VectorEnvOptions options{.environments = 128, .workers = 2, .progress = end_at_the_second};
  EXPECT_THROW(make_env(EnvConfig(), options), Interrupted);
  EXPECT_EQ(told, 2);
}

// A fork has none of the threads: it is told so, instead of waiting for them, when it works and when it ends.
TEST(WorkerPool, RefusesToWorkInAFork) {
#if defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the thread sanitizer ends a child that starts threads";
#endif
  auto pool = std::make_unique<WorkerPool>(2);
  std::atomic<int> calls = 0;
  const auto count = [&](std::size_t) { ++calls; };
  pool->run(4, count);
  const pid_t child = ::fork();
  if (child == 0) {
    int code = 1;
    try {
      pool->run(4, count);
    } catch (const std::logic_error& error) {
      code = std::string(error.what()).find("fork") != std::string::npos && calls == 4 ? 0 : 2;
    }
    WorkerPool own(2);  // whose threads lie where those of the other did
    pool.reset();
    own.run(4, count);
    ::_exit(code == 0 && calls != 8 ? 3 : code);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  pool->run(4, count);
  EXPECT_EQ(calls, 8);
}

TEST_P(Vectors, ACommandIsOneEnvironmentsOwn) {
  EnvConfig config = short_episodes();
  config.command = VelocityCommand{};
  config.observation = {"command"};
  VectorEnv env = make_env(config, {.environments = 3});
  Arrays arrays(env);
  env.reset(1, arrays.observations);
  env.set_command(1, {.vx = 0.1, .vy = 0, .yaw_rate = 0.2});
  env.step(std::vector<double>(3 * env.action_size()), arrays.view());
  EXPECT_EQ(arrays.observations, (std::vector<double>{0, 0, 0, 0.1, 0, 0.2, 0, 0, 0}));
  EXPECT_THROW(env.set_command(1, {.vx = NAN}), ConfigError);
  EXPECT_THROW(env.set_command(3, {}), std::out_of_range);
  EXPECT_THROW(static_cast<void>(make_env(config, {.environments = 1}).episode_seed(0)), ConfigError);
}

TEST(WorkerPool, WithoutAllItsThreadsIsAnErrorAndDoesNotWaitForEver) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers take more address space than can be limited";
#endif
  // Address space for some more stacks of 8 MB, and not for a thousand.
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
  rlimit tight = before;
  tight.rlim_cur = pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + (rlim_t{100} << 20);
  ASSERT_EQ(setrlimit(RLIMIT_AS, &tight), 0);
  bool refused = false;
  try {
    const WorkerPool pool(1000);
  } catch (const std::runtime_error& error) {
    refused = std::string(error.what()).find("of 999 could be started") != std::string::npos;
  }
  ASSERT_EQ(setrlimit(RLIMIT_AS, &before), 0);
  EXPECT_TRUE(refused);
}

}  // namespace
}  // namespace crossgait
