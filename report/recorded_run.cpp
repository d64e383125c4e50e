#include "report/recorded_run.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait {
namespace {

/// The columns of a file by what they mean.
class ColumnReader {
 public:
  ColumnReader(const TraceTable& table, const RobotDescription& robot);

  TraceSample sample(std::size_t row) const;
  bool has_forces() const { return !forces_.empty(); }

 private:
  using Column = const std::vector<double>*;
  std::vector<Column> axes(const std::string& prefix, std::string_view names) const;
  std::vector<Column> of_joints(const std::string& prefix, const std::vector<int>& joints) const;
  std::vector<Column> of_legs(const std::string& prefix) const;
  std::vector<Column> axes_of_legs(std::string_view prefix) const;

  const TraceTable& table_;
  const RobotDescription& robot_;
  std::vector<Column> position_, orientation_, velocity_, turning_, angles_, rates_, targets_, torques_,
      loads_, contacts_, planned_, forces_, points_;
};

std::vector<ColumnReader::Column> ColumnReader::axes(const std::string& prefix,
                                                     std::string_view names) const {
  std::vector<Column> found;
  for (const char axis : names) found.push_back(&table_.column(fmt::format("{}.{}", prefix, axis)));
  return found;
}

std::vector<ColumnReader::Column> ColumnReader::of_joints(const std::string& prefix,
                                                          const std::vector<int>& joints) const {
  std::vector<Column> found;
  for (const int i : joints) found.push_back(&table_.column(prefix + robot_.joint(i).name));
  return found;
}

std::vector<ColumnReader::Column> ColumnReader::of_legs(const std::string& prefix) const {
  std::vector<Column> found;
  for (const Leg leg : kLegs) found.push_back(&table_.column(prefix + std::string(name(leg))));
  return found;
}

std::vector<ColumnReader::Column> ColumnReader::axes_of_legs(std::string_view prefix) const {
  std::vector<Column> found;
  for (const Leg leg : kLegs) {
    for (const Column column : axes(fmt::format("{}.{}", prefix, name(leg)), "xyz")) found.push_back(column);
  }
  return found;
}

ColumnReader::ColumnReader(const TraceTable& table, const RobotDescription& robot)
    : table_(table), robot_(robot) {
  position_ = axes("p_WB", "xyz");
  orientation_ = axes("q_WB", "wxyz");
  velocity_ = axes("v_WB", "xyz");
  turning_ = axes("w_WB", "xyz");
  std::vector<int> joints;
  for (int i = 0; i < robot.joint_count(); ++i) joints.push_back(i);
  angles_ = of_joints("q.", joints);
  loads_ = of_legs("load.");
  contacts_ = of_legs("contact.");
  // A group of columns that a file may lack: all of it, or none.
  const auto has = [&table](std::string_view prefix) {
    return std::any_of(table.names().begin(), table.names().end(),
                       [prefix](const std::string& column) { return column.starts_with(prefix); });
  };
  if (has("target.")) targets_ = of_joints("target.", robot.actuated_joints());
  if (has("torque.")) torques_ = of_joints("torque.", joints);
  if (has("planned.")) planned_ = of_legs("planned.");
  if (has("qd.")) rates_ = of_joints("qd.", joints);
  if (has("force.")) forces_ = axes_of_legs("force");
  if (has("p_WP.")) points_ = axes_of_legs("p_WP");
}

TraceSample ColumnReader::sample(std::size_t row) const {
  const auto vector = [row](const std::vector<Column>& c, std::size_t first = 0) {
    return Vector3((*c[first])[row], (*c[first + 1])[row], (*c[first + 2])[row]);
  };
  const auto joints = [row](const std::vector<Column>& c) {
    JointVector values(static_cast<Eigen::Index>(c.size()));
    for (std::size_t i = 0; i < c.size(); ++i) values[static_cast<Eigen::Index>(i)] = (*c[i])[row];
    return values;
  };
  TraceSample sample;
  RobotState& state = sample.state;
  state.time = table_.time()[row];
  state.p_WB = vector(position_);
  state.q_WB = Quaternion((*orientation_[0])[row], (*orientation_[1])[row], (*orientation_[2])[row],
                          (*orientation_[3])[row]);
  state.v_WB = vector(velocity_);
  state.w_WB = vector(turning_);
  state.q = joints(angles_);
  state.qd = joints(rates_);
  sample.targets.q = joints(targets_);
  sample.torques = joints(torques_);
  if (!planned_.empty()) sample.contact_schedule.emplace();
  for (const Leg leg : kLegs) {
    const std::size_t i = index(leg);
    sample.load[leg] = (*loads_[i])[row];
    sample.contact[leg] = (*contacts_[i])[row] != 0;
    if (!planned_.empty()) (*sample.contact_schedule)[leg].swing = (*planned_[i])[row] == 0;
    if (has_forces()) sample.force[leg] = vector(forces_, 3 * i);
    if (!points_.empty()) sample.p_WP[leg] = vector(points_, 3 * i);
  }
  return sample;
}

}  // namespace

const std::vector<double>* RecordedRun::column(std::string_view its_name) const noexcept {
  for (const Column& one : columns) {
    if (one.name == its_name) return &one.values;
  }
  return nullptr;
}

std::vector<double> RecordedRun::times() const {
  std::vector<double> all;
  all.reserve(samples.size());
  for (const TraceSample& sample : samples) all.push_back(sample.state.time);
  return all;
}

RecordedRun recorded_run(std::string name, const TraceTable& table, const RobotDescription& robot) {
  const ColumnReader reader(table, robot);
  RecordedRun run{std::move(name), "", {}};
  run.force_directions = reader.has_forces();
  run.samples.reserve(table.rows());
  for (std::size_t row = 0; row < table.rows(); ++row) {
    run.samples.push_back(reader.sample(row));
    const double norm = run.samples.back().state.q_WB.norm();
    if (!(std::abs(norm - 1) < 1e-3)) {  // what more than three digits of a file would round to
      throw ConfigError(table.path(), fmt::format("q_WB at {} s", table.time()[row]), "a unit quaternion",
                        fmt::format("one of length {:g}", norm));
    }
  }
  for (const std::string& column : table.names()) {
    if (column.starts_with(kParameterColumn) || column.starts_with(kRewardColumn))
      run.columns.push_back({column, table.column(column)});
  }
  return run;
}

}  // namespace crossgait
