#include "gait/foot_trajectory.h"

#include <algorithm>
#include <array>

namespace crossgait {

StridePoint bezier_swing(double u, double shape) noexcept {
  constexpr double kLeast = 0.05, kMost = 0.95;
  const double k = std::clamp(shape, kLeast, kMost);
  // The Bezier polynomials, factored with q = u (1 - u).
  const double q = u * (1 - u);
  return {(2 * u - 1) * (1 + (3 * k - 1) * q), 3 * q};
}

StridePoint matched_swing(double u, double duty) noexcept {
  // a + b = 1 ends at +1; a + 3 b = -(1 - duty) / duty is the stance's speed, in half steps per half swing.
  const double w = (1 - duty) / duty, b = -(1 + w) / 2, a = 1 - b;
  const double v = 2 * u - 1, hump = 4 * u * (1 - u);
  return {v * (a + b * v * v), hump * hump};
}

double swing_lift(const GaitParameters& p) noexcept {
  constexpr double kLeastDepth = 1e-4;
  return std::min(p.step_height + p.foot_clearance, p.body_height - kLeastDepth);
}

double outward_shift(const GaitParameters& p, Leg leg) noexcept {
  constexpr std::array kOffsets{&GaitParameters::lateral_offset_fl, &GaitParameters::lateral_offset_fr,
                                &GaitParameters::lateral_offset_rl, &GaitParameters::lateral_offset_rr};
  return p.stance_width / 2 + p.*kOffsets[index(leg)];
}

Vector3 foot_position(const GaitParameters& p, Leg leg, const LegPhase& phase,
                      const FootStride& stride) noexcept {
  StridePoint point{1 - 2 * phase.progress, 0};
  if (phase.swing) {
    point = stride.curve == SwingCurve::kBezier ? bezier_swing(phase.progress, p.swing_shape)
                                                : matched_swing(phase.progress, p.duty_factor);
  }
  const double half = point.along / 2, lift = point.lift * stride.lift_scale;
  return {p.stance_offset + half * stride.step.x(),
          half * stride.step.y() + side_sign(leg) * outward_shift(p, leg),
          lift * swing_lift(p) - p.body_height};
}

FootSpacing foot_spacing(const GaitParameters& p, const LegArray<Vector3>& p_BL) noexcept {
  const auto between = [&](Leg left, Leg right) {
    return p_BL[left].y() + outward_shift(p, left) - (p_BL[right].y() - outward_shift(p, right));
  };
  return {between(Leg::FL, Leg::FR), between(Leg::RL, Leg::RR)};
}

}  // namespace crossgait
