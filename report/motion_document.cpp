#include "report/motion_document.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "parity/stances.h"
#include "physics/core/error.h"
#include "physics/robot/hips.h"
#include "physics/robot/multibody.h"
#include "report/panels.h"
#include "report/scene.h"

namespace crossgait {
namespace {

using nlohmann::ordered_json;

void append(std::vector<double>& numbers, const Vector3& v) {
  numbers.insert(numbers.end(), v.data(), v.data() + 3);
}

void append(std::vector<double>& numbers, const Pose& X) {
  append(numbers, Vector3(X.translation()));
  const Quaternion q(X.linear());
  numbers.insert(numbers.end(), q.coeffs().data(), q.coeffs().data() + 4);  // x, y, z, w
}

/// Begin and end of the times in which `stands(sample, leg)`, by leg.
template <typename Stands>
ordered_json stances_of(const RecordedRun& run, double shortest, const Stands& stands) {
  const std::vector<double> time = run.times();
  std::vector<double> contact(time.size());
  ordered_json legs = ordered_json::array();
  for (const Leg leg : kLegs) {
    for (std::size_t i = 0; i < contact.size(); ++i) contact[i] = stands(run.samples[i], leg) ? 1 : 0;
    ordered_json times = ordered_json::array();
    for (const Stance& s : stances(time, contact, shortest)) {
      times.push_back(s.begin);
      times.push_back(s.end);
    }
    legs.push_back(std::move(times));
  }
  return legs;
}

ordered_json contacts_of(const RecordedRun& run, double shortest) {
  return stances_of(run, shortest, [](const TraceSample& s, Leg leg) { return s.contact[leg]; });
}

ordered_json planned_contacts_of(const RecordedRun& run) {
  if (!run.samples.front().contact_schedule) return nullptr;
  return stances_of(run, 0, [](const TraceSample& s, Leg leg) {
    return !(s.contact_schedule && (*s.contact_schedule)[leg].swing);
  });
}

/// A time since the motion began as the page has it, or null.
ordered_json at_page_time(const RecordedRun& run, const std::optional<double>& since_begin) {
  if (!since_begin) return nullptr;
  return run.samples.front().state.time + *since_begin;
}

/// Fills in where the feet are.
ordered_json run_document(const RecordedRun& run, const Motion& motion, RunFrames& frames,
                          PageNumbers& numbers) {
  const RobotDescription& robot = *motion.robot;
  std::vector<double> times, poses, feet, forces;
  std::vector<Pose> bodies;
  for (const std::size_t row : frames.rows) {
    const TraceSample& sample = run.samples[row];
    LegArray<Vector3>& p_WF = frames.p_WF.emplace_back();
    times.push_back(sample.state.time);
    forward_kinematics(robot, sample.state, bodies);
    for (const Pose& X : bodies) append(poses, X);
    for (const Leg leg : kLegs) {
      p_WF[leg] = foot_position(robot, leg, bodies);
      append(feet, p_WF[leg]);
      append(forces, run.force_directions ? sample.force[leg] : Vector3(0, 0, sample.load[leg]));
    }
  }
  return {{"name", run.name},
          {"engine", run.engine},
          {"time", numbers.add(times)},
          {"poses", numbers.add(poses)},
          {"feet", numbers.add(feet)},
          {"forces", numbers.add(forces)},
          {"force_directions", run.force_directions},
          {"outcome", run.outcome},
          {"outcome_at_s", at_page_time(run, run.outcome_at_s)},
          {"contact", contacts_of(run, motion.shortest_contact)},
          {"planned", planned_contacts_of(run)}};
}

PathBounds way_of(const std::vector<RecordedRun>& runs) {
  PathBounds path;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    path.min[i] = path.max[i] = runs.front().samples.front().state.p_WB[axis];
    for (const RecordedRun& run : runs) {
      for (const TraceSample& sample : run.samples) {
        path.min[i] = std::min(path.min[i], sample.state.p_WB[axis]);
        path.max[i] = std::max(path.max[i], sample.state.p_WB[axis]);
      }
    }
  }
  return path;
}

/// Rows that two traces share: the first of both that are at the same times, up to a fall that ends one
/// between two steps; none if only their beginnings meet.
std::size_t common_rows(const Trace& a, const Trace& b) {
  const std::size_t most = std::min(a.size(), b.size());
  std::size_t rows = 0;
  // Far less than a control step, far more than the rounding of a sum of them.
  while (rows < most && std::abs(a[rows].state.time - b[rows].state.time) <= 1e-9) ++rows;
  return rows > 1 || rows == most ? rows : 0;
}

/// How far two runs lie apart, at most, between a frame and the one before.
PairPanels pair_panels(const Trace& a, const Trace& b, std::size_t rows,
                       const std::vector<std::size_t>& frames, PairDifference& whole) {
  PairPanels panels;
  std::size_t row = 0;
  for (const std::size_t frame : frames) {
    if (frame >= rows) break;
    PairDifference here;
    for (; row <= frame; ++row) {
      static_cast<void>(compare_samples(a[row], b[row], here));
      static_cast<void>(compare_samples(a[row], b[row], whole));
    }
    panels.position_m.push_back(here.max_position_difference_m);
    panels.joint_rad.push_back(here.max_joint_difference_rad);
    panels.attitude_rad.push_back(here.max_attitude_difference_rad);
  }
  return panels;
}

ordered_json parting_document(const RecordedRun& run, const Parting& parting) {
  return {{"standing_m", parting.standing_m}, {"time_s", at_page_time(run, parting.time_s)}};
}

}  // namespace

std::vector<std::size_t> frame_rows(const std::vector<double>& time, double frame_time) {
  const double duration = time.back() - time.front();
  const double apart = std::max(frame_time, duration / static_cast<double>(kMaxFrames - 2));
  std::vector<std::size_t> rows{0};
  for (std::size_t i = 1; i < time.size(); ++i) {
    // A rounded sum of control steps may be a little short of a frame's time.
    if (time[i] - time[rows.back()] >= apart * (1 - 1e-6) || i + 1 == time.size()) rows.push_back(i);
  }
  return rows;
}

nlohmann::ordered_json motion_document(const Motion& motion, PageNumbers& numbers) {
  const RobotDescription& robot = *motion.robot;
  if (!robot.legs) throw ConfigError(robot.source, "legs", "a robot with four legs", "none");
  std::vector<RunFrames> frames;
  for (const RecordedRun& run : motion.runs) {
    if (run.samples.empty())
      throw ConfigError(run.name, "rows", "at least one control step", "an empty trace");
    frames.push_back({frame_rows(run.times(), motion.frame_time), {}});
  }
  ordered_json notes = ordered_json::array(), runs = ordered_json::array(), pairs = ordered_json::array();
  for (std::size_t i = 0; i < motion.runs.size(); ++i)
    runs.push_back(run_document(motion.runs[i], motion, frames[i], numbers));

  PanelMaker panels(motion, frames, numbers);
  std::size_t pair = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    for (std::size_t k = i + 1; k < frames.size(); ++k, ++pair) {
      const std::string& a = motion.runs[i].name;
      const std::string& b = motion.runs[k].name;
      const std::size_t rows = common_rows(motion.runs[i].samples, motion.runs[k].samples);
      if (rows == 0) {
        notes.push_back(
            fmt::format("{} and {} have rows at different times: their differences are not shown", a, b));
        continue;
      }
      PairDifference found;
      found.parting = PartingWatch(leg_length(robot));
      panels.add_pair(
          i, k, pair_panels(motion.runs[i].samples, motion.runs[k].samples, rows, frames[i].rows, found));
      const PairDifference& known = motion.pairs.empty() ? found : motion.pairs[pair];
      pairs.push_back({{"a", i},
                       {"b", k},
                       {"same", rows == motion.runs[i].samples.size() &&
                                    rows == motion.runs[k].samples.size() && is_same(found)},
                       {"parting", parting_document(motion.runs[i], known.parting.found())}});
    }
  }
  return {{"name", motion.name},
          {"side_by_side", motion.side_by_side},
          {"scene", scene_document(robot, motion.terrain, way_of(motion.runs), numbers)},
          {"runs", std::move(runs)},
          {"pairs", std::move(pairs)},
          {"panels", panels.finish()},
          {"constants", panels.constants()},
          {"shortest_contact", motion.shortest_contact},
          {"notes", std::move(notes)}};
}

}  // namespace crossgait
