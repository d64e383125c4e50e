// Bullet behind the PhysicsBackend interface. The only header of this folder that others may include.
#pragma once

#include <memory>
#include <string_view>

#include "crossgait/physics/physics_backend.h"

namespace crossgait::bullet {

/// MuJoCo's contact law solved in Bullet's dynamics: agrees with MuJoCo to rounding, so that a difference has
/// a cause.
/// @param changes ingredients of Bullet's put in, "+surface+coulomb"; see ingredients.h
/// @throws ConfigError if the specification or a change is invalid
std::unique_ptr<PhysicsBackend> make_matched_backend(const WorldSpec& spec, std::string_view changes = {});

/// Bullet's own hard contact. @param changes ingredients taken out for MuJoCo's, "-sweeps"
/// @throws ConfigError if the specification or a change is invalid
std::unique_ptr<PhysicsBackend> make_native_backend(const WorldSpec& spec, std::string_view changes = {});

}  // namespace crossgait::bullet
