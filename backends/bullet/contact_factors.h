// What contact, joint friction and joint limits of `bullet` are made of, piece by piece, so that a difference
// from MuJoCo can be traced to one.
#pragma once

#include "backends/contact/law_factors.h"

namespace crossgait::bullet {

/// Says for each piece whether it is MuJoCo's (false) or Bullet's (true). Everything else, the dynamics, the
/// joint stage and the terrain, is the same in all of them.
struct ContactFactors : contact::LawFactors {
  bool narrowphase = false;  ///< contact points from Bullet's collision detection, not `touch_sphere` alone
  bool sweeps = false;       ///< as many projected Gauss-Seidel sweeps as Bullet makes, not a converged solve

  /// Returns MuJoCo's contact law in Bullet's dynamics.
  static constexpr ContactFactors matched() { return {}; }
  /// Returns the law of Bullet as it ships.
  static constexpr ContactFactors native() {
    return {{true, true, true, true, true, true, true}, true, true};
  }

  bool operator==(const ContactFactors&) const = default;
};

/// Returns the factors from "bullet:matched" to "bullet".
const contact::FactorTable<ContactFactors>& factor_table();

}  // namespace crossgait::bullet
