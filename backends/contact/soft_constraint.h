// MuJoCo's soft-constraint law, as coefficients of velocity-level constraint rows.
#pragma once

#include "physics/robot/robot.h"

namespace crossgait::contact {

/// A soft row asks for  J v' + R lambda = J v - h (B J v + K imp r)  with impulse lambda, where r is the
/// violation. Source: MuJoCo 2.2 manual, "Computation > Constraint model"; coefficients of
/// engine_core_constraint.c (getimpedance, mj_makeImpedance).
class SoftLaw {
 public:
  /// @param step physics step h, s; MuJoCo keeps the time constant at two steps or more
  SoftLaw(const Softness& softness, double step);

  /// Returns imp in (0, 1) at violation |r|, m.
  double impedance(double violation) const noexcept;
  /// Returns R = (1 - imp) / imp * inverse_weight, 1/kg.
  static double regularization(double impedance, double inverse_weight) noexcept {
    return (1 - impedance) / impedance * inverse_weight;
  }
  /// Returns the right-hand side for a row moving at `speed` with violation `r` and impedance `imp`, m/s.
  double target_velocity(double speed, double imp, double r) const noexcept {
    return speed - step_ * (damping_ * speed + stiffness_ * imp * r);
  }

 private:
  double step_, stiffness_, damping_, min_, max_, width_, midpoint_, power_;
};

}  // namespace crossgait::contact
