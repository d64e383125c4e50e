// MuJoCo as its own users drive it: a bare mj_step loop, the yardstick of step_benchmark.
#pragma once

#include <memory>
#include <vector>

#include "physics/engine/world_spec.h"
#include "physics/robot/state.h"

namespace crossgait {

/// Steps the model that the MuJoCo engine builds, without anything of Crossgait around it.
class BareMujoco {
 public:
  explicit BareMujoco(const WorldSpec& spec);
  ~BareMujoco();
  BareMujoco(const BareMujoco&) = delete;
  BareMujoco& operator=(const BareMujoco&) = delete;

  /// Starts at `state` and replays joint torques, one vector per physics step.
  void replay(const RobotState& state, const std::vector<JointVector>& torques);
  /// Returns the base position after the replay, W, m.
  Vector3 position() const;

 private:
  struct Engine;
  std::unique_ptr<Engine> engine_;
};

}  // namespace crossgait
