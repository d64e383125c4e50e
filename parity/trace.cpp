#include "crossgait/parity/trace.h"

#include <iterator>
#include <utility>

#include <fmt/format.h>

namespace crossgait {
namespace {

std::string header(const RobotDescription& robot, bool planned, bool parameters) {
  std::string line =
      "time,p_WB.x,p_WB.y,p_WB.z,q_WB.w,q_WB.x,q_WB.y,q_WB.z,v_WB.x,v_WB.y,v_WB.z,w_WB.x,w_WB.y,w_WB.z";
  for (int i = 0; i < robot.joint_count(); ++i) line += ",q." + robot.joint(i).name;
  for (const int i : robot.actuated_joints()) line += ",target." + robot.joint(i).name;
  for (const Leg leg : kLegs) line += fmt::format(",contact.{}", name(leg));
  for (const Leg leg : kLegs) line += fmt::format(",load.{}", name(leg));
  for (const Leg leg : kLegs) {
    if (planned) line += fmt::format(",planned.{}", name(leg));
  }
  for (const ParameterRow& row : gait_parameters()) {
    if (parameters) line += fmt::format(",param.{}", row.name);
  }
  return line + "\n";
}

}  // namespace

TraceSample::TraceSample(const PhysicsBackend& world, const ControlTargets& control)
    : state(world.state()), targets(control.joints), plan(control.plan), parameters(control.parameters) {
  const LegArray<FootContact> feet = world.foot_contacts();
  for (const Leg leg : kLegs) {
    contact[leg] = feet[leg].touching;
    load[leg] = feet[leg].force.norm();
  }
}

TraceWriter::TraceWriter(std::shared_ptr<const RobotDescription> robot, const std::string& path)
    : robot_(std::move(robot)), file_(path) {}

void TraceWriter::begin(bool planned, bool parameters) {
  begun_ = true;
  planned_ = planned;
  parameters_ = parameters;
  file_.write(header(*robot_, planned, parameters));
}

void TraceWriter::add(const TraceSample& sample) {
  if (!begun_) begin(sample.plan.has_value(), sample.parameters.has_value());
  row_.clear();
  const auto out = std::back_inserter(row_);
  const auto put = [&out](double value) { fmt::format_to(out, ",{:.17g}", value); };
  const auto put_all = [&put](const auto& values) {
    for (Eigen::Index i = 0; i < values.size(); ++i) put(values[i]);
  };
  const RobotState& s = sample.state;
  fmt::format_to(out, "{:.17g}", s.time);
  put_all(s.p_WB);
  for (const double value : {s.q_WB.w(), s.q_WB.x(), s.q_WB.y(), s.q_WB.z()}) put(value);
  put_all(s.v_WB);
  put_all(s.w_WB);
  put_all(s.q);
  put_all(sample.targets.q);
  for (const Leg leg : kLegs) fmt::format_to(out, ",{}", sample.contact[leg] ? 1 : 0);
  for (const Leg leg : kLegs) put(sample.load[leg]);
  for (const Leg leg : kLegs) {
    if (planned_) fmt::format_to(out, ",{}", sample.plan && (*sample.plan)[leg].swing ? 0 : 1);
  }
  for (const ParameterRow& row : gait_parameters()) {
    if (parameters_) put(sample.parameters.value_or(GaitParameters{}).*row.member);
  }
  row_ += '\n';
  file_.write(row_);
}

void TraceWriter::finish() {
  if (!begun_) begin(false, false);
  file_.commit();
}

}  // namespace crossgait
