// The last minute of a session: moments to go back to, and what is reported of it.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "motion/trace.h"
#include "view/robot_instance.h"

namespace crossgait {

using RobotInstances = std::vector<std::unique_ptr<RobotInstance>>;

/// Keeps a moment ten times a second and a sample fifty times, of every instance; of the last minute alone.
class SessionHistory {
 public:
  /// @param control_dt  s
  explicit SessionHistory(double control_dt);

  /// Forgets all: of other instances, or other worlds of theirs, nothing can be gone back to.
  void forget() noexcept;
  /// Takes note of a control step.
  void add(const RobotInstances& instances);
  /// How far back it goes, s.
  double seconds() const noexcept;
  /// Puts the instances where they were that long ago, to the moment before, and forgets what came after.
  /// @param seconds  0 to `seconds()`
  void back(double seconds, RobotInstances& instances);
  /// Returns the samples, by instance.
  std::vector<Trace> traces() const;

 private:
  struct Moment {
    std::int64_t step;
    std::vector<std::unique_ptr<RobotInstance::Saved>> saved;
  };
  struct Samples {
    std::int64_t step;
    std::vector<TraceSample> of;  ///< every instance
  };

  double control_dt_;
  std::int64_t moment_steps_, sample_steps_, steps_ = 0;
  std::deque<Moment> moments_;
  std::deque<Samples> samples_;
};

}  // namespace crossgait
