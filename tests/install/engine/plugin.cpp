// The plug-in libcrossgait_engine_statue.so.
#include "statue.h"

#include "crossgait/physics/engine_plugin.h"

namespace {

using namespace crossgait;

// An engine with a library of its own asks its headers for the one and the library for the other.
std::string version() { return "1.0"; }

constexpr EnginePlugin kPlugin{
    .header_version = version,
    .library_version = version,
    .engines =
        [] {
          return std::vector<OfferedEngine>{{statue::engine("statue", version()).info, "Stone"}};
        },
    .families = [] { return std::vector<EngineFamily>(); },
    .find = [](std::string_view name) -> std::optional<Engine> {
      if (name != "statue") return std::nullopt;
      return statue::engine("statue", version());
    },
};

}  // namespace

const EnginePlugin* crossgait_engine_plugin() { return &kPlugin; }
