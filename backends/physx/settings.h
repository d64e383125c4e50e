// What PhysX is asked to do beside a world's description, and the names of it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "backends/contact/factor_table.h"

namespace crossgait::physx {

/// Holds numbers of PhysX's solver and contacts. The defaults are PhysX's own (PxSceneDesc, PxRigidBody,
/// PxShape), at its own scale of a metre.
struct Settings {
  std::string name;
  bool temporal = true;  ///< PxSolverType::eTGS; else ePGS
  int position_iterations = 4, velocity_iterations = 1;
  double contact_offset = 0.02;  ///< how far above the ground contacts are generated, m
  double depenetration = 1e9;    ///< speed at which penetration is undone at most, m/s: no bound
};

/// Returns the factors from "physx:pgs" to "physx".
const contact::FactorTable<Settings>& factor_table();

/// Reads a name: an end with changes behind it, or what robots were trained under, "physx+isaacgym"
/// (legged_gym's LeggedRobotCfg.sim.physx) and "physx+isaaclab" (Isaac Lab's configurations of quadrupeds).
/// Nothing for names of others.
/// @throws ConfigError if a change is invalid
std::optional<Settings> find_settings(std::string_view name);

}  // namespace crossgait::physx
