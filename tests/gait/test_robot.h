// Leg frames of scara_quadruped by hand, for tests that need no kinematics, and measures of foot paths.
#pragma once

#include "gait/gait_generator.h"

namespace crossgait::test {

inline constexpr double kDt = 0.002;  ///< control step, s

/// Returns origins of the leg frames in the base frame, m.
inline LegArray<Vector3> leg_origins() {
  LegArray<Vector3> p_BL;
  for (const Leg leg : kLegs) p_BL[leg] = {is_front(leg) ? 0.075 : -0.075, side_sign(leg) * 0.062, 0.0025};
  return p_BL;
}

/// Finds the top speed of any foot over a cycle of the stride, m/s: central differences at 400 phases.
inline double top_foot_speed(const GaitParameters& parameters, const LegArray<Vector2>& step,
                             SwingCurve curve) {
  constexpr int kSamples = 400;
  constexpr double kStep = 1e-6;
  double top = 0;
  for (const Leg leg : kLegs) {
    const FootStride stride{step[leg], 1, curve};
    for (int i = 0; i < kSamples; ++i) {
      const double phase = (i + 0.5) / kSamples;  // never on a corner between swing and stance
      const auto at = [&](double clock) {
        return foot_position(parameters, leg, leg_phase(clock, 0, parameters.duty_factor), stride);
      };
      const Vector3 ahead = at(phase + kStep), behind = at(phase - kStep);
      top = std::max(top, (ahead - behind).norm() / (2 * kStep * parameters.cycle_time));
    }
  }
  return top;
}

}  // namespace crossgait::test
