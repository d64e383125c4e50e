// MuJoCo's soft-constraint law, as coefficients of velocity-level constraint rows.
#pragma once

#include <algorithm>
#include <cmath>

#include "physics/robot/robot.h"

namespace crossgait {

/// A soft row asks for  J v' + R lambda = J v - h (B J v + K imp r)  with impulse lambda, where r is the
/// violation. Source: MuJoCo 2.2 manual, "Computation > Constraint model"; coefficients of
/// engine_core_constraint.c (getimpedance, mj_makeImpedance). Rows are made in every step, so that all of it
/// is here for the compiler to see.
class SoftLaw {
 public:
  /// @param step physics step h, s; MuJoCo keeps the time constant at two steps or more
  SoftLaw(const Softness& softness, double step)
      : step_(step),
        min_(std::clamp(softness.impedance_min, kMinImpedance, kMaxImpedance)),
        max_(std::clamp(softness.impedance_max, kMinImpedance, kMaxImpedance)),
        width_(softness.impedance_width),
        midpoint_(std::clamp(softness.impedance_midpoint, kMinImpedance, kMaxImpedance)),
        power_(softness.impedance_power) {
    const double time_constant = time_constant_in_steps(softness.time_constant, step);
    stiffness_ =
        1 / (max_ * max_ * time_constant * time_constant * softness.damping_ratio * softness.damping_ratio);
    damping_ = 2 / (max_ * time_constant);
  }

  /// Returns imp in (0, 1) at violation |r|, m.
  double impedance(double violation) const noexcept {
    const double x = std::min(std::abs(violation) / width_, 1.0);
    const bool usual = midpoint_ == 0.5 && power_ == 2;
    const double below = usual ? 2 * x * x : std::pow(x, power_) / std::pow(midpoint_, power_ - 1);
    if (x <= midpoint_) return min_ + below * (max_ - min_);
    const double above =
        usual ? 2 * (1 - x) * (1 - x) : std::pow(1 - x, power_) / std::pow(1 - midpoint_, power_ - 1);
    return min_ + (1 - above) * (max_ - min_);
  }
  /// Returns R = (1 - imp) / imp * inverse_weight, 1/kg.
  static double regularization(double impedance, double inverse_weight) noexcept {
    return (1 - impedance) / impedance * inverse_weight;
  }
  /// Returns the right-hand side for a row moving at `speed` with violation `r` and impedance `imp`, m/s.
  double target_velocity(double speed, double imp, double r) const noexcept {
    return speed - step_ * (damping_ * speed + stiffness_ * imp * r);
  }
  /// Returns those of several rows of one impedance.
  template <typename Rows>
  typename Rows::PlainObject target_velocity(const Eigen::MatrixBase<Rows>& speed, double imp,
                                             const Eigen::MatrixBase<Rows>& r) const {
    return speed - step_ * (damping_ * speed + stiffness_ * imp * r);
  }

 private:
  // mjMINIMP and mjMAXIMP of mjmodel.h.
  static constexpr double kMinImpedance = 1e-4, kMaxImpedance = 0.9999;

  double step_, stiffness_, damping_, min_, max_, width_, midpoint_, power_;
};

}  // namespace crossgait
