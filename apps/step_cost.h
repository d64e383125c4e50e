// How long a run takes in engines that are slow, said before it begins.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "env/loaded_env.h"
#include "motion/walk.h"
#include "physics/engine/world_spec.h"

namespace crossgait::apps {

/// Notes on standard error how long something will take in each engine that runs in a process of its own, by
/// a few steps of standing that are made for that; nothing of less than ten seconds.
/// @param seconds  of simulated time, in each of them  @param what  that takes them: "this walk"
/// @throws ConfigError as the walk itself does: of an engine that there is not, or that refuses the world
void note_cost(const std::vector<std::string>& engines, const WorldSpec& world, double seconds,
               std::string_view what);
void note_cost(const std::vector<std::string>& engines, const WorldSpec& world, const WalkTiming& timing);
/// Notes it of an environment's motions, each of which begins by standing. @param seconds  of one of them
void note_cost(const std::vector<std::string>& engines, const LoadedEnv& environment, double seconds,
               std::size_t motions, std::string_view what);

}  // namespace crossgait::apps
