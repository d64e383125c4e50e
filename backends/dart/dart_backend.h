// DART behind the PhysicsBackend interface: what the plug-in offers.
#pragma once

#include <optional>
#include <string_view>

#include "crossgait/physics/engine.h"

namespace crossgait::dart {

/// MuJoCo's contact law solved in DART's dynamics. @param changes  "+surface+coulomb"; see law.h
/// @throws ConfigError if a change is invalid
Engine matched_engine(std::string_view changes = {});
/// Hard contact with Coulomb's disc. @param changes  "-speculative"
/// @throws ConfigError if a change is invalid
Engine hard_engine(std::string_view changes = {});
/// Either of them by its name, with changes behind it. Nothing for any other name.
/// @throws ConfigError if a change is invalid
std::optional<Engine> find(std::string_view name);
/// From the one to the other.
EngineFamily family();

}  // namespace crossgait::dart
