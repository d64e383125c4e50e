#include "crossgait/backends/bullet/ingredients.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "crossgait/physics/error.h"

namespace crossgait::bullet {
namespace {

const IngredientRow& find_row(std::string_view name, std::string_view backend) {
  std::vector<std::string_view> known;
  for (const IngredientRow& row : ingredient_rows()) {
    if (row.name == name) return row;
    known.push_back(row.name);
  }
  throw ConfigError("backend", backend, fmt::format("ingredients out of {}", fmt::join(known, ", ")),
                    fmt::format("\"{}\"", name));
}

void check_meaning(const Ingredients& ingredients, std::string_view backend) {
  for (const IngredientRow& row : ingredient_rows()) {
    if (!(ingredients.*row.member)) continue;
    for (const std::string_view need : row.needs) {
      if (!(ingredients.*find_row(need, backend).member)) {
        throw ConfigError("backend", backend, fmt::format("{} along with {}", need, row.name),
                          fmt::format("{} without {}", row.name, need));
      }
    }
  }
}

}  // namespace

const std::vector<IngredientRow>& ingredient_rows() {
  using I = Ingredients;
  static const std::vector<IngredientRow> kRows{
      {"narrowphase", "contact points found by Bullet's collision detection", &I::narrowphase, {}},
      {"surface", "contact forces act on the robot's surface, not midway", &I::surface, {}},
      {"coulomb", "friction bounded by the normal force, not by MuJoCo's convex cone", &I::coulomb, {}},
      {"hard_friction", "friction stops slip at once, not like a damper", &I::hard_friction, {}},
      {"hard_normal", "penetration stops at once, not like a spring and damper", &I::hard_normal, {}},
      // A spring at a point that does not touch would push or pull through the air.
      {"speculative", "points just above the ground count", &I::speculative, {"hard_normal"}},
      // Bullet's own code has all of the others built in.
      {"sweeps",
       "Bullet's own rows and sweeps, not a converged solution",
       &I::sweeps,
       {"narrowphase", "surface", "coulomb", "hard_friction", "hard_normal", "speculative"}},
  };
  return kRows;
}

Ingredients changed(Ingredients base, std::string_view changes, std::string_view backend) {
  while (!changes.empty()) {
    const char sign = changes.front();
    const std::size_t end = std::min(changes.find_first_of("+-", 1), changes.size());
    const IngredientRow& row = find_row(changes.substr(1, end - 1), backend);
    bool& ingredient = base.*row.member;
    if (ingredient == (sign == '+')) {
      throw ConfigError("backend", backend, "changes that change something",
                        fmt::format("{}{}", sign, row.name));
    }
    ingredient = sign == '+';
    changes.remove_prefix(end);
  }
  check_meaning(base, backend);
  return base;
}

std::string name_of(const Ingredients& ingredients) {
  std::string added, removed;
  std::size_t on = 0;
  for (const IngredientRow& row : ingredient_rows()) {
    (ingredients.*row.member ? added : removed) +=
        fmt::format("{}{}", ingredients.*row.member ? '+' : '-', row.name);
    on += ingredients.*row.member ? 1 : 0;
  }
  return on <= ingredient_rows().size() / 2 ? "bullet:matched" + added : "bullet" + removed;
}

}  // namespace crossgait::bullet
