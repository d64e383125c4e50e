// PhysX's dynamics under laws that engines share, as far as float32 goes.
#pragma once

#include <optional>
#include <string_view>

#include "backends/contact/law_factors.h"
#include "backends/physx/settings.h"
#include "physics/engine/engine.h"

namespace crossgait::physx {

/// Returns the factors from "physx:matched", MuJoCo's law, to "physx:hard": hard contact with Coulomb's disc,
/// solved to convergence.
const contact::FactorTable<contact::LawFactors>& law_table();

/// Finds PhysX's dynamics under the law of a name of that table. Nothing for names of others.
/// @throws ConfigError if a change is invalid
std::optional<Engine> find_matched(std::string_view name);
/// Returns PhysX's dynamics under "physx:hard" with the settings that need no solver of PhysX's.
Engine shared_engine(const Settings& settings);

/// Returns the family from "physx:matched" to "physx:hard".
EngineFamily law_family();

}  // namespace crossgait::physx
