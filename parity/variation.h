// What a user sets up one way or another without asking about it: the step, and the settings of an engine.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "physics/engine/physics_backend.h"

namespace crossgait {

/// Describes one way of setting up the same world.
struct Variation {
  enum class Kind { kNominal, kTimeStep, kSetting };
  std::string_view name = "as asked";
  Kind kind = Kind::kNominal;
  /// Factors on the world's time step, solver iterations, impratio, time constant of its softness, and share
  /// of a penetration that a step undoes.
  double step = 1, iterations = 1, impratio = 1, softness = 1, erp = 1;
  /// Tells whether an engine declares that it can make a difference there; null: in every engine.
  bool (*concerns)(const Capabilities&) = nullptr;

  bool of(const EngineInfo& engine) const { return concerns == nullptr || concerns(engine.capabilities); }
  /// @param physics_dt  as asked, s: what is soft stays as soft as it is in such steps, whatever the step
  void apply(WorldSpec& world, double physics_dt) const;
};

/// Lists the variations: as asked, half the time step, a quarter of it, then settings.
std::span<const Variation> variations();
/// Returns the variation as asked; those below half the time step, or a quarter of it.
const Variation& nominal_variation();
const Variation& half_step();
const Variation& quarter_step();
/// @throws ConfigError listing the names
const Variation& find_variation(std::string_view name);

}  // namespace crossgait
