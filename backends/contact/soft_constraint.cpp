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
      width_(softness.impedance_width) {
  const double time_constant = std::max(softness.time_constant, 2 * step);
  stiffness_ =
      1 / (max_ * max_ * time_constant * time_constant * softness.damping_ratio * softness.damping_ratio);
  damping_ = 2 / (max_ * time_constant);
}

double SoftLaw::impedance(double violation) const noexcept {
  const double x = std::min(std::abs(violation) / width_, 1.0);
  const double y = x <= 0.5 ? 2 * x * x : 1 - 2 * (1 - x) * (1 - x);
  return min_ + y * (max_ - min_);
}

}  // namespace crossgait::contact
