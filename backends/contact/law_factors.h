// What a law of contact and joint friction is made of, piece by piece, so that a difference between two can
// be traced to one.
#pragma once

#include <string>
#include <vector>

#include "crossgait/backends/contact/factor_table.h"

namespace crossgait::contact {

/// Each piece is either MuJoCo's (false) or that of an engine with hard contact (true).
struct LawFactors {
  bool surface = false;        ///< forces act on the robot's surface, not midway between the surfaces
  bool coulomb = false;        ///< friction <= mu normal given the normal impulse, not MuJoCo's convex cone
  bool hard_friction = false;  ///< friction stops slip at once, not like a damper
  bool hard_normal = false;    ///< penetration stops at once and a fifth of it is undone, not like a spring
  bool speculative = false;    ///< points just above the ground count: they may close the gap and no more
  bool hard_joint_friction = false;  ///< dry friction stops a joint at once, not like a damper

  bool operator==(const LawFactors&) const = default;
};

/// In the order in which `needs` are satisfied.
const std::vector<FactorRow<LawFactors>>& law_factor_rows();

/// As in Laws::contact, the same for every engine: "mujoco" where all are off, "hard" where all are on, else
/// "mujoco+surface+coulomb". Dry friction of joints is not of it.
std::string law_name(const LawFactors& factors);

}  // namespace crossgait::contact
