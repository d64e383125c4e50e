// Engines outside this process, which may be gone in the middle of a step.
#pragma once

#include "physics/engine/physics_backend.h"

namespace crossgait {

/// Is a world whose engine may be lost: then no step is made, which PhysicsBackend::step reports as
/// kDiverged, since it throws nothing.
class LosableWorld {
 public:
  virtual ~LosableWorld() = default;
  LosableWorld(const LosableWorld&) = delete;
  LosableWorld& operator=(const LosableWorld&) = delete;

  /// @throws ConfigError naming what serves the engine, what was asked and what came of it
  virtual void throw_if_lost() const = 0;

 protected:
  LosableWorld() = default;
};

/// Throws what is wrong where a step was not made because the engine is lost. Call it after a step that is
/// not kOk, before that is taken for a divergence. @throws ConfigError
inline void throw_if_lost(const PhysicsBackend& world) {
  if (const auto* losable = dynamic_cast<const LosableWorld*>(&world)) losable->throw_if_lost();
}

}  // namespace crossgait
