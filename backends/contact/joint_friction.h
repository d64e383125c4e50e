// Dry friction in joints: rows of one joint's velocity with a bounded impulse, solved along with the
// contacts.
#pragma once

#include <vector>

#include "physics/engine/soft_law.h"
#include "physics/engine/world_spec.h"

namespace crossgait::contact {

/// Describes a joint with dry friction.
struct FrictionalJoint {
  int joint = -1;             ///< as in RobotDescription::joint
  double friction = 0;        ///< N m
  double inverse_weight = 0;  ///< MuJoCo's, 1/(kg m^2)
};
std::vector<FrictionalJoint> frictional_joints(const WorldSpec& spec);

/// MuJoCo's friction gives way like a damper until it reaches the bound (MuJoCo 2.2 manual, "Computation >
/// Constraint model > Friction loss"); that of hard engines stops the joint at once.
struct FrictionRow {
  double R = 0;       ///< regularisation, 1/(kg m^2)
  double target = 0;  ///< velocity that the row asks for, rad/s
};
/// @param speed  of the joint before the step, rad/s
FrictionRow friction_row(const FrictionalJoint& joint, const SoftLaw& law, bool hard, double speed) noexcept;

}  // namespace crossgait::contact
