#include "physics/engine/world_spec.h"

#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait {
namespace {

void require(bool ok, std::string_view element, std::string_view expected, double found) {
  if (!ok) throw ConfigError("world specification", element, expected, fmt::format("{}", found));
}

}  // namespace

void WorldSpec::lengthen_time_constants(double dt) {
  const auto lengthen = [dt](Softness& softness) {
    const double before = softness.time_constant;
    softness.time_constant = time_constant_in_steps(before, dt);
    return softness.time_constant != before;
  };
  lengthen(contact.softness);
  if (!robot) return;
  RobotDescription own = *robot;
  bool changed = lengthen(own.loop_softness);
  changed |= lengthen(own.friction_softness);
  for (JointCoupling& coupling : own.couplings) changed |= lengthen(coupling.softness);
  for (Body& body : own.bodies) changed |= lengthen(body.joint.limit_softness);
  if (changed) robot = std::make_shared<const RobotDescription>(std::move(own));
}

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
