// The plug-in libcrossgait_engine_physx.so.
#include "backends/physx/matched_backend.h"
#include "backends/physx/physx_backend.h"
#include "backends/physx/version.h"
#include "physics/engine/engine_plugin.h"

namespace crossgait::physx {
namespace {

std::vector<OfferedEngine> engines() {
  return {{find("physx:matched")->info,
           "PhysX's dynamics under MuJoCo's contact law: equal to `mujoco` as far as float32 goes"},
          {find("physx")->info,
           "PhysX's own dynamics, contact points and patch friction: where most published policies were "
           "trained"}};
}

constexpr EnginePlugin kPlugin{
    .rank = 30,
    .header_version = version,
    .library_version = version,
    .engines = engines,
    .families =
        [] {
          return std::vector<EngineFamily>{law_family(), family(), whole_family()};
        },
    .find = find,
};

}  // namespace
}  // namespace crossgait::physx

const crossgait::EnginePlugin* crossgait_engine_plugin() { return &crossgait::physx::kPlugin; }
