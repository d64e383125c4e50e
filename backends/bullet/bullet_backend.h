// Bullet behind the PhysicsBackend interface: what the plug-in offers.
#pragma once

#include <optional>
#include <string_view>

#include "physics/engine/engine.h"

namespace crossgait::bullet {

/// Returns MuJoCo's contact law in Bullet's dynamics: it agrees with MuJoCo to rounding, so that a difference
/// has a cause.
/// @param changes factors of Bullet's put in, "+surface+coulomb"; see contact_factors.h
/// @throws ConfigError if a change is invalid
Engine matched_engine(std::string_view changes = {});

/// Returns Bullet's own hard contact. @param changes factors taken out for MuJoCo's, "-sweeps"
/// @throws ConfigError if a change is invalid
Engine native_engine(std::string_view changes = {});

/// Returns what `bullet` is held against: contacts and dry friction in joints by the code of Bullet's
/// library, in place of the same rows and sweeps by Crossgait's. Slower, and no part of the family.
Engine own_engine();

/// Finds any of them by its name: "bullet:matched" and "bullet" (or "bullet:native") with changes behind
/// them, "bullet:own". Nothing for any other name.
/// @throws ConfigError if a change is invalid
std::optional<Engine> find(std::string_view name);

/// Returns the family from the one to the other.
EngineFamily family();

}  // namespace crossgait::bullet
