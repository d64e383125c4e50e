// Bullet behind the PhysicsBackend interface. The only header of this folder that others may include.
#pragma once

#include <memory>

#include "crossgait/physics/physics_backend.h"

namespace crossgait::bullet {

/// MuJoCo's contact law solved in Bullet's dynamics: agrees with MuJoCo to rounding, so that a difference has
/// a cause.
/// @throws ConfigError if the specification is invalid
std::unique_ptr<PhysicsBackend> make_matched_backend(const WorldSpec& spec);

/// Bullet's own hard contact. @throws ConfigError if the specification is invalid
std::unique_ptr<PhysicsBackend> make_native_backend(const WorldSpec& spec);

}  // namespace crossgait::bullet
