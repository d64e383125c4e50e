// A model of MuJoCo's out of a file, so that a fork meanwhile is whole.
#pragma once

#include <mujoco/mujoco.h>

namespace crossgait::mujoco {

/// Returns mj_loadXML's model of "model.xml" in `files`, or null, with `error` saying why. MuJoCo reads under
/// a lock of its own, which in a fork of the process by another thread would never be released: forks wait
/// until nothing is being read.
mjModel* read_model(const mjVFS* files, char* error, int error_size);

}  // namespace crossgait::mujoco
