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
std::vector<Check> joint_friction_checks();
std::vector<Check> determinism_checks();
std::vector<Check> parity_checks();

/// @throws std::runtime_error if the engine does not take the step
void advance(PhysicsBackend& world, const JointTargets& targets, int steps = 1);

/// A world of `robot` on a terrain of this name.
WorldSpec world_on(const char* terrain, const scenes::RobotPtr& robot);

/// Whether contact is soft by declaration.
bool is_soft(const Subject& subject);

/// Returns the largest loop gap of its poses by forward kinematics of the state, m.
double loop_gap(const PhysicsBackend& world);

}  // namespace crossgait::conformance
