#include "report/motion_document.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "parity/stances.h"
#include "physics/core/error.h"
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

ordered_json stances_of(const TraceTable& trace, std::string_view group, double shortest) {
  ordered_json legs = ordered_json::array();
  for (const Leg leg : kLegs) {
    const std::string column = fmt::format("{}.{}", group, name(leg));
    if (!trace.has(column)) return nullptr;
    ordered_json times = ordered_json::array();
    for (const Stance& s : stances(trace.time(), trace.column(column), shortest)) {
      times.push_back(s.begin);
      times.push_back(s.end);
    }
    legs.push_back(std::move(times));
  }
  return legs;
}

/// Fills in where the feet are.
ordered_json run_document(const RecordedRun& run, const Motion& motion, RunFrames& frames,
                          PageNumbers& numbers) {
  const RobotDescription& robot = *motion.robot;
  const SampleReader& reader = frames.reader;
  std::vector<double> times, poses, feet, forces;
  std::vector<Pose> bodies;
  for (const std::size_t row : frames.rows) {
    const TraceSample sample = reader.at(row);
    LegArray<Vector3>& p_WF = frames.p_WF.emplace_back();
    times.push_back(sample.state.time);
    forward_kinematics(robot, sample.state, bodies);
    for (const Pose& X : bodies) append(poses, X);
    for (const Leg leg : kLegs) {
      p_WF[leg] = foot_position(robot, leg, bodies);
      append(feet, p_WF[leg]);
      append(forces, reader.has_forces() ? sample.force[leg] : Vector3(0, 0, sample.load[leg]));
    }
  }
  return {{"name", run.name},
          {"engine", run.engine},
          {"time", numbers.add(times)},
          {"poses", numbers.add(poses)},
          {"feet", numbers.add(feet)},
          {"forces", numbers.add(forces)},
          {"force_directions", reader.has_forces()},
          {"contact", stances_of(run.trace, "contact", motion.shortest_contact)},
          {"planned", stances_of(run.trace, "planned", 0)}};
}

PathBounds way_of(const std::vector<RecordedRun>& runs) {
  PathBounds path;
  for (std::size_t i = 0; i < 2; ++i) {
    const char* column = i == 0 ? "p_WB.x" : "p_WB.y";
    path.min[i] = path.max[i] = runs.front().trace.column(column).front();
    for (const RecordedRun& run : runs) {
      const auto [low, high] =
          std::minmax_element(run.trace.column(column).begin(), run.trace.column(column).end());
      path.min[i] = std::min(path.min[i], *low);
      path.max[i] = std::max(path.max[i], *high);
    }
  }
  return path;
}

/// Rows that two traces share: as many as the shorter has, if they are at the same times; else none.
std::size_t common_rows(const TraceTable& a, const TraceTable& b) {
  const std::size_t rows = std::min(a.rows(), b.rows());
  for (std::size_t i = 0; i < rows; ++i) {
    // Far less than a control step, far more than the rounding of a sum of them.
    if (std::abs(a.time()[i] - b.time()[i]) > 1e-9) return 0;
  }
  return rows;
}

/// How far two runs lie apart, at most, between a frame and the one before.
PairPanels pair_panels(const SampleReader& a, const SampleReader& b, std::size_t rows,
                       const std::vector<std::size_t>& frames, PairDifference& whole) {
  PairPanels panels;
  std::size_t row = 0;
  for (const std::size_t frame : frames) {
    if (frame >= rows) break;
    PairDifference here;
    for (; row <= frame; ++row) {
      const TraceSample x = a.at(row), y = b.at(row);
      compare_samples(x, y, here);
      compare_samples(x, y, whole);
    }
    panels.position_m.push_back(here.max_position_difference_m);
    panels.joint_rad.push_back(here.max_joint_difference_rad);
    panels.attitude_rad.push_back(here.max_attitude_difference_rad);
  }
  return panels;
}

ordered_json divergence_document(const std::optional<FirstDivergence>& first) {
  if (!first) return nullptr;
  return {{"quantity", first->quantity}, {"time_s", first->time_s}, {"tolerance", first->tolerance}};
}

}  // namespace

std::vector<std::size_t> frame_rows(const std::vector<double>& time) {
  const double duration = time.back() - time.front();
  const double apart = std::max(kFrameTime, duration / static_cast<double>(kMaxFrames - 2));
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
  for (const RecordedRun& run : motion.runs)
    frames.push_back({SampleReader(run.trace, robot), frame_rows(run.trace.time()), {}});
  ordered_json notes = ordered_json::array(), runs = ordered_json::array(), pairs = ordered_json::array();
  for (std::size_t i = 0; i < motion.runs.size(); ++i)
    runs.push_back(run_document(motion.runs[i], motion, frames[i], numbers));

  PanelMaker panels(motion, frames, numbers);
  std::size_t pair = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    for (std::size_t k = i + 1; k < frames.size(); ++k, ++pair) {
      const std::string& a = motion.runs[i].name;
      const std::string& b = motion.runs[k].name;
      const std::size_t rows = common_rows(motion.runs[i].trace, motion.runs[k].trace);
      if (rows == 0) {
        notes.push_back(
            fmt::format("{} and {} have rows at different times: their differences are not shown", a, b));
        continue;
      }
      PairDifference found;
      panels.add_pair(i, k, pair_panels(frames[i].reader, frames[k].reader, rows, frames[i].rows, found));
      const PairDifference& known = motion.pairs.empty() ? found : motion.pairs[pair];
      pairs.push_back(
          {{"a", i}, {"b", k}, {"first_divergence", divergence_document(known.first_divergence)}});
    }
  }
  return {{"scene", scene_document(robot, motion.terrain, way_of(motion.runs), numbers)},
          {"runs", std::move(runs)},
          {"pairs", std::move(pairs)},
          {"panels", panels.finish()},
          {"constants", panels.constants()},
          {"shortest_contact", motion.shortest_contact},
          {"notes", std::move(notes)}};
}

}  // namespace crossgait
