// Which PhysX this is compiled with.
#pragma once

#include <string>

#include <PxPhysicsAPI.h>
#include <fmt/format.h>

namespace crossgait::physx {

/// Returns the version of headers and library: they come in one package, and PhysX itself refuses a header of
/// another (PX_PHYSICS_VERSION is handed to it), since the library says nothing of its own.
inline std::string version() {
  return fmt::format("{}.{}.{}", PX_PHYSICS_VERSION_MAJOR, PX_PHYSICS_VERSION_MINOR,
                     PX_PHYSICS_VERSION_BUGFIX);
}

}  // namespace crossgait::physx
