// The plug-in libcrossgait_engine_bullet.so.
#include <LinearMath/btAlignedAllocator.h>
#include <LinearMath/btScalar.h>
#include <dlfcn.h>
#include <fmt/format.h>

#include "backends/bullet/bullet_backend.h"
#include "physics/engine/engine_plugin.h"

namespace crossgait::bullet {
namespace {

std::string header_version() {
  return fmt::format("{}.{:02}", BT_BULLET_VERSION / 100, BT_BULLET_VERSION % 100);
}

// Bullet's library does not say its version (btGetVersion is inline), but its file does:
// libLinearMath-float64.so.3.24. A Bullet linked into the plug-in cannot differ from its headers any more.
std::string library_version() {
  Dl_info library{};
  if (dladdr(reinterpret_cast<const void*>(&btAlignedAllocInternal), &library) == 0) return header_version();
  const std::string_view file = library.dli_fname;
  constexpr std::string_view kEnding = ".so.";
  const std::size_t ending = file.rfind(kEnding);
  if (ending == std::string_view::npos) return header_version();
  return std::string(file.substr(ending + kEnding.size()));
}

std::vector<OfferedEngine> engines() {
  return {
      {matched_engine().info, "Bullet dynamics under MuJoCo's contact law: equal to `mujoco` up to rounding"},
      {native_engine().info, "Bullet with its own hard contact: the independent second opinion"}};
}

constexpr EnginePlugin kPlugin{
    .rank = 10,
    .header_version = header_version,
    .library_version = library_version,
    .engines = engines,
    .families = [] { return std::vector<EngineFamily>{family()}; },
    .find = find,
};

}  // namespace
}  // namespace crossgait::bullet

const crossgait::EnginePlugin* crossgait_engine_plugin() { return &crossgait::bullet::kPlugin; }
