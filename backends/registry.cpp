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
#include "crossgait/backends/bullet/ingredients.h"
#endif

namespace crossgait {
namespace {

using Factory = std::unique_ptr<PhysicsBackend> (*)(const WorldSpec&, std::string_view changes);

#if CROSSGAIT_HAS_MUJOCO
std::unique_ptr<PhysicsBackend> make_mujoco(const WorldSpec& spec, std::string_view changes) {
  if (!changes.empty()) throw ConfigError("backend", "mujoco", "no ingredients: it has none", changes);
  return mujoco::make_mujoco_backend(spec);
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
     make_mujoco,
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

// "bullet:matched+surface" -> "bullet:matched" and "+surface".
std::pair<std::string_view, std::string_view> split(std::string_view name) {
  const std::size_t end = std::min(name.find_first_of("+-"), name.size());
  return {canonical(name.substr(0, end)), name.substr(end)};
}

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

const std::vector<BackendFamily>& backend_families() {
  static const std::vector<BackendFamily> kFamilies = [] {
    std::vector<BackendFamily> families;
#if CROSSGAIT_HAS_BULLET
    BackendFamily family{"bullet:matched", "bullet", {}};
    for (const bullet::IngredientRow& row : bullet::ingredient_rows()) {
      family.ingredients.push_back(
          {std::string(row.name), std::string(row.summary), {row.needs.begin(), row.needs.end()}});
    }
    families.push_back(std::move(family));
#endif
    return families;
  }();
  return kFamilies;
}

std::unique_ptr<PhysicsBackend> make_backend(std::string_view name, const WorldSpec& spec) {
  const auto [base, changes] = split(name);
  for (const Row& row : kRows) {
    if (base != row.name) continue;
    if (row.factory == nullptr) throw ConfigError("backend", name, "a backend that is built in", row.missing);
    return row.factory(spec, changes);
  }
  throw ConfigError("backend", "name", fmt::format("one of {}", fmt::join(available_backends(), ", ")),
                    fmt::format("\"{}\"", name));
}

}  // namespace crossgait
