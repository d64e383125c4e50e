// The path of one foot: a swing curve from lift-off to touchdown, and a straight stance back.
//
// Along the step vector s the foot goes from -s/2 to +s/2 in swing and back at constant speed in stance; its
// height is lift - body_height. Everything is continuous in phase, duty factor and parameters.
#pragma once

#include "gait/gait.h"
#include "gait/parameters.h"
#include "physics/core/math.h"

namespace crossgait {

using Vector2 = Eigen::Vector2d;

/// Describes a point of a foot's path in units of the stride.
struct StridePoint {
  double along = 0;  ///< in half step vectors: -1 at lift-off, +1 at touchdown
  double lift = 0;   ///< in units of `swing_lift`
};

/// Returns the guide's swing at progress u: a cubic Bezier with control points along (-1, -shape, shape, 1)
/// and lift (0, 1, 1, 0), shape clamped to [0.05, 0.95]. Its apex is at lift 3/4.
StridePoint bezier_swing(double u, double shape) noexcept;

/// Returns a swing whose velocity at both ends is that of the stance, and whose apex is at lift 1: along = a
/// v + b v^3 with v = 2u - 1, lift = (4 u (1 - u))^2.
StridePoint matched_swing(double u, double duty) noexcept;

/// Returns the highest lift asked of a swing, m: step_height + foot_clearance, at most body_height - 1e-4.
double swing_lift(const GaitParameters& parameters) noexcept;

/// Returns the outward shift of a standing foot from its leg's plane, m: stance_width / 2 + lateral offset.
double outward_shift(const GaitParameters& parameters, Leg leg) noexcept;

/// Holds what places one foot besides the parameters.
struct FootStride {
  Vector2 step = Vector2::Zero();          ///< step vector, x forward, y left, m
  double lift_scale = 1;                   ///< 0 standing to 1 full stride
  SwingCurve curve = SwingCurve::kBezier;  ///< in place of GaitParameters::swing
};

/// Places a foot's centre in the leg frame (x forward, y left, z up: standing, it is at z = -body_height), m.
Vector3 foot_position(const GaitParameters& parameters, Leg leg, const LegPhase& phase,
                      const FootStride& stride) noexcept;

/// Returns a body's speed with one `step_length` per stance: step_length / (duty_factor cycle_time), m/s.
inline double nominal_speed(const GaitParameters& parameters) noexcept {
  return parameters.step_length / (parameters.duty_factor * parameters.cycle_time);
}

/// Holds lateral distances between the centres of left and right feet, m.
struct FootSpacing {
  double front = 0, rear = 0;
};

/// Returns the spacing, not to be mistaken for stance_width: the leg planes are apart too.
/// @param p_BL  origins of the leg frames in the base frame, m
FootSpacing foot_spacing(const GaitParameters& parameters, const LegArray<Vector3>& p_BL) noexcept;

}  // namespace crossgait
