// The checks by topic, each in the file of its name, and what they share. Private to this folder.
#pragma once

#include <string>
#include <vector>

#include "conformance/check.h"
#include "scenes/scenes.h"

namespace crossgait::conformance {

std::vector<Check> model_checks();
std::vector<Check> free_motion_checks();
std::vector<Check> joint_checks();
std::vector<Check> ground_checks();
std::vector<Check> friction_checks();
std::vector<Check> contact_checks();
std::vector<Check> shape_checks();
std::vector<Check> loop_checks();
std::vector<Check> coupling_checks();
std::vector<Check> joint_friction_checks();
std::vector<Check> joint_limit_checks();
std::vector<Check> implicit_servo_checks();
std::vector<Check> determinism_checks();
std::vector<Check> parity_checks();

/// @throws std::runtime_error if the engine does not take the step
void advance(PhysicsBackend& world, const JointTargets& targets, int steps = 1);

/// Returns the targets of an arm whose one servo is to be at `angle`, rad.
inline JointTargets target(double angle) { return {JointVector::Constant(1, angle)}; }

/// Makes an arm of this one link on a fixed base, let go. @param gravity,angle,speed  m/s^2 in W, rad, rad/s
std::unique_ptr<PhysicsBackend> swinging_arm(const Subject& subject, const scenes::ArmLink& link,
                                             const Vector3& gravity, double angle, double speed = 0);

/// Demands that the engine has a law of this kind. @param law  its member's name
template <std::string Laws::*kLaw>
Precondition has_law(std::string_view law) {
  return {"Laws::" + std::string(law) + " is not empty",
          [](const Subject& subject) { return !(subject.engine.info.laws.*kLaw).empty(); }};
}

/// Describes a world of `robot` on a terrain of this name.
WorldSpec world_on(const char* terrain, const scenes::RobotPtr& robot);

/// Returns the largest difference from `expected`, each relative to its number.
double relative_difference(const JointVector& found, const JointVector& expected);

/// Returns the ratio of two errors, of a fine step over a coarse one, as near to what is `expected` of it as
/// the rounding of both, at most `rounding`, leaves open.
double convergence(double fine, double coarse, double expected, double rounding);

/// Returns the speed (rad/s) at which MuJoCo's friction gives way to `torque` (N m) in a joint of this link
/// alone: aref = -B v has to carry it through R = (1 - imp) / imp / inertia. Hard friction does not give way.
double soft_creep(const scenes::ArmLink& link, double torque);

/// Tells whether contact is soft by declaration.
bool is_soft(const Subject& subject);

/// Returns the largest loop gap of its poses by forward kinematics of the state, m.
double loop_gap(const PhysicsBackend& world);

}  // namespace crossgait::conformance
