#include "crossgait/backends/registry.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "crossgait/physics/error.h"
#if CROSSGAIT_HAS_MUJOCO
#include "crossgait/backends/mujoco/mujoco_backend.h"
#endif
#if CROSSGAIT_HAS_BULLET
#include "crossgait/backends/bullet/bullet_backend.h"
#include "crossgait/backends/bullet/contact_factors.h"
#endif

namespace crossgait {
namespace {

// Makes the engine with `changes` ("+surface", "-sweeps") of its factors.
using Factory = Engine (*)(std::string_view changes);

#if CROSSGAIT_HAS_MUJOCO
Engine mujoco_engine(std::string_view changes) {
  if (!changes.empty()) throw ConfigError("engine", "mujoco", "no factors: it has none", changes);
  return mujoco::engine();
}
#endif

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
     mujoco_engine,
#else
     nullptr,
#endif
     "MuJoCo was not found when Crossgait was built (Debian: libmujoco-dev)"},
    {"bullet:matched", "Bullet dynamics under MuJoCo's contact law: equal to `mujoco` up to rounding",
#if CROSSGAIT_HAS_BULLET
     bullet::matched_engine,
#else
     nullptr,
#endif
     "float64 Bullet was not found when Crossgait was built (Debian: libbullet-dev)"},
    {"bullet", "Bullet with its own hard contact: the independent second opinion",
#if CROSSGAIT_HAS_BULLET
     bullet::native_engine,
#else
     nullptr,
#endif
     "float64 Bullet was not found when Crossgait was built (Debian: libbullet-dev)"},
};

std::string_view canonical(std::string_view name) { return name == "bullet:native" ? "bullet" : name; }

// "bullet:matched+surface" -> "bullet:matched" and "+surface".
std::pair<std::string_view, std::string_view> split(std::string_view name) {
  const std::size_t end = std::min(name.find_first_of("+-"), name.size());
  return {canonical(name.substr(0, end)), name.substr(end)};
}

}  // namespace

const std::vector<EngineListing>& known_engines() {
  static const std::vector<EngineListing> kEntries = [] {
    std::vector<EngineListing> entries;
    for (const Row& row : kRows) {
      const bool available = row.factory != nullptr;
      entries.push_back({row.name, row.summary, available, available ? "" : row.missing});
    }
    return entries;
  }();
  return kEntries;
}

std::vector<std::string> available_engines() {
  std::vector<std::string> names;
  for (const EngineListing& entry : known_engines()) {
    if (entry.available) names.push_back(entry.name);
  }
  return names;
}

const std::vector<EngineFamily>& engine_families() {
  static const std::vector<EngineFamily> kFamilies = [] {
    std::vector<EngineFamily> families;
#if CROSSGAIT_HAS_BULLET
    families.push_back(bullet::family());
#endif
    return families;
  }();
  return kFamilies;
}

Engine find_engine(std::string_view name) {
  const auto [base, changes] = split(name);
  for (const Row& row : kRows) {
    if (base != row.name) continue;
    if (row.factory == nullptr) throw ConfigError("engine", name, "an engine that is built in", row.missing);
    return row.factory(changes);
  }
  throw ConfigError("engine", "name", fmt::format("one of {}", fmt::join(available_engines(), ", ")),
                    fmt::format("\"{}\"", name));
}

std::unique_ptr<PhysicsBackend> make_backend(std::string_view name, const WorldSpec& spec) {
  return find_engine(name).make(spec);
}

}  // namespace crossgait
