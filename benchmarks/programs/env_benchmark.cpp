// What the environment adds to its engine, and what a second worker brings. Ratios within one run, turns
// interleaved, medians with quartiles.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <span>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "backends/registry.h"
#include "benchmarks/statistics.h"
#include "env/vector_env.h"
#include "physics/core/table.h"

namespace crossgait {
namespace {

constexpr int kRounds = 15;
constexpr int kSteps = 1000;  // 2 s, more than two cycles of the trot

std::string with_quartiles(const benchmarks::Quartiles& s) {
  return fmt::format("{:.3f} ({:.3f}-{:.3f})", s.median, s.low, s.high);
}

/// eta: physics steps per second of the environment over those of the engine alone, on the same servo targets
/// from the same start. CPU time of the thread.
class Eta {
 public:
  Eta(const std::string& name, const std::string& terrain)
      : env_(config(terrain), find_engine(name)),
        observation_(env_.observation_size()),
        engine_(make_engine(name)) {
    env_.reset(1, observation_);
    // The stride has grown to its full length.
    for (int i = 0; i < kSteps; ++i) env_.step(action(i), observation_);
    saved_ = env_.save();
    engine_->restore(saved_->physics);
    for (int i = 0; i < kSteps; ++i) {
      env_.step(action(i), observation_);
      targets_.push_back(env_.targets().joints);
    }
  }

  // Each begins after some steps that do not count: other engines have had the caches since its last turn.
  void measure() {
    step_env(kWarmUp);
    const double env = step_env(kSteps);
    step_engine(kWarmUp);
    const double alone = step_engine(kSteps);
    ratio_.push_back(alone / env);
    added_us_.push_back(1e6 * (env - alone) / kSteps);
    step_us_.push_back(1e6 * env / kSteps);
  }

  std::vector<std::string> row() const {
    return {env_.world().info().name, env_.config().terrain, with_quartiles(benchmarks::quartiles(ratio_)),
            fmt::format("{:.1f}", benchmarks::quartiles(step_us_).median),
            fmt::format("{:.2f}", benchmarks::quartiles(added_us_).median)};
  }

 private:
  static constexpr int kSubsteps = 2, kWarmUp = 200;

  // CPU time of so many steps from the start, s.
  double step_env(int steps) {
    env_.restore(*saved_);
    const double begin = benchmarks::thread_seconds();
    for (int i = 0; i < steps; ++i) env_.step(action(i), observation_);
    return benchmarks::thread_seconds() - begin;
  }
  double step_engine(int steps) {
    engine_->restore(saved_->physics);
    const double begin = benchmarks::thread_seconds();
    for (const JointTargets& targets : std::span(targets_).first(static_cast<std::size_t>(steps))) {
      if (engine_->step(targets, kSubsteps) != StepStatus::kOk) std::abort();
    }
    return benchmarks::thread_seconds() - begin;
  }

  static EnvConfig config(const std::string& terrain) {
    EnvConfig c;
    c.terrain = terrain;
    c.episode_seconds = 1e5;
    return c;
  }
  std::unique_ptr<PhysicsBackend> make_engine(const std::string& name) const {
    return make_world(name, env_.world().spec());
  }
  // Small residuals that change all the time, so that nothing in the environment comes to rest.
  std::span<const double> action(int step) {
    action_.assign(env_.action_size(), 0.05 * (step % 3 - 1));
    return action_;
  }

  QuadrupedEnv env_;
  std::vector<double> observation_, action_;
  std::unique_ptr<PhysicsBackend> engine_;
  std::shared_ptr<const QuadrupedEnv::Saved> saved_;
  std::vector<JointTargets> targets_;
  std::vector<double> ratio_, added_us_, step_us_;
};

void print_eta() {
  std::vector<std::unique_ptr<Eta>> runs;
  for (const std::string& name : available_engines()) {
    for (const char* terrain : {"flat", "rough:seed=1"}) runs.push_back(std::make_unique<Eta>(name, terrain));
  }
  for (int round = 0; round < kRounds; ++round) {
    for (const auto& run : runs) run->measure();
  }
  Table table({"engine", "terrain", "eta (quartiles)", "us per policy step", "us above the engine"});
  for (const auto& run : runs) table.add_row(run->row());
  fmt::print("Trot, 69 observations, guide's reward, 2 physics steps per policy step\n{}\n", table.str());
}

/// Seconds on the wall of a batch's steps.
double batch_seconds(VectorEnv& env, int steps) {
  std::vector<double> seen(env.size() * env.observation_size()), rewards(env.size()),
      actions(env.size() * env.action_size(), 0);
  std::vector<std::uint8_t> terminated(env.size()), truncated(env.size());
  env.reset(1, seen);
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < steps; ++i) env.step(actions, {seen, rewards, terminated, truncated});
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Two batches of half the size, each on a thread of its own that waits for nobody: what the machine gives.
double apart_seconds(VectorEnv& a, VectorEnv& b, int steps) {
  double first = 0;
  std::jthread thread([&] { first = batch_seconds(a, steps); });
  const double second = batch_seconds(b, steps);
  thread.join();
  return std::max(first, second);
}

void print_scaling() {
  constexpr std::size_t kEnvironments = 32;
  constexpr int kBatchSteps = 100;
  Table table({"engine", "steps/s, 1 worker", "2 workers over 1 (quartiles)", "2 threads apart over 1"});
  for (const std::string& name : available_engines()) {
    const auto batch = [&](std::size_t environments, std::size_t workers) {
      return VectorEnv(EnvConfig(), find_engine(name), {.environments = environments, .workers = workers});
    };
    VectorEnv one = batch(kEnvironments, 1), two = batch(kEnvironments, 2),
              half = batch(kEnvironments / 2, 1), other_half = batch(kEnvironments / 2, 1);
    std::vector<double> ratio, apart, rate;
    for (int round = 0; round < kRounds; ++round) {
      const double slow = batch_seconds(one, kBatchSteps);
      ratio.push_back(slow / batch_seconds(two, kBatchSteps));
      apart.push_back(slow / apart_seconds(half, other_half, kBatchSteps));
      rate.push_back(1.0 * kBatchSteps * kEnvironments / slow);
    }
    table.add_row({name, fmt::format("{:.0f}", benchmarks::quartiles(rate).median),
                   with_quartiles(benchmarks::quartiles(ratio)),
                   with_quartiles(benchmarks::quartiles(apart))});
  }
  fmt::print("{} environments, wall-clock time\n{}", kEnvironments, table.str());
}

}  // namespace
}  // namespace crossgait

int main() {
  crossgait::print_eta();
  crossgait::print_scaling();
  return 0;
}
