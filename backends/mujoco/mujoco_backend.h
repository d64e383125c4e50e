// MuJoCo behind the PhysicsBackend interface: what the plug-in offers.
#pragma once

#include "physics/engine/engine.h"

namespace crossgait::mujoco {

/// @param loop_bias  false: without what newer releases add to the law of the loops (version.h)
Engine engine(bool loop_bias = true);

}  // namespace crossgait::mujoco
