// The plug-in libcrossgait_engine_dart.so.
#include <string>
#include <vector>

#include <dart/config.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dlfcn.h>

#include "backends/dart/dart_backend.h"
#include "physics/engine/engine_plugin.h"

namespace crossgait::dart {
namespace {

std::string header_version() { return DART_VERSION; }

// DART's library does not say its version, but its file does: libdart.so.6.12, or libdart.so.6.12.1 behind
// it.
std::string library_version() {
  Dl_info library{};
  const auto create =
      static_cast<::dart::dynamics::SkeletonPtr (*)(const std::string&)>(&::dart::dynamics::Skeleton::create);
  if (dladdr(reinterpret_cast<const void*>(create), &library) == 0) return header_version();
  const std::string_view file = library.dli_fname;
  constexpr std::string_view kEnding = ".so.";
  const std::size_t ending = file.rfind(kEnding);
  if (ending == std::string_view::npos) return header_version();
  const std::string_view version = file.substr(ending + kEnding.size());
  // A soname is as much of the version as a library of the same interface has.
  return header_version().starts_with(version) ? header_version() : std::string(version);
}

std::vector<OfferedEngine> engines() {
  return {{find("dart:matched")->info,
           "DART dynamics under MuJoCo's contact law: equal to `mujoco` up to rounding"},
          {find("dart")->info,
           "DART dynamics with hard contact and Coulomb's disc: Bullet's law, solved to convergence"}};
}

constexpr EnginePlugin kPlugin{
    .rank = 20,
    .header_version = header_version,
    .library_version = library_version,
    .engines = engines,
    .families = [] { return std::vector<EngineFamily>{family()}; },
    .find = find,
};

}  // namespace
}  // namespace crossgait::dart

const crossgait::EnginePlugin* crossgait_engine_plugin() { return &crossgait::dart::kPlugin; }
