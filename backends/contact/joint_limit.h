// Limits of joints: rows of one joint's velocity whose impulse only pushes, solved along with the contacts.
#pragma once

#include <optional>
#include <vector>

#include "physics/engine/soft_law.h"
#include "physics/engine/world_spec.h"

namespace crossgait::contact {

/// Describes a joint that is limited.
struct LimitedJoint {
  int joint = -1;             ///< as in RobotDescription::joint
  double lower, upper;        ///< rad
  double inverse_weight = 0;  ///< MuJoCo's, 1/(kg m^2)
  SoftLaw law;
};
std::vector<LimitedJoint> limited_joints(const WorldSpec& spec);

/// Hard limits undo this share of a violation in a step (Bullet's default, btContactSolverInfo::m_erp2), at
/// this speed at most, rad/s: a robot that begins 0.1 rad beyond a limit is not thrown about.
inline constexpr double kLimitReduction = 0.2, kFastestReturn = 1;

/// Says what a limit asks of the speed at which a joint goes away from it.
struct LimitRow {
  double away = 1;    ///< 1: of the lower limit, so that the angle rises; -1: of the upper one
  double R = 0;       ///< regularisation, 1/(kg m^2)
  double target = 0;  ///< speed away from the limit that the row asks for at least, rad/s
};
/// Returns the row of the limit that is nearer, if it counts. MuJoCo's does from the limit on, and gives way
/// like a spring and damper (MuJoCo 2.2 manual, "Computation > Constraint model > Limit"); a hard one lets
/// the angle get as far as the limit within the step and no further, and undoes what is beyond it.
/// @param angle,speed  of the joint before the step, rad and rad/s
/// @param next_speed   the speed that it would have after the step, rad/s: limits out of reach do not count
std::optional<LimitRow> limit_row(const LimitedJoint& joint, bool hard, double angle, double speed,
                                  double next_speed, double step) noexcept;

}  // namespace crossgait::contact
