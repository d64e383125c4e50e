// What a walk looked like over time, and its CSV file.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "motion/controller.h"
#include "physics/core/atomic_file.h"
#include "physics/engine/physics_backend.h"

namespace crossgait {

/// One control step.
struct TraceSample {
  RobotState state;
  JointTargets targets;
  LegArray<bool> contact{};
  LegArray<double> load{};  ///< magnitude of the force on each foot, N
  /// On each foot, in W, N.
  LegArray<Vector3> force{{Vector3::Zero(), Vector3::Zero(), Vector3::Zero(), Vector3::Zero()}};
  JointVector torques;  ///< of the last physics step, N m; empty in samples that no world made

  std::optional<LegArray<ScheduledLeg>>
      contact_schedule;                      ///< what the legs were meant to do, where that is known
  std::optional<GaitParameters> parameters;  ///< of the gait, where there is one

  TraceSample() = default;
  /// Now, after a control step towards `control`.
  TraceSample(const PhysicsBackend& world, const ControlTargets& control);
};

using Trace = std::vector<TraceSample>;

/// What a trace holds as a table: columns time, p_WB.{x,y,z}, q_WB.{w,x,y,z}, v_WB.{x,y,z}, w_WB.{x,y,z},
/// q.JOINT..., target.JOINT..., contact.LEG, load.LEG, and where its first sample knows them planned.LEG (1:
/// meant to stand) and param.NAME. SI units.
class TraceColumns {
 public:
  TraceColumns(const RobotDescription& robot, const TraceSample& first);

  const std::vector<std::string>& names() const { return names_; }
  /// Appends a sample's numbers, one per name.
  void append(const TraceSample& sample, std::vector<double>& numbers) const;

 private:
  bool planned_, parameters_;
  std::vector<std::string> names_;
};

/// Writes a trace as it comes, sample by sample, with 17 significant digits, so that reading it back loses
/// nothing. The file appears whole with `finish`, or not at all.
class TraceWriter {
 public:
  /// @throws ConfigError if the file cannot be written; so do the others
  TraceWriter(std::shared_ptr<const RobotDescription> robot, const std::string& path);
  void add(const TraceSample& sample);
  void finish();

 private:
  void begin(const TraceSample& first);

  std::shared_ptr<const RobotDescription> robot_;
  AtomicFile file_;
  std::optional<TraceColumns> columns_;  // once there is a sample
  std::vector<double> numbers_;
  std::string row_;
};

}  // namespace crossgait
