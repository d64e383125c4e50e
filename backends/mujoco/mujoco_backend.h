// MuJoCo behind the PhysicsBackend interface. The only header of this folder that others may include.
#pragma once

#include "crossgait/physics/engine.h"

namespace crossgait::mujoco {

Engine engine();

}  // namespace crossgait::mujoco
