// Single experiments on a world through its public interface. Private to the model audit.
#pragma once

#include <optional>
#include <vector>

#include "physics/engine/physics_backend.h"

namespace crossgait::probes {

/// Measures the simulated time that one step takes, s.
double time_of_a_step(PhysicsBackend& world);

/// Finds the poses of all bodies in their parents' with one joint turned by 0.5 rad and all others at zero.
/// @param turned joint, or -1 for none
std::vector<Pose> poses_with_turned(PhysicsBackend& world, int turned);

/// Measures the diagonal of the mass matrix at home, joints alone, kg m^2.
Eigen::VectorXd joint_inertias(PhysicsBackend& world);

/// Measures the acceleration of the resting robot let go far above the ground, m/s^2.
Vector3 free_fall(PhysicsBackend& world);

struct ServoResponse {
  double joint_damping = 0, stiffness = 0, effort_limit = 0, servo_damping = 0;
};
/// Measures a servo by torques of single steps. A servo is told apart from its joint's damping by driving it
/// into its effort limit, where its own damping has no say. Zeros for what a passive joint has not.
ServoResponse servo_response(PhysicsBackend& world, int joint);

struct PressedFoot {
  double depth = 0;           ///< of the foot in the ground, m; 0 if it does not touch
  double normal_force = 0;    ///< N
  double friction_ratio = 0;  ///< tangential over normal force
  double slip_after =
      0;  ///< smallest speed along the ground of its points after the step, m/s: 0 where it sticks
};
/// Returns the robot at home, its feet up to 1 mm deep in the ground, or 1 um where the engine declares
/// nothing by which it would undo less than all of that in a step; sliding forward. @param speed m/s
RobotState pressed(const PhysicsBackend& world, double speed);
/// Takes one step from a pressed state. Both worlds are to start from the state of one.
LegArray<PressedFoot> press_feet(PhysicsBackend& world, const RobotState& pressed);

/// Returns the robot at home, turned to `attitude` over the origin, with the lowest contact feature of `body`
/// (contact_features.h) 1 mm deep in the ground, wherever the other bodies are. @returns empty if the body
/// has no shapes
std::optional<RobotState> body_pressed(const PhysicsBackend& world, int body, const Quaternion& attitude);

struct PressedBody {
  double depth = 0;  ///< of its deepest contact, m; 0 if it does not touch
  int points = 0;    ///< where it touches
};
/// Steps from a pressed state. @returns empty if the engine cannot take it: bodies that were deeper fly apart
std::optional<PressedBody> press_body(PhysicsBackend& world, const RobotState& pressed, int body);

/// Returns a robot high in the air with every joint turning and the loops a little open.
RobotState swinging(const PhysicsBackend& world);
/// Measures velocities after one step from there with the servos holding `state`'s angles: [v_WB, w_WB, qd].
Eigen::VectorXd swing(PhysicsBackend& world, const RobotState& state);

}  // namespace crossgait::probes
