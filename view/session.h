// What `crossgait view` simulates: commands in, frames out. Free of engines' names, of HTTP and of the clock
// on the wall: a session is one object on one thread, and the same commands at the same steps give the same
// motion.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "env/loaded_env.h"
#include "report/page.h"
#include "view/command.h"
#include "view/session_history.h"
#include "view/subject.h"

namespace crossgait {

/// Provides engines as a session reaches them.
struct EngineProvider {
  std::vector<std::string> names;                       ///< that may be asked for
  std::function<Engine(const std::string& name)> find;  ///< throws ConfigError
};

/// Holds a policy that drives, and the environment that it is for.
struct ViewPolicy {
  LoadedEnv environment;
  std::string policy;  ///< as `load_policy` takes it
};

struct ViewSetup {
  ViewSubject subject;        ///< what all of this is made of, for pages to show
  WorldSpec world;            ///< unused where a policy drives
  std::string gait = "trot";  ///< so is this
  std::optional<ViewPolicy> policy = {};
  std::uint64_t terrain_seed = 0;    ///< for pages to show
  std::vector<std::string> engines;  ///< one to kMaxInstances of them
  double control_dt = 2e-3;          ///< s, a multiple of the physics step
};

/// Robots side by side.
inline constexpr std::size_t kMaxInstances = 3;
/// Longest recording, control steps: a minute at 2 ms.
inline constexpr std::size_t kMaxRecordedSteps = 30'000;
/// Most control steps of a StepCommand.
inline constexpr std::uint64_t kMostStepsAtOnce = 500;

class ViewSession {
 public:
  /// Makes robots that stand, settled. @throws ConfigError
  ViewSession(const ViewSetup& setup, EngineProvider provider, SubjectProvider subjects = {});

  /// Applies a command at once, before the next step. A command that is refused changes nothing.
  /// @throws ConfigError for what is out of bounds, not known or cannot be made
  void apply(const ViewCommand& command);
  /// Steps all robots together; does nothing while paused. Memory stays as it is once there is a minute of
  /// history, but for a recording.
  void advance(int steps);

  double control_dt() const noexcept { return setup_.control_dt; }
  bool paused() const noexcept { return paused_; }
  /// Returns simulated time over time on the clock, as a viewer wants it.
  double pace() const noexcept { return pace_; }
  const RobotInstances& instances() const noexcept { return instances_; }

  // As documents, for pages (session_documents.cpp).

  /// Writes what changes with the subject alone: `subject` (its revision), `robots` and `policies` (names
  /// that may be chosen), `robot` (the name or file of the one that there is), `engines`, `most_engines`,
  /// `gaits` (`name`, `summary`), `parameters`
  /// (`name`, `unit`, `help`, `min`, `max`), `curves` (of the swing), `terrains` (`name`, `help`), `joints`
  /// (names of servos), `quantities` that may be changed (`name`, `unit`, `help`, `factor`: whether by a
  /// factor, `min`, `max`, `value`), `limits`
  /// (`forward`, `left`, `yaw_rate`, `push`), `mass` (kg) and `policy` (its name, null where a hand drives).
  nlohmann::ordered_json options() const;
  /// Writes what changes with the ground: `revision`, `scene` (report/scene.h) and its `numbers` in base64.
  const nlohmann::ordered_json& scene() const noexcept { return scene_; }
  /// Grows with every change of the subject.
  int subject_revision() const noexcept { return subject_revision_; }
  /// Grows with every change of the ground or the subject.
  int scene_revision() const noexcept { return scene_revision_; }
  /// Writes the moment: `subject` and `scene` (revisions), `paused`, `pace`, `back` (s that can be gone
  /// back), `changes` (of the world, as ChangeCommand has them), `pull` (the point that pulls, null if none
  /// does), `pull_force` (of its spring on the first robot in the last step, N), `chosen` (what the driver
  /// chose, `auto` perhaps), `gait` (the one that walks), `curve`, `phase` and `parameters` (values, in the
  /// order of `options`; all five null where joints are commanded), `command` (`vx`, `vy`, `yaw_rate`),
  /// `terrain`, `seed`, `recorded` (s, null if nothing is being recorded), `reports` (recordings so far) and
  /// `robots`: `engine`, `law` (of contact), `outcome`, `time` (s), `poses` of all bodies in W (x, y, z in m,
  /// quaternion x, y, z, w), `feet` (centres in W, m), `forces` on them (in W, N), `contact` and `swing` by
  /// leg, `velocity` of the base (forward, left in m/s, turning left in rad/s), `roll`, `pitch` (rad),
  /// `height` over the ground (m), `angles` (rad), `speeds` (rad/s) and `torques` (N m) of servos in the
  /// order of `options`, and from the first robot `gap` (of the bases, m) and `turned` (rad). Numbers are
  /// rounded to 1e-5.
  nlohmann::ordered_json frame() const;

  /// Returns the last recording that was finished; null if there is none. It does not change any more.
  std::shared_ptr<const ReportPage> recording() const noexcept { return recording_; }

 private:
  RobotInstances make_instances(const ViewSetup& setup) const;
  static nlohmann::ordered_json scene_of(const WorldSpec& world, int revision);
  const WorldSpec& world() const { return instances_.front()->world().spec(); }
  void choose_engines(const std::vector<std::string>& engines);
  void change_terrain(const TerrainCommand& command);
  void choose_robot(const std::string& robot);
  void choose_policy(const std::string& policy);
  /// Begins anew with another robot or policy, on the ground and in the engines that there are.
  void change_subject(const ViewSubject& subject);
  /// Goes on with other robots: what was recorded and can be gone back to is of those before.
  void replace(RobotInstances instances);
  void change_world(const std::vector<std::string>& texts);
  void push(const Vector3& impulse);
  void pull();
  void step_once();
  template <typename Change>
  void change_all(const Change& change);
  void record(bool on);
  void finish_recording();
  void publish(std::vector<Trace> traces, double seconds);

  ViewSetup setup_;
  EngineProvider provider_;
  SubjectProvider subjects_;
  RobotInstances instances_;
  WorldSpec nominal_;  ///< the first robot's world without changes
  std::vector<std::string> changes_;
  SessionHistory history_;
  nlohmann::ordered_json scene_;
  std::optional<Vector3> pulled_to_;
  double pull_force_ = 0;  ///< N, on the first robot in the last step
  double pace_ = 1;
  int subject_revision_ = 1, scene_revision_ = 1, recordings_ = 0;
  bool paused_ = false;
  std::vector<TraceRecorder> recorders_;  // one per instance while there is a recording
  std::vector<double> recorded_times_;    // of the last step of each that was recorded, s
  std::size_t recorded_steps_ = 0;
  std::shared_ptr<const ReportPage> recording_;
};

}  // namespace crossgait
