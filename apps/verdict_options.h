// Options that `verdict` and `compare --verdict` share: what is run, how often, and in which engines.
#pragma once

#include "crossgait/apps/walk_options.h"
#include "crossgait/parity/attribution.h"
#include "crossgait/parity/verdict.h"

namespace crossgait::apps {

/// The walk of `world` and `walk` from starts near the origin; the terrain's seed grows by one per start.
/// @param robot,world must outlive the behaviour
Behaviour walk_behaviour(const WorldOptions& world, const WalkOptions& walk, const WorldSpec& spec,
                         const StartSpread& spread);

/// The built-in family whose ends are `a` and `b`, either way round; an engine of the same laws may stand for
/// an end. @throws ConfigError if there is none
EngineFamily find_family(const Engine& a, const Engine& b);

/// How runs are spread and judged.
struct SpreadOptions {
  VerdictOptions verdict;
  StartSpread spread;

  SpreadOptions();
  void add_to(CLI::App& command);
};

}  // namespace crossgait::apps
