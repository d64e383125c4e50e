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

/// @param name one of `available_backends()`; "bullet:native" is an alias of "bullet"
/// @throws ConfigError for an unknown or unavailable name (listing the available ones) or an invalid
/// specification
std::unique_ptr<PhysicsBackend> make_backend(std::string_view name, const WorldSpec& spec);

}  // namespace crossgait
