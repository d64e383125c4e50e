// The vector environment alone, for python/benchmarks/against_all.py to hold Python's against in turns.
//   vector_env_steps CONFIG.yaml ENVIRONMENTS WORKERS ACTIONS
// ACTIONS holds doubles, a row of all environments' actions for each step, in a ring. For every line "FIRST
// STEPS" of standard input: goes on with so many steps from that row, and prints CPU seconds of the process
// and seconds on the wall.
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <span>
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

std::vector<double> read_rows(const char* file, std::size_t width) {
  std::ifstream stream(file, std::ios::binary);
  std::vector<double> rows;
  for (double number = 0; stream.read(reinterpret_cast<char*>(&number), sizeof number);)
    rows.push_back(number);
  if (rows.empty() || rows.size() % width != 0)
    throw ConfigError(file, "actions", fmt::format("rows of {} doubles", width),
                      fmt::format("{} doubles", rows.size()));
  return rows;
}

void serve(VectorEnv& env, std::span<const double> actions) {
  std::vector<double> seen(env.size() * env.observation_size()), rewards(env.size());
  std::vector<std::uint8_t> terminated(env.size()), truncated(env.size());
  const std::size_t width = env.size() * env.action_size(), rows = actions.size() / width;
  env.reset(1, seen);
  std::size_t first = 0, steps = 0;
  while (std::scanf("%zu %zu", &first, &steps) == 2) {
    const double cpu = process_seconds(), wall = wall_seconds();
    for (std::size_t i = 0; i < steps; ++i)
      env.step(actions.subspan((first + i) % rows * width, width), {seen, rewards, terminated, truncated});
    fmt::print("{:.9f} {:.9f}\n", process_seconds() - cpu, wall_seconds() - wall);
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace crossgait

int main(int argc, char** argv) try {
  using namespace crossgait;
  if (argc != 5) {
    fmt::print(stderr, "usage: vector_env_steps CONFIG.yaml ENVIRONMENTS WORKERS ACTIONS\n");
    return 2;
  }
  const EnvConfig config = load_env_config(argv[1]);
  const auto count = [](const char* text) { return static_cast<std::size_t>(std::atoi(text)); };
  VectorEnv env(config, find_engine(config.engine),
                {.environments = count(argv[2]), .workers = count(argv[3])});
  serve(env, read_rows(argv[4], env.size() * env.action_size()));
  return 0;
} catch (const crossgait::ConfigError& error) {
  fmt::print(stderr, "vector_env_steps: {}\n", error.what());
  return 2;
}
