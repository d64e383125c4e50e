// Bullet behind the PhysicsBackend interface. The only header of this folder that others may include.
#pragma once

#include <string_view>

#include "crossgait/physics/engine.h"

namespace crossgait::bullet {

/// MuJoCo's contact law solved in Bullet's dynamics: agrees with MuJoCo to rounding, so that a difference has
/// a cause.
/// @param changes factors of Bullet's put in, "+surface+coulomb"; see contact_factors.h
/// @throws ConfigError if a change is invalid
Engine matched_engine(std::string_view changes = {});

/// Bullet's own hard contact. @param changes factors taken out for MuJoCo's, "-sweeps"
/// @throws ConfigError if a change is invalid
Engine native_engine(std::string_view changes = {});

/// From the one to the other.
EngineFamily family();

}  // namespace crossgait::bullet
