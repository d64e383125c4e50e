// What a walk looked like over time, and its CSV file.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "crossgait/env/target_source.h"
#include "crossgait/physics/atomic_file.h"
#include "crossgait/physics/physics_backend.h"

namespace crossgait {

/// One control step.
struct TraceSample {
  RobotState state;
  JointTargets targets;
  LegArray<bool> contact{};
  LegArray<double> load{};  ///< magnitude of the force on each foot, N
  JointVector torques;      ///< of the last physics step, N m; empty where the recorder did not ask for them

  std::optional<LegArray<LegPlan>> plan;     ///< what the legs were meant to do, where that is known
  std::optional<GaitParameters> parameters;  ///< of the gait, where there is one

  TraceSample() = default;
  /// Now, after a control step towards `control`.
  TraceSample(const PhysicsBackend& world, const ControlTargets& control);
};

using Trace = std::vector<TraceSample>;

/// Writes a trace as it comes, sample by sample: columns time, p_WB.{x,y,z}, q_WB.{w,x,y,z}, v_WB.{x,y,z},
/// w_WB.{x,y,z}, q.<joint>..., target.<joint>..., contact.<leg>, load.<leg>, and where the first sample knows
/// them planned.<leg> (1: meant to stand) and param.<name>. SI units, 17 significant digits, so that reading
/// it back loses nothing. The file appears whole with `finish`, or not at all.
class TraceWriter {
 public:
  /// @throws ConfigError if the file cannot be written; so do the others
  TraceWriter(std::shared_ptr<const RobotDescription> robot, const std::string& path);
  void add(const TraceSample& sample);
  void finish();

 private:
  void begin(bool planned, bool parameters);

  std::shared_ptr<const RobotDescription> robot_;
  AtomicFile file_;
  std::string row_;
  bool begun_ = false, planned_ = false, parameters_ = false;
};

}  // namespace crossgait
