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
/// Moments are allocated; samples take the places of those that are too old.
class SessionHistory {
 public:
  /// @param control_dt  s
  explicit SessionHistory(double control_dt);

  /// Forgets all: of other instances, or other worlds of theirs, nothing can be gone back to.
  void forget() noexcept;
  /// Takes note of a control step.
  void add(const RobotInstances& instances);
  /// Returns how far back it goes, s.
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
    std::int64_t step = 0;
    std::vector<TraceSample> of;  ///< by instance
  };
  /// Returns the k-th samples since the beginning.
  Samples& samples(std::int64_t k) { return samples_[static_cast<std::size_t>(k) % samples_.size()]; }
  const Samples& samples(std::int64_t k) const {
    return samples_[static_cast<std::size_t>(k) % samples_.size()];
  }

  double control_dt_;
  std::int64_t moment_steps_, sample_steps_, steps_ = 0;
  std::deque<Moment> moments_;
  std::vector<Samples> samples_;       ///< a ring; empty until there is one
  std::int64_t first_ = 0, next_ = 0;  ///< samples that are there
};

}  // namespace crossgait
