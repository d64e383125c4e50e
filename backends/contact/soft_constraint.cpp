#include "backends/contact/soft_constraint.h"

#include <algorithm>
#include <cmath>

namespace crossgait::contact {
namespace {

// mjMINIMP and mjMAXIMP of mjmodel.h.
constexpr double kMinImpedance = 1e-4;
constexpr double kMaxImpedance = 0.9999;

}  // namespace

SoftLaw::SoftLaw(const Softness& softness, double step)
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

double SoftLaw::impedance(double violation) const noexcept {
  const double x = std::min(std::abs(violation) / width_, 1.0);
  const bool usual = midpoint_ == 0.5 && power_ == 2;
  const double below = usual ? 2 * x * x : std::pow(x, power_) / std::pow(midpoint_, power_ - 1);
  if (x <= midpoint_) return min_ + below * (max_ - min_);
  const double above =
      usual ? 2 * (1 - x) * (1 - x) : std::pow(1 - x, power_) / std::pow(1 - midpoint_, power_ - 1);
  return min_ + (1 - above) * (max_ - min_);
}

}  // namespace crossgait::contact
