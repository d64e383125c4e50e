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
  const Softness& s = contact.softness;
  require(contact.friction >= 0 && contact.friction <= 10, "contact.friction", "a coefficient in [0, 10]",
          contact.friction);
  require(contact.impratio > 0 && contact.impratio <= 1000, "contact.impratio", "a ratio in (0, 1000]",
          contact.impratio);
  require(s.time_constant > 0 && s.time_constant <= 10, "contact.softness.time_constant",
          "a time in (0, 10] s", s.time_constant);
  require(s.damping_ratio > 0 && s.damping_ratio <= 100, "contact.softness.damping_ratio",
          "a ratio in (0, 100]", s.damping_ratio);
  require(s.impedance_min > 0 && s.impedance_min < 1, "contact.softness.impedance_min",
          "an impedance in (0, 1)", s.impedance_min);
  require(s.impedance_max >= s.impedance_min && s.impedance_max < 1, "contact.softness.impedance_max",
          "an impedance in [impedance_min, 1)", s.impedance_max);
  require(s.impedance_width > 0 && s.impedance_width <= 1, "contact.softness.impedance_width",
          "a length in (0, 1] m", s.impedance_width);
  require(solver.tolerance >= 0 && solver.tolerance <= 1e-3, "solver.tolerance", "a tolerance in [0, 1e-3]",
          solver.tolerance);
  require(solver.iterations >= 1 && solver.iterations <= 100000, "solver.iterations",
          "a count in [1, 100000]", solver.iterations);
}

}  // namespace crossgait
