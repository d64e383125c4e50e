// What contact and joint friction of `bullet` are made of, piece by piece, so that a difference from MuJoCo
// can be traced to one.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "crossgait/physics/engine.h"

namespace crossgait::bullet {

/// Each piece is either MuJoCo's (false) or Bullet's (true). Everything else, the dynamics, the joint stage
/// and the terrain, is the same in all of them.
struct ContactFactors {
  bool narrowphase = false;    ///< contact points from Bullet's collision detection, not `touch_sphere` alone
  bool surface = false;        ///< forces act on the robot's surface, not midway between the surfaces
  bool coulomb = false;        ///< friction <= mu normal given the normal impulse, not MuJoCo's convex cone
  bool hard_friction = false;  ///< friction stops slip at once, not like a damper
  bool hard_normal = false;    ///< penetration stops at once and a fifth of it is undone, not like a spring
  bool speculative = false;    ///< points just above the ground count: they may close the gap and no more
  bool hard_joint_friction = false;  ///< dry friction stops a joint at once, not like a damper
  bool sweeps = false;  ///< Bullet's own rows and projected Gauss-Seidel sweeps, not a converged solve

  /// MuJoCo's contact law in Bullet's dynamics.
  static constexpr ContactFactors matched() { return {}; }
  /// Bullet as it ships.
  static constexpr ContactFactors native() { return {true, true, true, true, true, true, true, true}; }

  bool operator==(const ContactFactors&) const = default;
};

/// One row of the table, in the order in which `needs` are satisfied.
struct FactorRow {
  ModelFactor factor;
  bool ContactFactors::*member;
};
const std::vector<FactorRow>& factor_rows();

/// `base` with changes `+NAME` (Bullet's) and `-NAME` (MuJoCo's), one after the other.
/// @throws ConfigError for an unknown factor, a change that changes nothing, or a combination without
/// meaning; messages name `backend`
ContactFactors changed(ContactFactors base, std::string_view changes, std::string_view backend);

/// The shortest name: "bullet", "bullet:matched", "bullet:matched+surface", "bullet-sweeps".
std::string name_of(const ContactFactors& factors);

}  // namespace crossgait::bullet
