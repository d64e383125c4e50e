// DART behind the PhysicsBackend interface: what the plug-in offers.
#pragma once

#include <optional>
#include <string_view>

#include "physics/engine/engine.h"

namespace crossgait::dart {

/// Finds DART's dynamics under the law of a name (law.h). Nothing for names of others.
/// @throws ConfigError if a change is invalid
std::optional<Engine> find(std::string_view name);
/// Returns the family from "dart:matched" to "dart".
EngineFamily family();

}  // namespace crossgait::dart
