#include "report/recorded_run.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait {

void RunRecorder::begin(const TraceSample& first) {
  columns_.emplace(*robot_, first);
  names_ = columns_->names();
  for (const Leg leg : kLegs) {
    for (const char axis : {'x', 'y', 'z'}) names_.push_back(fmt::format("force.{}.{}", name(leg), axis));
  }
  for (int i = 0; i < robot_->joint_count(); ++i) names_.push_back("torque." + robot_->joint(i).name);
  names_.insert(names_.end(), more_.begin(), more_.end());
  values_.resize(names_.size());
}

void RunRecorder::add(const TraceSample& sample, std::span<const double> more) {
  if (!columns_) begin(sample);
  if (values_.front().size() == kMaxPageSteps)
    throw ConfigError("report", "walk", fmt::format("at most {} control steps", kMaxPageSteps), "more");
  row_.clear();
  columns_->append(sample, row_);
  for (const Leg leg : kLegs) row_.insert(row_.end(), sample.force[leg].data(), sample.force[leg].data() + 3);
  row_.insert(row_.end(), sample.torques.data(), sample.torques.data() + sample.torques.size());
  row_.insert(row_.end(), more.begin(), more.end());
  for (std::size_t i = 0; i < row_.size(); ++i) values_[i].push_back(row_[i]);
}

TraceTable RunRecorder::take(const std::string& source) {
  return {source, std::move(names_), std::move(values_)};
}

std::vector<SampleReader::Column> SampleReader::columns(const std::string& prefix,
                                                        std::string_view axes) const {
  std::vector<Column> found;
  for (const char axis : axes) found.push_back(&trace_.column(fmt::format("{}.{}", prefix, axis)));
  return found;
}

SampleReader::SampleReader(const TraceTable& trace, const RobotDescription& robot) : trace_(trace) {
  position_ = columns("p_WB", "xyz");
  orientation_ = columns("q_WB", "wxyz");
  velocity_ = columns("v_WB", "xyz");
  turning_ = columns("w_WB", "xyz");
  for (int i = 0; i < robot.joint_count(); ++i) angles_.push_back(&trace.column("q." + robot.joint(i).name));
  for (const Leg leg : kLegs) {
    loads_.push_back(&trace.column(fmt::format("load.{}", name(leg))));
    contacts_.push_back(&trace.column(fmt::format("contact.{}", name(leg))));
    const std::string force = fmt::format("force.{}", name(leg));
    if (!trace.has(force + ".x")) continue;
    for (const Column column : columns(force, "xyz")) forces_.push_back(column);
  }
  for (std::size_t row = 0; row < trace.rows(); ++row) {
    const double norm = at(row).state.q_WB.norm();
    if (!(std::abs(norm - 1) < 1e-3)) {  // what more than three digits of a file would round to
      throw ConfigError(trace.path(), fmt::format("q_WB at {} s", trace.time()[row]), "a unit quaternion",
                        fmt::format("one of length {:g}", norm));
    }
  }
}

TraceSample SampleReader::at(std::size_t row) const {
  const auto vector = [row](const std::vector<Column>& c, std::size_t first = 0) {
    return Vector3((*c[first])[row], (*c[first + 1])[row], (*c[first + 2])[row]);
  };
  TraceSample sample;
  RobotState& state = sample.state;
  state.time = trace_.time()[row];
  state.p_WB = vector(position_);
  state.q_WB = Quaternion((*orientation_[0])[row], (*orientation_[1])[row], (*orientation_[2])[row],
                          (*orientation_[3])[row]);
  state.v_WB = vector(velocity_);
  state.w_WB = vector(turning_);
  state.q.resize(static_cast<Eigen::Index>(angles_.size()));
  for (std::size_t i = 0; i < angles_.size(); ++i) state.q[static_cast<Eigen::Index>(i)] = (*angles_[i])[row];
  for (const Leg leg : kLegs) {
    sample.load[leg] = (*loads_[index(leg)])[row];
    sample.contact[leg] = (*contacts_[index(leg)])[row] != 0;
    if (has_forces()) sample.force[leg] = vector(forces_, 3 * index(leg));
  }
  return sample;
}

}  // namespace crossgait
