#include "apps/trace_figure.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "gait/parameters.h"
#include "ik/leg_kinematics.h"
#include "parity/stances.h"
#include "physics/core/error.h"
#include "physics/core/math.h"
#include "physics/robot/multibody.h"

namespace crossgait::apps {
namespace {

constexpr double kToMillimetres = 1e3;
constexpr const char* kTime = "time, s";
constexpr std::string_view kParameter = "param.";
constexpr std::size_t kParametersPerRow = 3;
/// A curve over time with more points is thinned to about twice as many, extremes kept: more than pixels.
constexpr std::size_t kBuckets = 1500;

std::vector<double> scaled(std::vector<double> values, double scale) {
  for (double& value : values) value *= scale;
  return values;
}

Series over_time(const TraceTable& trace, std::string label, const std::vector<double>& values, int colour,
                 Series::Style style = Series::Style::kLine) {
  Series series{std::move(label), {}, colour, style};
  const std::vector<double>& time = trace.time();
  const std::size_t bucket = std::max<std::size_t>(1, time.size() / kBuckets);
  for (std::size_t begin = 0; begin < time.size(); begin += bucket) {
    const std::size_t end = std::min(time.size(), begin + bucket);
    std::size_t low = begin, high = begin;
    for (std::size_t i = begin; i < end; ++i) {
      if (values[i] < values[low]) low = i;
      if (values[i] > values[high]) high = i;
    }
    series.points.push_back({time[std::min(low, high)], values[std::min(low, high)]});
    if (low != high) series.points.push_back({time[std::max(low, high)], values[std::max(low, high)]});
  }
  return series;
}

Panel time_panel(std::string title, std::string y_label) {
  Panel panel;
  panel.title = std::move(title);
  panel.x_label = kTime;
  panel.y_label = std::move(y_label);
  return panel;
}

Vector3 vector_at(const TraceTable& trace, const std::string& prefix, std::size_t row) {
  return {trace.column(prefix + ".x")[row], trace.column(prefix + ".y")[row],
          trace.column(prefix + ".z")[row]};
}

struct BaseMotion {
  std::vector<double> roll, pitch, forward, left;  // deg, deg, m/s, m/s along the heading
};

BaseMotion base_motion(const TraceTable& trace) {
  BaseMotion motion;
  for (std::size_t row = 0; row < trace.rows(); ++row) {
    const Quaternion q(trace.column("q_WB.w")[row], trace.column("q_WB.x")[row], trace.column("q_WB.y")[row],
                       trace.column("q_WB.z")[row]);
    const Vector3 rpy = roll_pitch_yaw(q);
    motion.roll.push_back(kDegreesPerRadian * rpy.x());
    motion.pitch.push_back(kDegreesPerRadian * rpy.y());
    const Vector3 v = vector_at(trace, "v_WB", row);
    const double c = std::cos(rpy.z()), s = std::sin(rpy.z());
    motion.forward.push_back(c * v.x() + s * v.y());
    motion.left.push_back(-s * v.x() + c * v.y());
  }
  return motion;
}

/// Columns of joint values in the order of the robot's joint vector.
std::vector<const std::vector<double>*> joint_columns(const TraceTable& trace,
                                                      const RobotDescription& robot) {
  std::vector<const std::vector<double>*> columns;
  columns.reserve(static_cast<std::size_t>(robot.joint_count()));
  for (int i = 0; i < robot.joint_count(); ++i) columns.push_back(&trace.column("q." + robot.joint(i).name));
  return columns;
}

}  // namespace

std::vector<Figure::Row> gait_rows(const TraceTable& trace, double shortest) {
  const std::string left_out =
      shortest > 0 ? fmt::format(" (touches and gaps under {:g} ms left out)", 1e3 * shortest) : "";
  Panel panel = time_panel("Gait diagram: feet on the ground" + left_out, "");
  panel.y_range = {-0.6, kLegCount - 0.4};
  const std::vector<double>& time = trace.time();
  Bars actual{"on the ground", {}, 4, true}, planned{"planned stance", {}, 6, false};
  for (const Leg leg : kLegs) {
    const double y = kLegCount - 1 - static_cast<int>(leg);
    panel.y_names.emplace_back(y, name(leg));
    const auto add = [&](Bars& bars, const std::string& column, double half_width, double least) {
      for (const Stance& s : stances(time, trace.column(column), least))
        bars.bars.push_back({{s.begin, y - half_width}, {s.end, y + half_width}});
    };
    add(actual, fmt::format("contact.{}", name(leg)), 0.28, shortest);
    const std::string plan = fmt::format("planned.{}", name(leg));
    if (trace.has(plan)) add(planned, plan, 0.38, 0);
    // The whole time belongs to the axis, also where every foot is in the air.
    panel.series.push_back(
        {"", {{time.front(), y}, {row_end(time, time.size() - 1), y}}, 6, Series::Style::kLine, 0.6});
  }
  panel.bars = {std::move(actual), std::move(planned)};
  return {{{std::move(panel)}, 260, 1}};
}

std::vector<Figure::Row> attitude_rows(const TraceTable& trace) {
  const BaseMotion motion = base_motion(trace);
  Panel height = time_panel("Height of the base", "p_WB.z, mm");
  height.series.push_back(over_time(trace, "", scaled(trace.column("p_WB.z"), kToMillimetres), 0));
  Panel tilt = time_panel("Attitude of the base", "angle, deg");
  tilt.series.push_back(over_time(trace, "roll", motion.roll, 0));
  tilt.series.push_back(over_time(trace, "pitch", motion.pitch, 1));
  Panel speed = time_panel("Speed of the base along its heading", "speed, m/s");
  speed.series.push_back(over_time(trace, "forward", motion.forward, 0));
  speed.series.push_back(over_time(trace, "left", motion.left, 1));
  Panel turn = time_panel("Yaw rate of the base", "w_WB.z, deg/s");
  turn.series.push_back(over_time(trace, "", scaled(trace.column("w_WB.z"), kDegreesPerRadian), 0));
  return {{{std::move(height), std::move(tilt)}}, {{std::move(speed), std::move(turn)}}};
}

std::vector<Figure::Row> joint_rows(const TraceTable& trace, const RobotDescription& robot) {
  std::vector<Figure::Row> rows(2);
  if (!robot.legs) throw ConfigError(robot.source, "legs", "a robot with four legs", "none");
  for (const Leg leg : kLegs) {
    const LegModel& model = (*robot.legs)[leg];
    Panel panel = time_panel(fmt::format("Servos of {}", name(leg)), "angle, deg");
    for (std::size_t k = 0; k < model.servos.size(); ++k) {
      const auto i = static_cast<int>(k);
      std::string label(model.roles()[k].name);
      std::replace(label.begin(), label.end(), '_', ' ');
      const int joint = model.servos[k];
      const std::string& joint_name = robot.joint(joint).name;
      panel.series.push_back(
          over_time(trace, label, scaled(trace.column("q." + joint_name), kDegreesPerRadian), i));
      panel.series.push_back(over_time(trace, "",
                                       scaled(trace.column("target." + joint_name), kDegreesPerRadian), i,
                                       Series::Style::kDashed));
    }
    // One entry of the legend for all three: a curve of a single point.
    panel.series.push_back({"targets", {panel.series.back().points.front()}, 6, Series::Style::kDashed});
    rows[is_front(leg) ? 0 : 1].panels.push_back(std::move(panel));
  }
  return rows;
}

std::vector<Figure::Row> feet_rows(const TraceTable& trace, const RobotDescription& robot) {
  const LegArray<Vector3> origins = leg_origins(robot);
  const auto columns = joint_columns(trace, robot);
  LegArray<Series> paths, stances;
  LegArray<const std::vector<double>*> contact{};
  for (const Leg leg : kLegs) {
    paths[leg] = {"path", {}, 4, Series::Style::kLine};
    stances[leg] = {"on the ground", {}, 1, Series::Style::kPoints};
    contact[leg] = &trace.column(fmt::format("contact.{}", name(leg)));
  }
  RobotState state;  // the base at the origin: positions come out in its frame
  state.q = JointVector::Zero(robot.joint_count());
  std::vector<Pose> poses;
  for (std::size_t row = 0; row < trace.rows(); ++row) {
    for (int i = 0; i < robot.joint_count(); ++i) state.q[i] = (*columns[static_cast<std::size_t>(i)])[row];
    forward_kinematics(robot, state, poses);
    for (const Leg leg : kLegs) {
      const Vector3 p = kToMillimetres * (foot_position(robot, leg, poses) - origins[leg]);
      paths[leg].points.push_back({p.x(), p.z()});
      if ((*contact[leg])[row] != 0) stances[leg].points.push_back({p.x(), p.z()});
    }
  }
  std::vector<Figure::Row> rows(2);
  for (const Leg leg : kLegs) {
    Panel panel;
    panel.title = fmt::format("Foot {} from the side", name(leg));
    panel.x_label = "x forward in the leg frame, mm";
    panel.y_label = "z up from the shoulders, mm";
    panel.equal_scales = true;
    panel.series = {std::move(paths[leg]), std::move(stances[leg])};
    Figure::Row& row = rows[is_front(leg) ? 0 : 1];
    row.height = 300;
    row.panels.push_back(std::move(panel));
  }
  return rows;
}

std::vector<std::string> constant_parameters(const TraceTable& trace) {
  std::vector<std::string> names;
  for (const std::string& column : trace.names()) {
    if (!column.starts_with(kParameter)) continue;
    const auto [low, high] = std::minmax_element(trace.column(column).begin(), trace.column(column).end());
    if (*low == *high) names.push_back(column.substr(kParameter.size()));
  }
  return names;
}

std::vector<Figure::Row> parameter_rows(const TraceTable& trace, bool constant_too) {
  const std::vector<std::string> constant = constant_parameters(trace);
  std::vector<Figure::Row> rows;
  for (const std::string& column : trace.names()) {
    if (!column.starts_with(kParameter)) continue;
    const bool changes =
        std::find(constant.begin(), constant.end(), column.substr(kParameter.size())) == constant.end();
    if (!changes && !constant_too) continue;
    const std::string parameter = column.substr(kParameter.size());
    std::string unit;
    for (const ParameterRow& known : gait_parameters()) {
      if (known.name == parameter) unit = known.unit;
    }
    const bool has_unit = !unit.empty() && unit != "-";
    Panel panel = time_panel(has_unit ? fmt::format("{}, {}", parameter, unit) : parameter, "");
    panel.series.push_back(over_time(trace, "", trace.column(column), 0));
    if (rows.empty() || rows.back().panels.size() == kParametersPerRow)
      rows.push_back({{}, 230, kParametersPerRow});
    rows.back().panels.push_back(std::move(panel));
  }
  return rows;
}

}  // namespace crossgait::apps
