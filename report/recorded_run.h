// One run to be replayed: its trace, whichever engine or file it came from.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "motion/trace.h"
#include "motion/trace_table.h"

namespace crossgait {

struct RecordedRun {
  std::string name;    ///< of the engine, or the file's
  std::string engine;  ///< "MuJoCo 2.2.2"; empty where that is not known
  TraceTable trace;
};

/// Most control steps of a run that is kept for a page: 200 s at 2 ms, of which a page shows every second
/// frame.
inline constexpr std::size_t kMaxPageSteps = 100'000;

/// In front of the name of a reward term: a column of what a policy step earned by it.
inline constexpr std::string_view kRewardColumn = "reward.";

/// Keeps the steps of a walk: the columns of TraceColumns, `force.<leg>.{x,y,z}` (on the foot, in W, N) and
/// `torque.<joint>` (of the last physics step, N m), and what the caller adds.
class RunRecorder {
 public:
  /// @param more  names of further columns
  explicit RunRecorder(std::shared_ptr<const RobotDescription> robot, std::vector<std::string> more = {})
      : robot_(std::move(robot)), more_(std::move(more)) {}
  /// @param more  a number for each of the further columns  @throws ConfigError beyond kMaxPageSteps
  void add(const TraceSample& sample, std::span<const double> more = {});
  bool empty() const { return values_.empty(); }
  /// What was kept, which is gone then. @throws ConfigError if that is nothing
  TraceTable take(const std::string& source);

 private:
  void begin(const TraceSample& first);

  std::shared_ptr<const RobotDescription> robot_;
  std::optional<TraceColumns> columns_;
  std::vector<std::string> more_, names_;
  std::vector<std::vector<double>> values_;
  std::vector<double> row_;
};

/// The rows of a trace as samples: state, loads, and forces where there are columns of them.
class SampleReader {
 public:
  /// Both stay the caller's. @throws ConfigError for a column that is missing: the trace is of another robot,
  /// or an orientation that is none
  SampleReader(const TraceTable& trace, const RobotDescription& robot);

  TraceSample at(std::size_t row) const;
  bool has_forces() const { return !forces_.empty(); }

 private:
  using Column = const std::vector<double>*;
  std::vector<Column> columns(const std::string& prefix, std::string_view axes) const;

  const TraceTable& trace_;
  std::vector<Column> position_, orientation_, velocity_, turning_, angles_, loads_, contacts_, forces_;
};

/// What a page shows of a run.
struct RunFrames {
  SampleReader reader;
  std::vector<std::size_t> rows;        ///< of the trace, one per frame
  std::vector<LegArray<Vector3>> p_WF;  ///< centres of the feet at each frame, m
};

}  // namespace crossgait
