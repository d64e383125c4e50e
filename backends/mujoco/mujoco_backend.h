// MuJoCo behind the PhysicsBackend interface: what the plug-in offers.
#pragma once

#include "crossgait/physics/engine.h"

namespace crossgait::mujoco {

Engine engine();

}  // namespace crossgait::mujoco
