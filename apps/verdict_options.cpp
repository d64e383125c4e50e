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

Engine find_engine(const std::string& name) {
  return {name, [name](const WorldSpec& world) { return make_backend(name, world); }};
}

EngineFamily find_family(const std::string& a, const std::string& b, const WorldSpec& spec) {
  const auto matches_mujoco = [&](const std::string& name) {
    return make_backend(name, spec)->info().capabilities.matches_mujoco;
  };
  const bool matches_a = matches_mujoco(a), matches_b = matches_mujoco(b);
  for (const BackendFamily& family : backend_families()) {
    const bool from_matches = matches_mujoco(family.from);
    const auto is_from = [&](const std::string& name, bool matches) {
      return name == family.from || (matches && from_matches);
    };
    if (!(is_from(a, matches_a) && b == family.to) && !(is_from(b, matches_b) && a == family.to)) continue;
    EngineFamily result{family.from, family.to, {}, {}};
    for (const BackendIngredient& i : family.ingredients)
      result.ingredients.push_back({i.name, i.summary, i.needs});
    result.make = [from = family.from](const std::vector<std::string>& names) {
      std::string name = from;
      for (const std::string& n : names) name += "+" + n;
      return BackendFactory([name](const WorldSpec& world) { return make_backend(name, world); });
    };
    return result;
  }
  throw ConfigError("command line", "--explain", "two engines with known differences (mujoco and bullet)",
                    fmt::format("{} and {}", a, b));
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
