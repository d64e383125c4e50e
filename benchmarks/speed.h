// What a physics step costs: every engine on the same motions, in turns.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "benchmarks/statistics.h"
#include "parity/comparison.h"
#include "physics/engine/engine.h"
#include "scenes/scenes.h"

namespace crossgait::benchmarks {

/// Describes a motion to be timed.
struct SpeedScene {
  std::string name, summary;
  WorldSpec spec;
  double start = 0;  ///< when timing begins, s: what comes before brings the robot there
  int steps = 1600;  ///< physics steps of one run: two cycles of the trot
  std::function<JointTargets(double time)> targets;
};

/// Returns the scenes swing, stand, trot_flat, trot_rough, of this robot, and pile, of one of its own.
std::vector<SpeedScene> speed_scenes(const scenes::RobotPtr& robot = scenes::quadruped());

struct SpeedSettings {
  std::vector<std::string> engines;  ///< the first one is what the others are compared to
  int rounds = 31;                   ///< every engine has its turn in each
  scenes::RobotPtr robot = scenes::quadruped();
};

/// Holds the speed of one scene in one engine.
struct SceneSpeed {
  std::string scene, engine;
  double contacts = 0;    ///< mean number per step
  Quartiles us_per_step;  ///< CPU time of the thread, us
  Quartiles ratio;        ///< to the first engine in the same round
};

/// Runs a world that stands where a scene begins, and can be put back there bit for bit.
class SceneRunner {
 public:
  /// @throws std::runtime_error if the engine diverges on the way
  SceneRunner(const SpeedScene& scene, const Engine& engine);
  /// Returns the CPU time of the scene, per step, s. @throws std::runtime_error if the engine diverges
  double run();
  /// Runs the scene `times` times without looking at a clock. False if the engine diverged.
  bool repeat(int times);
  /// Returns the mean number of contacts per step; runs the scene once.
  double count_contacts();

 private:
  std::string what_;
  std::unique_ptr<PhysicsBackend> world_;
  std::vector<JointTargets> targets_;
  Snapshot start_;
};

/// @throws std::runtime_error if an engine diverges
std::vector<SceneSpeed> measure_speed(const SpeedSettings& settings, const Progress& progress);

}  // namespace crossgait::benchmarks
