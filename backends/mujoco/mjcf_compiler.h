// MuJoCo's compiler for files that others wrote.
#pragma once

#include "physics/robot_files/mjcf/mjcf_model.h"

namespace crossgait::mujoco {

/// Returns what MuJoCo makes of an MJCF text, in Crossgait's terms. Opens no file: those that the text names
/// have to be in it. @throws std::runtime_error with MuJoCo's words
MjcfModel compile_text(const MjcfText& text);

}  // namespace crossgait::mujoco
