#include "crossgait/backends/bullet/contact_factors.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "crossgait/physics/error.h"

namespace crossgait::bullet {
namespace {

const FactorRow& find_row(std::string_view name, std::string_view backend) {
  std::vector<std::string_view> known;
  for (const FactorRow& row : factor_rows()) {
    if (row.factor.name == name) return row;
    known.push_back(row.factor.name);
  }
  throw ConfigError("engine", backend, fmt::format("factors out of {}", fmt::join(known, ", ")),
                    fmt::format("\"{}\"", name));
}

void check_meaning(const ContactFactors& factors, std::string_view backend) {
  for (const FactorRow& row : factor_rows()) {
    if (!(factors.*row.member)) continue;
    for (const std::string_view need : row.factor.needs) {
      if (!(factors.*find_row(need, backend).member)) {
        throw ConfigError("engine", backend, fmt::format("{} along with {}", need, row.factor.name),
                          fmt::format("{} without {}", row.factor.name, need));
      }
    }
  }
}

}  // namespace

const std::vector<FactorRow>& factor_rows() {
  using F = ContactFactors;
  static const std::vector<FactorRow> kRows{
      {{"narrowphase", "contact points found by Bullet's collision detection", {}}, &F::narrowphase},
      {{"surface", "contact forces act on the robot's surface, not midway", {}}, &F::surface},
      {{"coulomb", "friction bounded by the normal force, not by MuJoCo's convex cone", {}}, &F::coulomb},
      {{"hard_friction", "friction stops slip at once, not like a damper", {}}, &F::hard_friction},
      {{"hard_normal", "penetration stops at once, not like a spring and damper", {}}, &F::hard_normal},
      // A spring at a point that does not touch would push or pull through the air.
      {{"speculative", "points just above the ground count", {"hard_normal"}}, &F::speculative},
      {{"hard_joint_friction",
        "dry friction stops a joint at once, not like a damper",
        {},
        [](const RobotDescription& robot) { return robot.has_joint_friction(); }},
       &F::hard_joint_friction},
      // Bullet's own code has all of the others built in.
      {{"sweeps",
        "Bullet's own rows and sweeps, not a converged solution",
        {"narrowphase", "surface", "coulomb", "hard_friction", "hard_normal", "speculative",
         "hard_joint_friction"}},
       &F::sweeps},
  };
  return kRows;
}

ContactFactors changed(ContactFactors base, std::string_view changes, std::string_view backend) {
  while (!changes.empty()) {
    const std::string_view change = take_change(changes);
    bool& factor = base.*find_row(change.substr(1), backend).member;
    const bool adds = change.front() == '+';
    if (factor == adds)
      throw ConfigError("engine", backend, "changes that change something", std::string(change));
    factor = adds;
  }
  check_meaning(base, backend);
  return base;
}

std::string name_of(const ContactFactors& factors) {
  std::string added, removed;
  std::size_t on = 0;
  for (const FactorRow& row : factor_rows()) {
    (factors.*row.member ? added : removed) +=
        fmt::format("{}{}", factors.*row.member ? '+' : '-', row.factor.name);
    on += factors.*row.member ? 1 : 0;
  }
  return on <= factor_rows().size() / 2 ? "bullet:matched" + added : "bullet" + removed;
}

}  // namespace crossgait::bullet
