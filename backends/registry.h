// Picks an engine by name at run time.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "crossgait/physics/physics_backend.h"

namespace crossgait {

/// One name a user can choose.
struct BackendEntry {
  std::string name;        ///< "mujoco", "bullet", "bullet:matched"
  std::string summary;     ///< one line
  bool available = false;  ///< built in
  std::string reason;      ///< why not, when not
};

/// Every backend Crossgait knows, built in or not, in a fixed order.
const std::vector<BackendEntry>& known_backends();
/// Names of those built in.
std::vector<std::string> available_backends();

/// One difference between two backends that can be made on its own.
struct BackendIngredient {
  std::string name, summary;
  std::vector<std::string> needs;  ///< ingredients without which it means nothing
};

/// Two backends of one engine and all that is different between them: `from` with every ingredient is `to`.
struct BackendFamily {
  std::string from, to;
  std::vector<BackendIngredient> ingredients;  ///< each after those it needs
};

/// Those built in.
const std::vector<BackendFamily>& backend_families();

/// @param name one of `available_backends()`; "bullet:native" is an alias of "bullet". A family's `from` may
/// be followed by ingredients "+NAME", its `to` by "-NAME": "bullet:matched+surface+coulomb",
/// "bullet-sweeps".
/// @throws ConfigError for an unknown or unavailable name (listing the available ones) or an invalid
/// specification
std::unique_ptr<PhysicsBackend> make_backend(std::string_view name, const WorldSpec& spec);

}  // namespace crossgait
