// What people are told of a run before it begins.
#pragma once

#include <string>
#include <vector>

#include "env/loaded_env.h"
#include "study/loaded_walk.h"

namespace crossgait {

/// Returns a sentence for whatever is limited or doubtful in what is asked for: a physics step in which
/// contact or servos may swing (`step_warnings`), gait parameters beyond their ranges, feet that are not
/// lifted as asked (`parameter_notes`).
std::vector<std::string> notes_on(const LoadedEnv& environment);
/// @param gait  by name, as the walk's was chosen
std::vector<std::string> notes_on(const LoadedWalk& walk, const std::string& gait);

}  // namespace crossgait
