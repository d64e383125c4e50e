// What a law of contact, joint friction and joint limits is made of, piece by piece, so that a difference
// between two can be traced to one.
#pragma once

#include <string>
#include <vector>

#include "backends/contact/factor_table.h"
#include "physics/robot/contact_settings.h"

namespace crossgait::contact {

/// Says for each piece whether it is MuJoCo's (false) or that of an engine with hard contact (true).
struct LawFactors {
  bool surface = false;        ///< forces act on the robot's surface, not midway between the surfaces
  bool coulomb = false;        ///< friction <= mu normal given the normal impulse, not MuJoCo's convex cone
  bool hard_friction = false;  ///< friction stops slip at once, not like a damper
  bool hard_normal = false;    ///< penetration stops at once and a fifth of it is undone, not like a spring
  bool speculative = false;    ///< points just above the ground count: they may close the gap and no more
  bool hard_joint_friction = false;  ///< dry friction stops a joint at once, not like a damper
  bool hard_joint_limits = false;    ///< limits stop a joint at once, not like a spring and damper

  // Beyond hard contact with Coulomb's disc, with all of the above: laws of their own.
  bool pyramid = false;  ///< friction is bounded along the slip and across it, each by itself
  bool stock = false;    ///< as DART ships: see hard_contact

  bool operator==(const LawFactors&) const = default;
};

/// Hard contact with Coulomb's disc, solved to convergence.
inline constexpr LawFactors kHardLaw{true, true, true, true, true, true, true};

/// Holds how hard contact undoes a penetration, and how its rows are softened.
struct HardContact {
  double error_reduction;  ///< share of a penetration that is undone in a step
  double most_push_out;    ///< speed at which it is undone at most, m/s
  double mixing;           ///< constraint force mixing, as a share of each row's own response
};
/// Returns what the world asks for (ContactSpec::erp, max_depenetration_velocity, cfm), or what DART ships
/// with (DART 6.12, dart/constraint/ContactConstraint.cpp: DART_ERP, DART_MAX_ERV, DART_CFM) where that is a
/// factor.
HardContact hard_contact(const ContactSpec& contact, const LawFactors& factors);
/// Says whether penetrations are undone as the world asks: Capabilities::error_reduction.
bool has_error_reduction(const LawFactors& factors);

/// Lists the rows in the order in which `needs` are satisfied.
const std::vector<FactorRow<LawFactors>>& law_factor_rows();

/// Names the law as in Laws::contact, the same for every engine: "mujoco" where all are off, "hard" where all
/// are on, else "mujoco+surface+coulomb"; "hard+pyramid", "dart" for stock. Dry friction and limits of joints
/// are not of it.
std::string law_name(const LawFactors& factors);
/// Tells whether contacts, dry friction and limits of joints are MuJoCo's minimum (PrimalProblem), of which
/// torsion and rolling are a part: Capabilities::turning_friction.
bool is_solved_by_minimum(const LawFactors& factors);
/// Returns Laws::contact_family: "rigid" where penetration stops at once.
std::string family_name(const LawFactors& factors);
/// Returns EngineInfo::own_parts of every engine that is made of the contact stage.
std::vector<std::string> own_parts();

}  // namespace crossgait::contact
