// Do two worlds hold the same machine? Asked of the engines, through nothing but the public interface.
#pragma once

#include <string>
#include <vector>

#include "physics/engine/physics_backend.h"

namespace crossgait {

/// Describes one number that two worlds hold differently.
struct AuditFinding {
  std::string quantity;  ///< "mass", "armature", "joint axis", ...; see `audited_quantities`
  std::string element;   ///< the body, joint, foot or place: "body FL_lower_left"; empty for the whole world
  double a = 0, b = 0;   ///< of the two worlds
  std::string unit;      ///< "-" for none, or for entries of a pose
};

/// Lists what the audit looks at, in order: from what is read off directly to what is inferred from motion,
/// and each after all that could be mistaken for it. The first finding is therefore the cause, and later ones
/// may be its consequences.
const std::vector<std::string>& audited_quantities();

/// Holds what came of an audit.
struct ModelAudit {
  std::vector<AuditFinding> findings;  ///< at most one per quantity, its largest
  /// Quantities of which there was something to compare, `audited_quantities` in their order. Not all are:
  /// feet that stick say nothing of friction, two laws of contact have nothing to be held to.
  std::vector<std::string> compared;
};

/// Compares two worlds that are meant to be of one specification. Both are reset and moved, and end reset.
///
/// Read off: time per step; mass, centre of mass and inertia of each body; poses of the bodies at zero and
/// with one joint turned at a time (link placement, joint axis); the diagonal of the mass matrix (armature);
/// dry friction of the joints; heights of the ground at the corners and in the middle of the cells (heights,
/// diagonal). Measured in one step each: free fall (gravity); torques of each joint pushed off its target,
/// against its stop and turning (servo stiffness, effort limit, joint damping, servo damping); depth of feet
/// pressed into the ground (foot radius); force ratio of feet that slide on after the step and have the
/// same ratio at four times the speed, in both worlds (friction; not measured of a foot for which 1 to 64 m/s
/// are too slow for that); depth and number of the contact points of every body pressed into the ground from
/// eight sides (collision shape, contact points); motion of the swinging robot in the air (loops and what
/// else there may be; with loops, couplings, implicit servos or dry friction in joints only between engines
/// of one law of them). Between engines of one contact law also the force on pressed feet (contact law).
///
/// @returns differences beyond 1e-6 of the larger value or rounding (ray tests: 1e-5 m; friction, where
/// solvers stop early: 1e-3)
/// @throws ConfigError if the two robots have different bodies
ModelAudit audit_models(PhysicsBackend& a, PhysicsBackend& b);

/// Describes findings: "mass, body trunk: 0.4 against 0.42 kg; ..."
std::string describe(const std::vector<AuditFinding>& findings);
/// Describes the findings, or what is the same; then what was not compared.
std::string describe(const ModelAudit& audit);

}  // namespace crossgait
