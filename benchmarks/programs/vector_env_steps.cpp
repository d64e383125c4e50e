// The vector environment alone, for python/benchmarks/against_others.py to hold Python's against in turns.
//   vector_env_steps ENGINE ENVIRONMENTS POLICY_DT WORKERS
// For every number of steps read from standard input: resets, makes so many steps with zero actions, and
// prints CPU seconds of the process and seconds on the wall.
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include <fmt/format.h>

#include "backends/registry.h"
#include "env/vector_env.h"
#include "physics/core/error.h"

namespace crossgait {
namespace {

double process_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void serve(VectorEnv& env) {
  std::vector<double> seen(env.size() * env.observation_size()), rewards(env.size()),
      actions(env.size() * env.action_size(), 0);
  std::vector<std::uint8_t> terminated(env.size()), truncated(env.size());
  for (int steps = 0; std::scanf("%d", &steps) == 1;) {
    env.reset(1, seen);
    const double cpu = process_seconds(), wall = wall_seconds();
    for (int i = 0; i < steps; ++i) env.step(actions, {seen, rewards, terminated, truncated});
    fmt::print("{:.9f} {:.9f}\n", process_seconds() - cpu, wall_seconds() - wall);
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace crossgait

int main(int argc, char** argv) try {
  using namespace crossgait;
  if (argc != 5) {
    fmt::print(stderr, "usage: vector_env_steps ENGINE ENVIRONMENTS POLICY_DT WORKERS\n");
    return 2;
  }
  EnvConfig config;
  config.engine = argv[1];
  config.policy_dt = std::atof(argv[3]);
  config.episode_seconds = 1000;
  const auto count = [](const char* text) { return static_cast<std::size_t>(std::atoi(text)); };
  VectorEnv env(config, find_engine(config.engine),
                {.environments = count(argv[2]), .workers = count(argv[4])});
  serve(env);
  return 0;
} catch (const crossgait::ConfigError& error) {
  fmt::print(stderr, "vector_env_steps: {}\n", error.what());
  return 2;
}
