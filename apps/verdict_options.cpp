#include "crossgait/apps/verdict_options.h"

#include <fmt/format.h>

#include "crossgait/apps/env_options.h"
#include "crossgait/backends/registry.h"
#include "crossgait/physics/error.h"

namespace crossgait::apps {

Behaviour walk_behaviour(const WorldOptions& world, const WalkOptions& walk, const WorldSpec& spec,
                         const StartSpread& spread) {
  const auto terrain = [text = world.terrain, seed = world.seed](std::size_t k) {
    return make_terrain(text, seed + k);
  };
  return crossgait::walk_behaviour(spec, walk.make(*spec.robot), terrain, spread, world.seed);
}

EngineFamily find_family(const Engine& a, const Engine& b) {
  for (const EngineFamily& family : engine_families()) {
    const Laws from = find_engine(family.from).info.laws, to = find_engine(family.to).info.laws;
    if ((a.info.laws == from && b.info.laws == to) || (b.info.laws == from && a.info.laws == to))
      return family;
  }
  throw ConfigError("command line", "--explain", "two engines with known differences (mujoco and bullet)",
                    fmt::format("{} and {}", a.name(), b.name()));
}

SpreadOptions::SpreadOptions() { verdict.workers = default_workers(); }

void SpreadOptions::add_to(CLI::App& command) {
  command.add_option("--starts", verdict.starts, "Starts that both engines run from, at least 4")
      ->check(CLI::Range(4, 10000))
      ->capture_default_str();
  command
      .add_option("--limit", verdict.limit, "Gap over spread up to which engines agree, and beyond which not")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command.add_option("--confidence", verdict.confidence, "Of all words together, between 0 and 1")
      ->capture_default_str();
  command.add_option("--offset", spread.position_m, "How far starts lie apart, each way, m")
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str();
  command.add_option("--heading", spread.heading_rad, "How far headings differ, each way, rad")
      ->check(CLI::Range(0.0, 3.14159))
      ->capture_default_str();
  command.add_option("--push", spread.push_mps, "Push in the first second, as a speed of the robot, m/s")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  add_workers_option(command, verdict.workers);
}

}  // namespace crossgait::apps
