// A trace's file becomes the samples that were written.
#include "report/recorded_run.h"

#include <memory>

#include <gtest/gtest.h>

#include "physics/robot_files/data_path.h"
#include "scenes/robots.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"

namespace crossgait {
namespace {

class RunsOfFiles : public ScratchFolder {
 protected:
  /// Every number another one.
  TraceSample numbered(double time) const {
    TraceSample s;
    s.state.time = time;
    s.state.p_WB = {1, 2, 3};
    s.state.q_WB = Quaternion(0.1, 0.7, -0.5, 0.5);  // of length 1
    s.state.v_WB = {4, 5, 6};
    s.state.w_WB = {7, 8, 9};
    s.state.q = JointVector::LinSpaced(robot_->joint_count(), 10, 11);
    s.state.qd = JointVector::LinSpaced(robot_->joint_count(), 20, 21);
    s.torques = JointVector::LinSpaced(robot_->joint_count(), 22, 23);
    s.targets.q = JointVector::LinSpaced(static_cast<Eigen::Index>(robot_->actuated_joints().size()), 12, 13);
    s.contact[Leg::FR] = s.contact[Leg::RR] = true;
    s.load = {{14, 15, 16, 17}};
    for (const Leg leg : kLegs) {
      const auto i = static_cast<double>(index(leg));
      s.force[leg] = Vector3(30, 31, 32) + Vector3::Constant(i);
      s.p_WP[leg] = Vector3(40, 41, 42) + Vector3::Constant(i);
    }
    s.contact_schedule.emplace();
    (*s.contact_schedule)[Leg::FL].swing = (*s.contact_schedule)[Leg::RR].swing = true;
    s.parameters.emplace().cycle_time = time;
    return s;
  }
  RecordedRun written_and_read(const Trace& trace) const {
    TraceWriter writer(robot_, path("walk.csv"));
    for (const TraceSample& sample : trace) writer.add(sample);
    writer.finish();
    return recorded_run("walk", TraceTable(path("walk.csv")), *robot_);
  }

  const std::shared_ptr<const RobotDescription> robot_ = scenes::quadruped();
};

TEST_F(RunsOfFiles, AreTheSamplesThatWereWritten) {
  const Trace trace{numbered(0.5), numbered(0.75)};
  const RecordedRun run = written_and_read(trace);
  EXPECT_EQ(run.name, "walk");
  EXPECT_TRUE(run.force_directions);
  EXPECT_EQ(run.times(), (std::vector<double>{0.5, 0.75}));
  for (std::size_t i = 0; i < trace.size(); ++i) {
    const TraceSample &a = run.samples.at(i), &b = trace[i];
    EXPECT_EQ(a.state.p_WB, b.state.p_WB);
    EXPECT_EQ(a.state.q_WB.coeffs(), b.state.q_WB.coeffs());
    EXPECT_EQ(a.state.v_WB, b.state.v_WB);
    EXPECT_EQ(a.state.w_WB, b.state.w_WB);
    EXPECT_EQ(a.state.q, b.state.q);
    EXPECT_EQ(a.state.qd, b.state.qd);
    EXPECT_EQ(a.targets.q, b.targets.q);
    EXPECT_EQ(a.torques, b.torques);
    for (const Leg leg : kLegs) {
      EXPECT_EQ(a.contact[leg], b.contact[leg]);
      EXPECT_EQ(a.load[leg], b.load[leg]);
      EXPECT_EQ(a.force[leg], b.force[leg]);
      EXPECT_EQ(a.p_WP[leg], b.p_WP[leg]);
      EXPECT_EQ((*a.contact_schedule)[leg].swing, (*b.contact_schedule)[leg].swing);
    }
  }
  ASSERT_NE(run.column("param.cycle_time"), nullptr);
  EXPECT_EQ(*run.column("param.cycle_time"), run.times());
  EXPECT_EQ(run.column("param.boldness"), nullptr);
}

TEST_F(RunsOfFiles, KnowDirectionsAndTorquesOfAFileThatHasThem) {
  std::string header =
      "time,p_WB.x,p_WB.y,p_WB.z,q_WB.w,q_WB.x,q_WB.y,q_WB.z,v_WB.x,v_WB.y,v_WB.z,w_WB.x,w_WB.y,w_WB.z";
  std::string row = "0,0,0,0,1,0,0,0,0,0,0,0,0,0";
  const auto add = [&](const std::string& name, double value) {
    header += "," + name;
    row += "," + std::to_string(value);
  };
  for (int i = 0; i < robot_->joint_count(); ++i) add("q." + robot_->joint(i).name, 0);
  for (int i = 0; i < robot_->joint_count(); ++i) add("torque." + robot_->joint(i).name, i);
  for (const Leg leg : kLegs) {
    const std::string of(name(leg));
    add("load." + of, 5);
    add("contact." + of, 1);
    for (const char* axis : {"x", "y", "z"}) add("force." + of + "." + axis, axis[0] == 'y' ? 3 : 4);
  }
  const RecordedRun run =
      recorded_run("other", TraceTable(write("other.csv", header + "\n" + row + "\n")), *robot_);
  EXPECT_TRUE(run.force_directions);
  EXPECT_EQ(run.samples.front().force[Leg::RL], Vector3(4, 3, 4));
  ASSERT_EQ(run.samples.front().torques.size(), robot_->joint_count());
  EXPECT_EQ(run.samples.front().torques[2], 2);
  EXPECT_EQ(run.samples.front().targets.q.size(), 0);
  EXPECT_FALSE(run.samples.front().contact_schedule.has_value());
}

TEST_F(RunsOfFiles, AreRefusedForAnotherRobot) {
  TraceWriter writer(robot_, path("walk.csv"));
  writer.add(numbered(0));
  writer.finish();
  const RobotDescription other = load_robot(find_robot("serial_quadruped"));
  const ConfigError error = config_error([&] { recorded_run("walk", TraceTable(path("walk.csv")), other); });
  EXPECT_NE(std::string(error.what()).find("q."), std::string::npos) << error.what();
}

TEST_F(RunsOfFiles, AreRefusedWithAnOrientationThatIsNone) {
  Trace trace{numbered(0), numbered(0.002)};
  trace.back().state.q_WB.w() = 0.7;
  const ConfigError error = config_error([&] { written_and_read(trace); });
  EXPECT_EQ(error.source(), path("walk.csv"));
  EXPECT_NE(error.element().find("0.002"), std::string::npos) << error.what();
}

}  // namespace
}  // namespace crossgait
