// How long a run takes in engines that are slow, said before it begins.
#pragma once

#include <string>
#include <vector>

#include "motion/walk.h"
#include "physics/engine/world_spec.h"

namespace crossgait::apps {

/// Notes on standard error how long a walk will take in each engine that runs in a process of its own, by a
/// few steps of standing that are made for that; nothing of less than ten seconds.
/// @throws ConfigError as the walk itself does: of an engine that there is not, or that refuses the world
void note_cost(const std::vector<std::string>& engines, const WorldSpec& world, const WalkTiming& timing);

}  // namespace crossgait::apps
