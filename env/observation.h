// What a policy sees: blocks of named numbers, chosen by name.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "crossgait/env/foot_states.h"
#include "crossgait/env/layout.h"
#include "crossgait/gait/adaptive_gait_controller.h"
#include "crossgait/physics/physics_backend.h"

namespace crossgait {

/// What there is to see at one instant. References are valid during the call alone.
struct ObservationSource {
  const PhysicsBackend& backend;
  const FootStates& feet;
  const LegArray<FootContact>& contacts;
  const AdaptiveGaitController& controller;
  const VelocityCommand& command;
  std::span<const int> servos;          ///< indices of the actuated joints
  std::span<const double> last_action;  ///< clipped, as it was applied
};

/// What the layout of a block depends on.
struct ObservationContext {
  std::vector<std::string> actuated_joints;  ///< names
  std::span<const ParameterRow> parameters;  ///< that adapt
  Layout action;
  GaitParameters initial = {};  ///< at the start of an episode
};

/// One row of the table of blocks.
struct ObservationBlock {
  std::string_view name, help;
  bool standard;  ///< part of the default observation
  void (*describe)(const ObservationContext& context, Layout& layout);
  /// Writes as many numbers as `describe` adds entries, all finite.
  void (*write)(const ObservationSource& source, double*& out);
};

/// The table. The standard blocks come first, in the order of the default observation: 65 numbers and one per
/// adapted parameter.
std::span<const ObservationBlock> observation_blocks();
/// @throws ConfigError listing the known names
const ObservationBlock& find_observation_block(std::string_view name);
/// Names of the standard blocks.
std::vector<std::string> standard_observation();

/// What the names of an action's entries begin with.
inline constexpr std::string_view kDeltaPrefix = "delta.", kResidualPrefix = "residual.";

/// Deltas of the adapted parameters ("delta.step_height", ...), then residuals ("residual.FL.x", ...), all in
/// [-1, 1]. Where a parameter's delta scale or range is not the table's, the units of its entries say so: the
/// numbers mean something else, and so the layout's hash is another.
Layout action_layout(std::span<const ParameterRow> parameters);

/// Radius of the ring of terrain heights about the base of a robot of the reference's size, m (gait/scale.h).
inline constexpr double kTerrainRingRadius = 0.15;

}  // namespace crossgait
