// What a walk looked like over time, what takes its steps as they come, and its CSV file.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "motion/controller.h"
#include "physics/core/atomic_file.h"
#include "physics/engine/physics_backend.h"

namespace crossgait {

/// Holds what one control step did.
struct TraceSample {
  RobotState state;
  JointTargets targets;
  LegArray<bool> contact{};
  LegArray<double> load{};  ///< magnitude of the force on each foot, N
  /// Force on each foot, in W, N.
  LegArray<Vector3> force{{Vector3::Zero(), Vector3::Zero(), Vector3::Zero(), Vector3::Zero()}};
  /// Deepest contact point of each foot, in W, m; zero of one that does not touch.
  LegArray<Vector3> p_WP{{Vector3::Zero(), Vector3::Zero(), Vector3::Zero(), Vector3::Zero()}};
  JointVector torques;  ///< of the last physics step, N m; empty in samples that no world made

  std::optional<LegArray<ScheduledLeg>>
      contact_schedule;                      ///< what the legs were meant to do, where that is known
  std::optional<GaitParameters> parameters;  ///< of the gait, where there is one

  TraceSample() = default;
  /// Takes the state now, after a control step towards `control`.
  TraceSample(const PhysicsBackend& world, const ControlTargets& control);
};

using Trace = std::vector<TraceSample>;

/// Names a trace's columns: time, p_WB.{x,y,z}, q_WB.{w,x,y,z}, v_WB.{x,y,z}, w_WB.{x,y,z}, q.JOINT,
/// qd.JOINT, target.JOINT, contact.LEG, load.LEG, force.LEG.{x,y,z}, p_WP.LEG.{x,y,z}, and where its first
/// sample knows them torque.JOINT, planned.LEG (1: meant to stand) and param.NAME. SI units.
class TraceColumns {
 public:
  TraceColumns(const RobotDescription& robot, const TraceSample& first);

  const std::vector<std::string>& names() const { return names_; }
  /// Appends a sample's numbers, one per name.
  void append(const TraceSample& sample, std::vector<double>& numbers) const;

 private:
  bool torques_, planned_, parameters_;
  std::vector<std::string> names_;
};

/// Takes the control steps of one run as they come. Whoever makes a run makes the samples.
class TraceSink {
 public:
  virtual ~TraceSink() = default;
  /// @throws ConfigError where it cannot keep one more
  virtual void add(const TraceSample& sample) = 0;

 protected:
  TraceSink() = default;
  TraceSink(const TraceSink&) = default;
  TraceSink& operator=(const TraceSink&) = default;
  TraceSink(TraceSink&&) = default;
  TraceSink& operator=(TraceSink&&) = default;
};

/// Takes the steps of several runs: one sink for each, in their order, or none. They stay the caller's.
using TraceSinks = std::vector<TraceSink*>;

/// Keeps the samples of a run in memory.
class TraceRecorder final : public TraceSink {
 public:
  /// @param most  control steps that it keeps
  explicit TraceRecorder(std::size_t most = std::numeric_limits<std::size_t>::max()) : most_(most) {}
  void add(const TraceSample& sample) override;
  const Trace& samples() const noexcept { return samples_; }
  /// Returns what was kept, which is gone then.
  Trace take();

 private:
  std::size_t most_;
  Trace samples_;
};

/// Writes a trace as it comes, sample by sample, with 17 significant digits, so that reading it back loses
/// nothing. The file appears whole with `finish`, or not at all.
class TraceWriter final : public TraceSink {
 public:
  /// @throws ConfigError if the file cannot be written; so do the others
  TraceWriter(std::shared_ptr<const RobotDescription> robot, const std::string& path);
  void add(const TraceSample& sample) override;
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
