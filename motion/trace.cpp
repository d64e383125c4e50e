#include "motion/trace.h"

#include <iterator>
#include <numeric>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/error.h"

namespace crossgait {
TraceSample::TraceSample(const PhysicsBackend& world, const ControlTargets& control)
    : state(world.state()),
      targets(control.joints),
      torques(world.torques()),
      contact_schedule(control.contact_schedule),
      parameters(control.parameters) {
  const LegArray<FootContact> feet = world.foot_contacts();
  for (const Leg leg : kLegs) {
    contact[leg] = feet[leg].touching;
    load[leg] = feet[leg].force.norm();
    force[leg] = feet[leg].force;
    if (feet[leg].touching) p_WP[leg] = feet[leg].p_WP;
  }
}

TraceColumns::TraceColumns(const RobotDescription& robot, const TraceSample& first)
    : torques_(first.torques.size() == robot.joint_count()),
      planned_(first.contact_schedule.has_value()),
      parameters_(first.parameters.has_value()),
      names_{"time",   "p_WB.x", "p_WB.y", "p_WB.z", "q_WB.w", "q_WB.x", "q_WB.y",
             "q_WB.z", "v_WB.x", "v_WB.y", "v_WB.z", "w_WB.x", "w_WB.y", "w_WB.z"} {
  const auto add_joints = [&](std::string_view what, const std::vector<int>& joints) {
    for (const int i : joints) names_.push_back(fmt::format("{}.{}", what, robot.joint(i).name));
  };
  const auto add_points = [&](std::string_view what) {
    for (const Leg leg : kLegs) {
      for (const char axis : {'x', 'y', 'z'})
        names_.push_back(fmt::format("{}.{}.{}", what, name(leg), axis));
    }
  };
  std::vector<int> joints(static_cast<std::size_t>(robot.joint_count()));
  std::iota(joints.begin(), joints.end(), 0);
  add_joints("q", joints);
  add_joints("qd", joints);
  add_joints("target", robot.actuated_joints());
  if (torques_) add_joints("torque", joints);
  for (const Leg leg : kLegs) names_.push_back(fmt::format("contact.{}", name(leg)));
  for (const Leg leg : kLegs) names_.push_back(fmt::format("load.{}", name(leg)));
  add_points("force");
  add_points("p_WP");
  for (const Leg leg : kLegs) {
    if (planned_) names_.push_back(fmt::format("planned.{}", name(leg)));
  }
  for (const ParameterRow& row : gait_parameters()) {
    if (parameters_) names_.push_back(fmt::format("param.{}", row.name));
  }
}

void TraceColumns::append(const TraceSample& sample, std::vector<double>& numbers) const {
  const auto put_all = [&numbers](const auto& values) {
    numbers.insert(numbers.end(), values.data(), values.data() + values.size());
  };
  const RobotState& s = sample.state;
  numbers.push_back(s.time);
  put_all(s.p_WB);
  for (const double value : {s.q_WB.w(), s.q_WB.x(), s.q_WB.y(), s.q_WB.z()}) numbers.push_back(value);
  put_all(s.v_WB);
  put_all(s.w_WB);
  put_all(s.q);
  put_all(s.qd);
  put_all(sample.targets.q);
  if (torques_) put_all(sample.torques);
  for (const Leg leg : kLegs) numbers.push_back(sample.contact[leg] ? 1 : 0);
  for (const Leg leg : kLegs) numbers.push_back(sample.load[leg]);
  for (const Leg leg : kLegs) put_all(sample.force[leg]);
  for (const Leg leg : kLegs) put_all(sample.p_WP[leg]);
  for (const Leg leg : kLegs) {
    if (planned_) numbers.push_back(sample.contact_schedule && (*sample.contact_schedule)[leg].swing ? 0 : 1);
  }
  for (const ParameterRow& row : gait_parameters()) {
    if (parameters_) numbers.push_back(sample.parameters.value_or(GaitParameters{}).*row.member);
  }
}

void TraceRecorder::add(const TraceSample& sample) {
  if (samples_.size() == most_)
    throw ConfigError("trace", "walk", fmt::format("at most {} control steps", most_), "more");
  samples_.push_back(sample);
}

Trace TraceRecorder::take() { return std::exchange(samples_, {}); }

TraceWriter::TraceWriter(std::shared_ptr<const RobotDescription> robot, const std::string& path)
    : robot_(std::move(robot)), file_(path) {}

void TraceWriter::begin(const TraceSample& first) {
  columns_.emplace(*robot_, first);
  file_.write(fmt::format("{}\n", fmt::join(columns_->names(), ",")));
}

void TraceWriter::add(const TraceSample& sample) {
  if (!columns_) begin(sample);
  numbers_.clear();
  columns_->append(sample, numbers_);
  row_.clear();
  fmt::format_to(std::back_inserter(row_), "{:.17g}\n", fmt::join(numbers_, ","));
  file_.write(row_);
}

void TraceWriter::finish() {
  if (!columns_) begin({});
  file_.commit();
}

}  // namespace crossgait
