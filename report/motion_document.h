// Runs of one robot on one ground, as a page replays them.
#pragma once

#include <memory>
#include <vector>

#include <nlohmann/json.hpp>

#include "parity/divergence.h"
#include "parity/stances.h"
#include "physics/robot/robot.h"
#include "physics/terrain/terrain.h"
#include "report/page_numbers.h"
#include "report/recorded_run.h"

namespace crossgait {

/// Shortest time between two frames, s: more of them than a screen shows in slow motion at a tenth.
inline constexpr double kFrameTime = 0.01;

struct Motion {
  std::shared_ptr<const RobotDescription> robot;
  Terrain terrain;
  std::vector<RecordedRun> runs;  ///< at least one
  /// What is known of every two runs, in order (as `Comparison::pairs`); empty: found in the samples.
  std::vector<PairDifference> pairs = {};
  double shortest_contact = kShortestContact;  ///< that is a stance, and shortest gap between two, s
  std::string name = {};                       ///< tells it from the others of its page; empty of one alone
  bool side_by_side = false;                   ///< how runs stand at first, else in one place
  double frame_time = kFrameTime;              ///< least time between two frames, s
  bool joints = true;  ///< angles, torques, parameters and rewards are plotted, too: most of a page's size
};

inline constexpr std::size_t kMaxFrames = 20'000;  ///< of a run

/// Lists samples that are frames: those at least `frame_time` (s) behind the last one, and the last one.
std::vector<std::size_t> frame_rows(const std::vector<double>& time, double frame_time = kFrameTime);

/// Writes the keys `name`, `side_by_side`, `scene` (scene.h), `runs`, `pairs`, `panels` and `constants`
/// (panels.h), `shortest_contact` and `notes`. Of a run: `name`, `engine`, `time` (s, of every frame),
/// `poses` (of every body in W at every frame: x, y, z in m, then the quaternion x, y, z, w), `feet` (centres
/// in W, m: frame, leg, x y z), `forces` (on feet in W, N, alike), `force_directions` (false: only the
/// magnitudes are known, as z), `contact` and `planned` (by leg, pairs begin, end of stances in s). Of a
/// pair: indices `a` and `b` of runs, `first_divergence` or null.
/// @throws ConfigError for a run without a sample, or a robot without legs
nlohmann::ordered_json motion_document(const Motion& motion, PageNumbers& numbers);

}  // namespace crossgait
