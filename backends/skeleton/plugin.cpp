// The plug-in libcrossgait_engine_skeleton.so: one engine, no family of factors.
#include "skeleton_backend.h"

#include "crossgait/physics/engine/engine_plugin.h"

namespace {

using namespace crossgait;

// An engine with a library of its own asks its headers for the one and the library for the other.
std::string version() { return "1.0"; }

constexpr EnginePlugin kPlugin{
    .rank = 200,  // after the engines that come with Crossgait: none of its defaults changes
    .header_version = version,
    .library_version = version,
    .engines =
        [] {
          return std::vector<OfferedEngine>{
              {skeleton::engine(version()).info, "Plain code: hard contact on a composite-rigid-body tree"}};
        },
    .families = [] { return std::vector<EngineFamily>(); },
    .find = [](std::string_view name) -> std::optional<Engine> {
      Engine engine = skeleton::engine(version());
      if (name != engine.name()) return std::nullopt;
      return engine;
    },
};

}  // namespace

const EnginePlugin* crossgait_engine_plugin() { return &kPlugin; }
