// What PhysX is asked to do beside a world's description, and the names of it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "backends/contact/factor_table.h"

namespace crossgait::physx {

/// Holds the pieces between hard contact as engines share it in PhysX's dynamics ("physx:hard": all false)
/// and PhysX as it ships (all true), and numbers of PhysX's solver and contacts. Their defaults are PhysX's
/// own (PxSceneDesc, PxRigidBody, PxShape), at its own scale of a metre.
struct Settings {
  std::string name;
  bool margin = true;  ///< points count from `contact_offset` on, not from a share of how far a body reaches
  bool push_out = true;  ///< penetration is undone by kPushOut of it in a step, without a bound of speed
  bool solver = true;    ///< PhysX's own rows, solver and integration; else those that engines share
  bool loops = true;     ///< loops are hard, not soft by MuJoCo's law
  bool sweeps = true;    ///< as many iterations as below, not kMostIterations
  bool temporal = true;  ///< PxSolverType::eTGS; else ePGS
  int position_iterations = 4, velocity_iterations = 1;
  double contact_offset = 0.02;  ///< how far above the ground contacts are generated, m
  double depenetration = 1e9;    ///< speed at which penetration is undone at most, m/s: no bound
};

/// Share of a penetration that PhysX's projected solver undoes in a step.
inline constexpr double kPushOut = 0.8;
/// PhysX takes no more iterations.
inline constexpr int kMostIterations = 255;

/// Returns the factors from "physx:hard" to "physx".
const contact::FactorTable<Settings>& factor_table();

/// Reads a name: an end with changes behind it, "physx:pgs" for "physx-temporal", or what robots were trained
/// under, "physx+isaacgym" (legged_gym's LeggedRobotCfg.sim.physx) and "physx+isaaclab" (Isaac Lab's
/// configurations of quadrupeds). Nothing for names of others.
/// @throws ConfigError if a change is invalid
std::optional<Settings> find_settings(std::string_view name);

}  // namespace crossgait::physx
