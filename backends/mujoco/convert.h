// From MuJoCo's vectors to Eigen's.
#pragma once

#include <mujoco/mujoco.h>

#include "physics/core/math.h"

namespace crossgait::mujoco {

inline Vector3 vector(const mjtNum* v) { return {v[0], v[1], v[2]}; }

}  // namespace crossgait::mujoco
