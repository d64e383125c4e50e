// Engines by name, at run time.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "crossgait/physics/engine.h"

namespace crossgait {

/// One name a user can choose.
struct EngineListing {
  std::string name;        ///< "mujoco", "bullet", "bullet:matched"
  std::string summary;     ///< one line
  bool available = false;  ///< built in
  std::string reason;      ///< why not, when not
};

/// Every engine Crossgait knows, built in or not, in a fixed order.
const std::vector<EngineListing>& known_engines();
/// Names of those built in.
std::vector<std::string> available_engines();

/// Those built in.
const std::vector<EngineFamily>& engine_families();

/// The engine of a name: one of `available_engines()`; "bullet:native" is an alias of "bullet". A family's
/// `from` may be followed by factors "+NAME", its `to` by "-NAME": "bullet:matched+surface+coulomb",
/// "bullet-sweeps".
/// @throws ConfigError for an unknown or unavailable name (listing the available ones)
Engine find_engine(std::string_view name);

/// find_engine(name).make(spec).
std::unique_ptr<PhysicsBackend> make_backend(std::string_view name, const WorldSpec& spec);

}  // namespace crossgait
