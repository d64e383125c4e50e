#include "physics/engine/world_spec.h"

#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait {
namespace {

void require(bool ok, std::string_view element, std::string_view expected, double found) {
  if (!ok) throw ConfigError("world specification", element, expected, fmt::format("{}", found));
}

}  // namespace

void WorldSpec::validate() const {
  if (!robot) throw ConfigError("world specification", "robot", "a robot description", "none");
  robot->validate();
  require(physics_dt >= kShortestPhysicsStep && physics_dt <= kLongestPhysicsStep, "physics_dt",
          fmt::format("a time step in [{:g}, {:g}] s", kShortestPhysicsStep, kLongestPhysicsStep),
          physics_dt);
  if (!gravity.allFinite()) {
    throw ConfigError("world specification", "gravity", "three finite numbers, m/s^2",
                      "a value that is not finite");
  }
  validate_contact(contact, "world specification");
  require(solver.tolerance >= 0 && solver.tolerance <= 1e-3, "solver.tolerance", "a tolerance in [0, 1e-3]",
          solver.tolerance);
  require(solver.iterations >= 1 && solver.iterations <= 100000, "solver.iterations",
          "a count in [1, 100000]", solver.iterations);
}

}  // namespace crossgait
