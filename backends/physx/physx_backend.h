// PhysX behind the PhysicsBackend interface: what the plug-in offers.
#pragma once

#include <optional>
#include <string_view>

#include "physics/engine/engine.h"

namespace crossgait::physx {

/// Finds PhysX under the settings of a name (settings.h). Nothing for names of others.
/// @throws ConfigError if a change is invalid
std::optional<Engine> find(std::string_view name);
/// Returns the family from "physx:hard" to "physx".
EngineFamily family();
/// Returns the family from "physx:matched" to "physx", in which all of the other is one factor.
EngineFamily whole_family();

}  // namespace crossgait::physx
