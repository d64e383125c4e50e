// The one closed loop: targets, engine, statistics, again. Walks, episodes and verdicts all run in it.
#pragma once

#include <cstdint>
#include <optional>

#include "motion/controller.h"
#include "motion/motion_statistics.h"
#include "motion/pushes.h"
#include "physics/engine/physics_backend.h"

namespace crossgait {

/// Says how a motion begins.
struct Start {
  Placement placement;
  double warm_up = 0;  ///< of the motion itself, after settling and before statistics begin, s
  Pushes pushes;       ///< times count from the beginning of the statistics
  /// How the robot begins, in the place of standing; heights are measured from where it would stand.
  std::optional<RobotState> state = std::nullopt;
};

/// Runs a motion as a value: a copy taken between two calls and used with a world that was saved and restored
/// along with it continues bit for bit. It keeps no reference to world or controller; both are handed over
/// with every call, and have to be the same ones from `start` on.
class ClosedLoop {
 public:
  struct Options {
    double control_dt = 2e-3;     ///< gait, kinematics and servo targets, s; a multiple of the physics step
    double settle_seconds = 0.5;  ///< standing before the motion, s
    OutcomeLimits limits = {};
    OutcomeSet terminations = OutcomeSet::of_walks();  ///< outcomes that end the motion
  };

  ClosedLoop(const RobotDescription& robot, const Options& options);

  /// Puts the robot down, lets it settle and begins. @throws ConfigError if the control step is no multiple
  /// of the world's physics step, the place is off the terrain, or the controller cannot stand
  void start(PhysicsBackend& world, Controller& controller, const Start& start = {});

  /// Runs `steps` more control steps; fewer, if an outcome ends the motion. @returns false once it has ended
  bool advance(PhysicsBackend& world, Controller& controller, int steps);

  /// Takes note that the world's robot was put elsewhere by hand.
  void moved(const PhysicsBackend& world) noexcept { statistics_.moved(world); }

  /// Takes note that somebody else ends the motion.
  void terminated() noexcept { statistics_.note(Outcome::kTerminated); }

  bool ended() const noexcept { return ended_; }
  /// Returns the targets of the last control step.
  const ControlTargets& targets() const noexcept { return targets_; }
  const MotionStatistics& statistics() const noexcept { return statistics_; }
  /// Returns the time since the beginning, s.
  double time() const noexcept { return static_cast<double>(steps_) * options_.control_dt; }

 private:
  void next_targets(const PhysicsBackend& world, Controller& controller);
  StepStatus control_step(PhysicsBackend& world, bool watched);

  Options options_;
  MotionStatistics statistics_;
  ControlTargets targets_;
  Pushes pushes_;
  int substeps_ = 0;
  std::int64_t steps_ = 0;
  bool ended_ = false;
};

}  // namespace crossgait
