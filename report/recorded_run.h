// One run to be replayed, whichever engine or file it came from.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "motion/trace.h"
#include "motion/trace_table.h"

namespace crossgait {

/// Most control steps of a run that is kept for a page: 200 s at 2 ms, of which a page shows every second
/// frame.
inline constexpr std::size_t kMaxPageSteps = 100'000;

/// Prefix of the name of a reward term: a column of what a policy step earned by it.
inline constexpr std::string_view kRewardColumn = "reward.";
/// Prefix of the name of a gait parameter.
inline constexpr std::string_view kParameterColumn = "param.";

struct RecordedRun {
  /// Holds something else that is known of every sample.
  struct Column {
    std::string name;
    std::vector<double> values;  ///< a number for each sample
  };

  std::string name;                  ///< of the engine, or the file's
  std::string engine;                ///< "MuJoCo 2.2.2"; empty where that is not known
  Trace samples;                     ///< every control step
  std::vector<Column> columns = {};  ///< rewards, and the parameters that a file names
  bool force_directions = true;      ///< false: of the forces on feet only the size is known, as `load`
  std::string outcome = {};          ///< "fell at 1.25 s"; empty where that is not known
  /// When that was, s since the motion began, of an outcome that is known at once.
  std::optional<double> outcome_at_s = {};

  /// Returns null if there is none of that name.
  const std::vector<double>* column(std::string_view its_name) const noexcept;
  /// Returns the time of every sample, s.
  std::vector<double> times() const;
};

/// Makes samples of the rows of a file: torques, targets, planned contacts and directions of forces where
/// there are columns of them; the velocities of joints are in none. @param name  RecordedRun::name
/// @throws ConfigError for a column that is missing: the trace is of another robot; or for an orientation
/// that is none
RecordedRun recorded_run(std::string name, const TraceTable& table, const RobotDescription& robot);

/// Holds what a page shows of a run.
struct RunFrames {
  std::vector<std::size_t> rows;        ///< numbers of samples, one per frame
  std::vector<LegArray<Vector3>> p_WF;  ///< centres of the feet at each frame, m
};

}  // namespace crossgait
