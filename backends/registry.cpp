#include "crossgait/backends/registry.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "crossgait/physics/error.h"
#if CROSSGAIT_HAS_MUJOCO
#include "crossgait/backends/mujoco/mujoco_backend.h"
#endif
#if CROSSGAIT_HAS_BULLET
#include "crossgait/backends/bullet/bullet_backend.h"
#endif

namespace crossgait {
namespace {

using Factory = std::unique_ptr<PhysicsBackend> (*)(const WorldSpec&);

struct Row {
  const char* name;
  const char* summary;
  Factory factory;  // null when not built in
  const char* missing;
};

// A further engine is one row per mode here.
constexpr Row kRows[] = {
    {"mujoco", "MuJoCo: soft contact, elliptic friction cones, Newton solver",
#if CROSSGAIT_HAS_MUJOCO
     mujoco::make_mujoco_backend,
#else
     nullptr,
#endif
     "MuJoCo was not found when Crossgait was built (Debian: libmujoco-dev)"},
    {"bullet:matched", "Bullet dynamics under MuJoCo's contact law: equal to `mujoco` up to rounding",
#if CROSSGAIT_HAS_BULLET
     bullet::make_matched_backend,
#else
     nullptr,
#endif
     "float64 Bullet was not found when Crossgait was built (Debian: libbullet-dev)"},
    {"bullet", "Bullet with its own hard contact: the independent second opinion",
#if CROSSGAIT_HAS_BULLET
     bullet::make_native_backend,
#else
     nullptr,
#endif
     "float64 Bullet was not found when Crossgait was built (Debian: libbullet-dev)"},
};

std::string_view canonical(std::string_view name) { return name == "bullet:native" ? "bullet" : name; }

}  // namespace

const std::vector<BackendEntry>& known_backends() {
  static const std::vector<BackendEntry> kEntries = [] {
    std::vector<BackendEntry> entries;
    for (const Row& row : kRows) {
      const bool available = row.factory != nullptr;
      entries.push_back({row.name, row.summary, available, available ? "" : row.missing});
    }
    return entries;
  }();
  return kEntries;
}

std::vector<std::string> available_backends() {
  std::vector<std::string> names;
  for (const BackendEntry& entry : known_backends()) {
    if (entry.available) names.push_back(entry.name);
  }
  return names;
}

std::unique_ptr<PhysicsBackend> make_backend(std::string_view name, const WorldSpec& spec) {
  for (const Row& row : kRows) {
    if (canonical(name) != row.name) continue;
    if (row.factory == nullptr) throw ConfigError("backend", name, "a backend that is built in", row.missing);
    return row.factory(spec);
  }
  throw ConfigError("backend", "name", fmt::format("one of {}", fmt::join(available_backends(), ", ")),
                    fmt::format("\"{}\"", name));
}

}  // namespace crossgait
