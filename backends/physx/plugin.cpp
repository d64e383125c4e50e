// The plug-in libcrossgait_engine_physx.so.
#include <fmt/format.h>

#include "backends/physx/foundation.h"
#include "backends/physx/physx_backend.h"
#include "physics/engine/engine_plugin.h"

namespace crossgait::physx {
namespace {

// The library says nothing of its version: header and library come in one package, and PhysX itself refuses a
// header of another (PX_PHYSICS_VERSION is handed to it).
std::string version() {
  return fmt::format("{}.{}.{}", PX_PHYSICS_VERSION_MAJOR, PX_PHYSICS_VERSION_MINOR,
                     PX_PHYSICS_VERSION_BUGFIX);
}

std::vector<OfferedEngine> engines() {
  return {{find("physx")->info,
           "PhysX's own dynamics, contact points and patch friction: where most published policies were "
           "trained"}};
}

constexpr EnginePlugin kPlugin{
    .rank = 30,
    .header_version = version,
    .library_version = version,
    .engines = engines,
    .families = [] { return std::vector<EngineFamily>{family()}; },
    .find = find,
};

}  // namespace
}  // namespace crossgait::physx

const crossgait::EnginePlugin* crossgait_engine_plugin() { return &crossgait::physx::kPlugin; }
