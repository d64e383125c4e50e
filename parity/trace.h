// What a walk looked like over time, and its CSV file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "crossgait/env/target_source.h"
#include "crossgait/physics/physics_backend.h"

namespace crossgait {

/// One control step.
struct TraceSample {
  RobotState state;
  JointTargets targets;
  LegArray<bool> contact{};
  LegArray<double> load{};  ///< magnitude of the force on each foot, N
  JointVector torques;      ///< of the last physics step, N m; empty where the recorder did not ask for them

  std::optional<GaitParameters> parameters;  ///< of the gait, where there is one

  TraceSample() = default;
  /// Now, after a control step towards `control`.
  TraceSample(const PhysicsBackend& world, const ControlTargets& control);
};

using Trace = std::vector<TraceSample>;

/// Writes columns time, p_WB.{x,y,z}, q_WB.{w,x,y,z}, v_WB.{x,y,z}, w_WB.{x,y,z}, q.<joint>...,
/// target.<joint>..., contact.<leg>, load.<leg>: SI units, 17 significant digits, so that reading it back
/// loses nothing. The file appears whole or not at all. @throws ConfigError if it cannot be written
void write_trace_csv(const RobotDescription& robot, const Trace& trace, const std::string& path);

}  // namespace crossgait
