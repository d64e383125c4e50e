#include "report/panels.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "env/reward.h"
#include "gait/parameters.h"
#include "physics/core/heading.h"
#include "report/motion_document.h"

namespace crossgait {
namespace {

using nlohmann::ordered_json;

constexpr double kToMillimetres = 1e3;

ordered_json difference_panel(const char* title, const char* unit) {
  return {{"group", "differences"},
          {"title", title},
          {"unit", unit},
          {"log", true},
          {"series", ordered_json::array()}};
}

std::string in_words(std::string_view name) {
  std::string words(name);
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

/// Of any run, in the order in which they come.
std::vector<std::string> parameters_of(const std::vector<RecordedRun>& runs) {
  std::vector<std::string> names;
  const auto add = [&names](std::string_view name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.emplace_back(name);
  };
  for (const RecordedRun& run : runs) {
    if (run.samples.front().parameters) {
      for (const ParameterRow& row : gait_parameters()) add(row.name);
    }
    for (const RecordedRun::Column& column : run.columns) {
      if (column.name.starts_with(kParameterColumn))
        add(std::string_view(column.name).substr(kParameterColumn.size()));
    }
  }
  return names;
}

/// As a file says, or as the gait had it.
std::optional<double> parameter_of(const RecordedRun& run, std::size_t row, std::string_view parameter) {
  if (const auto* values = run.column(fmt::format("{}{}", kParameterColumn, parameter)))
    return (*values)[row];
  const std::optional<GaitParameters>& gait = run.samples[row].parameters;
  if (!gait) return std::nullopt;
  for (const ParameterRow& known : gait_parameters()) {
    if (known.name == parameter) return (*gait).*known.member;
  }
  return std::nullopt;
}

// A robot that rolls over goes on beyond 180 degrees, rather than back across the whole plot.
void add_unwrapped(std::vector<double>& degrees, double next) {
  if (!degrees.empty()) next += 360 * std::round((degrees.back() - next) / 360);
  degrees.push_back(next);
}

/// None of a vector that a run does not know.
std::optional<double> element(const JointVector& values, std::size_t i) {
  if (values.size() == 0) return std::nullopt;
  return values[static_cast<Eigen::Index>(i)];
}

/// "-" of one that is none of the gait's.
std::string unit_of(std::string_view parameter) {
  for (const ParameterRow& row : gait_parameters()) {
    if (row.name == parameter) return std::string(row.unit);
  }
  return "-";
}

}  // namespace

PanelMaker::PanelMaker(const Motion& motion, const std::vector<RunFrames>& frames, PageNumbers& numbers)
    : motion_(motion), frames_(frames), numbers_(numbers) {
  differences_ = ordered_json::array({difference_panel("Bases apart", "m"),
                                      difference_panel("Joints apart, the largest", "rad"),
                                      difference_panel("Attitudes apart", "rad")});
  add_base();
  add_feet();
  if (!motion.joints) return;
  add_joints();
  add_parameters();
  add_rewards();
}

void PanelMaker::add(const char* group, const std::string& title, const std::string& unit,
                     const std::vector<Series>& series, std::string_view leg) {
  if (series.empty()) return;
  ordered_json panel{{"group", group}, {"title", title}, {"unit", unit}, {"log", false}};
  if (!leg.empty()) panel["leg"] = leg;
  for (const Series& s : series)
    panel["series"].push_back(
        {{"run", s.run}, {"label", s.label}, {"dashed", s.dashed}, {"values", numbers_.add(s.values)}});
  panels_.push_back(std::move(panel));
}

std::vector<PanelMaker::Series> PanelMaker::series_of(const Value& value, double scale,
                                                      const std::string& label, bool dashed) const {
  std::vector<Series> all;
  for (std::size_t run = 0; run < frames_.size(); ++run) {
    if (!value(motion_.runs[run], 0)) continue;
    Series& series = all.emplace_back(Series{run, label, dashed, {}});
    for (const std::size_t row : frames_[run].rows)
      series.values.push_back(scale * value(motion_.runs[run], row).value());
  }
  return all;
}

void PanelMaker::add_base() {
  std::vector<Series> roll, pitch, forward, left;
  for (std::size_t run = 0; run < frames_.size(); ++run) {
    for (std::vector<Series>* series : {&roll, &pitch, &forward, &left})
      series->push_back({run, "", false, {}});
    for (const std::size_t row : frames_[run].rows) {
      const RobotState& state = motion_.runs[run].samples[row].state;
      const Vector3 rpy = roll_pitch_yaw(state.q_WB);
      const Vector3 velocity = Heading(state.q_WB).components(state.v_WB);
      add_unwrapped(roll.back().values, kDegreesPerRadian * rpy.x());
      pitch.back().values.push_back(kDegreesPerRadian * rpy.y());
      forward.back().values.push_back(velocity.x());
      left.back().values.push_back(velocity.y());
    }
  }
  add("base", "Roll", "deg", roll);
  add("base", "Pitch", "deg", pitch);
  const auto height = [](const RecordedRun& run, std::size_t row) { return run.samples[row].state.p_WB.z(); };
  const auto yaw_rate = [](const RecordedRun& run, std::size_t row) {
    return run.samples[row].state.w_WB.z();
  };
  add("base", "Height of the base", "mm", series_of(height, kToMillimetres));
  add("base", "Speed along the heading", "m/s", forward);
  add("base", "Speed to the left", "m/s", left);
  add("base", "Yaw rate", "deg/s", series_of(yaw_rate, kDegreesPerRadian));
}

void PanelMaker::add_feet() {
  const LegArray<LegModel>& legs = *motion_.robot->legs;
  LegArray<std::vector<Series>> clearance;
  for (std::size_t run = 0; run < frames_.size(); ++run) {
    for (const Leg leg : kLegs) {
      Series& series = clearance[leg].emplace_back(Series{run, "", false, {}});
      for (const LegArray<Vector3>& feet : frames_[run].p_WF) {
        const Vector3& p = feet[leg];
        const double ground = motion_.terrain.height(p.x(), p.y());
        series.values.push_back(kToMillimetres * (p.z() - legs[leg].foot_radius - ground));
      }
    }
  }
  for (const Leg leg : kLegs) {
    add("feet", "Foot above the ground", "mm", clearance[leg], name(leg));
    const auto load = [leg](const RecordedRun& run, std::size_t row) { return run.samples[row].load[leg]; };
    add("feet", "Force on the foot", "N", series_of(load, 1), name(leg));
  }
}

void PanelMaker::add_joints() {
  const RobotDescription& robot = *motion_.robot;
  const std::vector<int> actuated = robot.actuated_joints();
  for (const Leg leg : kLegs) {
    const LegModel& model = (*robot.legs)[leg];
    for (std::size_t k = 0; k < model.servos.size(); ++k) {
      const auto joint = static_cast<std::size_t>(model.servos[k]);
      const auto servo = static_cast<std::size_t>(
          std::find(actuated.begin(), actuated.end(), model.servos[k]) - actuated.begin());
      const auto angle_of = [joint](const RecordedRun& run, std::size_t row) {
        return element(run.samples[row].state.q, joint);
      };
      const auto target_of = [servo](const RecordedRun& run, std::size_t row) {
        return element(run.samples[row].targets.q, servo);
      };
      std::vector<Series> angle = series_of(angle_of, kDegreesPerRadian);
      for (Series& target : series_of(target_of, kDegreesPerRadian, "target", true))
        angle.push_back(std::move(target));
      add("joints", "Angle of " + in_words(model.roles()[k].name), "deg", angle, name(leg));
    }
    for (std::size_t k = 0; k < model.servos.size(); ++k) {
      const auto torque_of = [joint = static_cast<std::size_t>(model.servos[k])](const RecordedRun& run,
                                                                                 std::size_t row) {
        return element(run.samples[row].torques, joint);
      };
      add("joints", "Torque of " + in_words(model.roles()[k].name), "N m", series_of(torque_of, 1),
          name(leg));
    }
  }
}

void PanelMaker::add_parameters() {
  for (const std::string& parameter : parameters_of(motion_.runs)) {
    const std::string unit = unit_of(parameter);
    const auto value = [&parameter](const RecordedRun& run, std::size_t row) {
      return parameter_of(run, row, parameter);
    };
    std::vector<Series> series = series_of(value, 1);
    const double first = series.front().values.front();
    const auto constant = [first](const Series& s) {
      return s.values == std::vector<double>(s.values.size(), first);
    };
    if (std::all_of(series.begin(), series.end(), constant)) {
      constants_.push_back({{"name", in_words(parameter)}, {"unit", unit}, {"value", first}});
    } else {
      add("parameters", in_words(parameter), unit, series);
    }
  }
}

void PanelMaker::add_rewards() {
  for (const RewardTerm& term : reward_terms()) {
    const auto earned = [column = fmt::format("{}{}", kRewardColumn, term.name)](
                            const RecordedRun& run, std::size_t row) -> std::optional<double> {
      const std::vector<double>* values = run.column(column);
      return values != nullptr ? std::optional((*values)[row]) : std::nullopt;
    };
    add("rewards", in_words(term.name), "", series_of(earned, 1));
  }
}

void PanelMaker::add_pair(std::size_t a, std::size_t b, const PairPanels& differences) {
  const std::string label = motion_.runs[a].name + " and " + motion_.runs[b].name;
  std::size_t panel = 0;
  for (const std::vector<double>* values :
       {&differences.position_m, &differences.joint_rad, &differences.attitude_rad}) {
    differences_[panel++]["series"].push_back(
        {{"run", a}, {"other", b}, {"label", label}, {"dashed", false}, {"values", numbers_.add(*values)}});
  }
}

nlohmann::ordered_json PanelMaker::finish() {
  for (ordered_json& panel : differences_) {
    if (!panel["series"].empty()) panels_.push_back(std::move(panel));
  }
  return std::move(panels_);
}

}  // namespace crossgait
