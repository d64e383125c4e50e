// MuJoCo behind the PhysicsBackend interface. The only header of this folder that others may include.
#pragma once

#include <memory>

#include "crossgait/physics/physics_backend.h"

namespace crossgait::mujoco {

/// @throws ConfigError if the specification is invalid or MuJoCo refuses the model
std::unique_ptr<PhysicsBackend> make_mujoco_backend(const WorldSpec& spec);

}  // namespace crossgait::mujoco
