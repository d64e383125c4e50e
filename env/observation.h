// What a policy sees: blocks of named numbers, chosen by name.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "env/joint_settings.h"
#include "env/observation_settings.h"
#include "env/observation_term.h"
#include "gait/adaptive_gait_controller.h"
#include "motion/foot_states.h"
#include "physics/engine/physics_backend.h"
#include "policy/layout.h"

namespace crossgait {

/// Holds what there is to see at one instant. References are valid during the call alone.
struct ObservationSource {
  const PhysicsBackend& world;
  const FootStates& feet;
  const LegArray<FootContact>& contacts;
  const AdaptiveGaitController* gait;  ///< null where actions command joints
  const VelocityCommand& command;
  std::span<const int> joints;          ///< indices of those that are seen, in their order
  std::span<const double> home;         ///< their home angles, rad
  std::span<const double> last_action;  ///< clipped, as it was applied
  const JointTargets& targets;          ///< of the last control step
  std::span<const Eigen::Index> slots;  ///< of `joints` in targets
  const ObservationSettings& settings;
  double time = 0;  ///< since the episode began, s
};

/// Holds what the layout of a block depends on.
struct ObservationContext {
  std::vector<std::string> joints;           ///< names of those that are seen, in their order
  std::span<const double> home;              ///< their home angles, rad
  std::span<const ParameterRow> parameters;  ///< that adapt
  Layout action;
  GaitParameters initial = {};  ///< at the start of an episode
  ObservationSettings settings = {};
};

/// A row of the table describes a block.
struct ObservationBlock {
  std::string_view name, help;
  bool standard;  ///< part of the default observation of gaits
  void (*describe)(const ObservationContext& context, Layout& layout);
  /// Writes as many numbers as `describe` adds entries, all finite.
  void (*write)(const ObservationSource& source, double*& out);
  bool needs_gait = false;  ///< there is nothing to see of it where actions command joints
};

/// Returns the table. The standard blocks come first, in the order of the default observation: 65 numbers and
/// one per adapted parameter.
std::span<const ObservationBlock> observation_blocks();
/// @throws ConfigError listing the known names
const ObservationBlock& find_observation_block(std::string_view name);
/// Returns the standard blocks.
std::vector<ObservationTerm> standard_observation();
/// Returns what joint policies are commonly trained on: linear and angular velocity of the base in its own
/// frame, direction of gravity there, joint angles from home, joint velocities, last action, command.
std::vector<ObservationTerm> joint_policy_observation();

/// Lays out deltas of the adapted parameters ("delta.step_height", ...), then residuals ("residual.FL.x",
/// ...), all in [-1, 1]. Where a parameter's delta scale or range is not the table's, the units of its
/// entries say so: the numbers mean something else, and so the layout's hash is another.
Layout action_layout(std::span<const ParameterRow> parameters);
/// Lays out targets of the servos ("target.FL_hip_joint", ...), within +-limit. Scale and home are in the
/// units, and so in the layout's hash: "0.5 rad from 0.9".
Layout joint_action_layout(std::span<const std::string> servos, const JointActionTable& joints, double limit);

/// Radius of the ring of terrain heights about the base of a robot of the reference's size, m (gait/scale.h).
inline constexpr double kTerrainRingRadius = 0.15;

}  // namespace crossgait
