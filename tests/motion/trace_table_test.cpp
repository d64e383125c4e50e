// Traces as files: what is written is read back, and what is no trace is refused by line and column.
#include "motion/trace_table.h"

#include <gtest/gtest.h>

#include "motion/trace.h"
#include "physics/core/error.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"

namespace crossgait {
namespace {

class TraceFiles : public ScratchFolder {
 protected:
  TraceTable table_of(const std::string& text) const { return TraceTable(write("trace.csv", text)); }
  std::string refusal(const std::string& text) const {
    const std::string file = write("trace.csv", text);
    const ConfigError error = config_error([&] { TraceTable table(file); });
    EXPECT_EQ(error.source(), file);
    return error.element() + ": expected " + error.expected() + ", found " + error.found();
  }
};

using Column = std::vector<double>;

TEST_F(TraceFiles, AreColumnsByName) {
  const TraceTable table = table_of("time,z,a\n0.5,1,-2e-3\n0.75,3,4\n");
  EXPECT_EQ(table.path(), path("trace.csv"));
  EXPECT_EQ(table.names(), (std::vector<std::string>{"time", "z", "a"}));
  EXPECT_EQ(table.rows(), 2U);
  EXPECT_EQ(table.time(), (Column{0.5, 0.75}));
  EXPECT_EQ(table.column("z"), (Column{1, 3}));
  EXPECT_EQ(table.column("a"), (Column{-2e-3, 4}));
  EXPECT_TRUE(table.has("a"));
  EXPECT_FALSE(table.has("b"));
  EXPECT_EQ(config_error([&] { static_cast<void>(table.column("b")); }).expected(),
            "a column \"b\", as `crossgait walk --trace` writes it");
}

TEST_F(TraceFiles, OfWindowsAndWithoutALastNewlineAreTheSame) {
  for (const char* text : {"a,time\r\n1,2\r\n3,4\r\n", "a,time\n1,2\n3,4",
                           "\xef\xbb\xbf"
                           "a,time\n1,2\n3,4\n"}) {
    const TraceTable table = table_of(text);
    EXPECT_EQ(table.column("a"), (Column{1, 3}));
    EXPECT_EQ(table.time(), (Column{2, 4}));
  }
}

TEST_F(TraceFiles, ThatAreNoneAreRefusedByLineAndColumn) {
  const std::string empty =
      "rows: expected a header and at least one row, as `crossgait walk --trace` writes them, found an empty "
      "trace";
  EXPECT_EQ(refusal(""), empty);
  EXPECT_EQ(refusal("time,a\n"), empty);
  EXPECT_EQ(refusal("time,a"), empty);
  EXPECT_EQ(
      refusal("t,a\n1,2\n"),
      "line 1: expected a column \"time\", as `crossgait walk --trace` writes it, found none of that name");
  EXPECT_EQ(refusal("time,a,b,a\n1,2,3,4\n"),
            "line 1, column 4: expected a name of its own, found \"a\" again");
  EXPECT_EQ(refusal("time,a\n1,2\n2\n"), "line 3: expected 2 cells, as the header has, found 1");
  EXPECT_EQ(refusal("time,a\n1,2,3\n"), "line 2: expected 2 cells, as the header has, found 3");
  EXPECT_EQ(refusal("time,a\n1,2\n\n2,3\n"), "line 3: expected 2 cells, as the header has, found 1");
  EXPECT_EQ(refusal("time\n1,2\n"), "line 2: expected 1 cell, as the header has, found 2");
  for (const char* cell : {"nan", "inf", "", "1x", "one"}) {
    EXPECT_EQ(refusal(std::string("time,a\n1,2\n2,") + cell + "\n"),
              std::string("line 3, column a: expected a finite number, found \"") + cell + "\"");
  }
  EXPECT_EQ(refusal("time,a\n1,2\n1,2\n"), "line 3, column time: expected a time after 1 s, found 1 s");
  EXPECT_EQ(refusal("time,a\n1,2\n2,2\n0.5,2\n"),
            "line 4, column time: expected a time after 2 s, found 0.5 s");
}

TEST_F(TraceFiles, TooWideAreRefused) {
  std::string header = "time";
  for (int i = 1; i < 4096; ++i) header += ",c" + std::to_string(i);
  std::string cells = "1";
  for (int i = 1; i < 4096; ++i) cells += ",0";
  EXPECT_EQ(table_of(header + "\n" + cells + "\n").names().size(), 4096U);
  EXPECT_EQ(refusal(header + ",one\n" + cells + ",0\n"), "line 1: expected at most 4096 columns, found 4097");
  EXPECT_TRUE(
      refusal("time," + std::string(1 << 20, 'a') + "\n1,2\n").starts_with("line 1: expected at most 1 MiB"));
  // 8 million cells, of which most need not be there to be counted.
  EXPECT_EQ(refusal(header + "\n" + std::string(2000, '\n')),
            "file: expected at most 8000000 cells, found 2002 lines of 4096");
}

// Two joints, the second of which has no servo.
std::shared_ptr<const RobotDescription> two_joints() {
  RobotDescription robot;
  robot.bodies.resize(3);
  robot.bodies[1].joint.name = "hip";
  robot.bodies[1].joint.actuated = true;
  robot.bodies[2].joint.name = "knee";
  robot.bodies[2].joint.actuated = false;
  return std::make_shared<const RobotDescription>(robot);
}

// Every number another one; a third in each needs all 17 digits.
TraceSample numbered(double time) {
  TraceSample s;
  const double third = 1.0 / 3;
  s.state.time = time;
  s.state.p_WB = {1 + third, 2 + third, 3 + third};
  s.state.q_WB = Quaternion(4 + third, 5 + third, 6 + third, 7 + third);
  s.state.v_WB = {8 + third, 9 + third, 10 + third};
  s.state.w_WB = {11 + third, 12 + third, 13 + third};
  s.state.q = JointVector::Zero(2);
  s.state.q << 14 + third, 15 + third;
  s.targets.q = JointVector::Constant(1, 16 + third);
  s.contact[Leg::FR] = s.contact[Leg::RR] = true;
  s.load = {{17 + third, 18 + third, 19 + third, 20 + third}};
  s.state.qd = JointVector::Zero(2);
  s.state.qd << 21 + third, 22 + third;
  for (const Leg leg : kLegs) {
    const double i = 3.0 * static_cast<double>(index(leg));
    s.force[leg] = {23 + i + third, 24 + i + third, 25 + i + third};
    s.p_WP[leg] = {35 + i + third, 36 + i + third, 37 + i + third};
  }
  return s;
}

TEST_F(TraceFiles, LoseNothing) {
  TraceSample first = numbered(0.1), second = numbered(0.2);
  first.contact_schedule.emplace();
  (*first.contact_schedule)[Leg::FL].swing = (*first.contact_schedule)[Leg::RR].swing = true;
  first.parameters.emplace();
  first.parameters->cycle_time = 1.0 / 7;
  first.torques = second.torques = JointVector::Constant(2, 1.0 / 9);
  TraceWriter writer(two_joints(), path("trace.csv"));
  writer.add(first);
  writer.add(second);  // knows neither plan nor parameters: all stand, and the defaults
  EXPECT_FALSE(std::filesystem::exists(path("trace.csv")));
  writer.finish();
  const TraceTable table(path("trace.csv"));
  // In the order of their numbers.
  const std::vector<std::string> base{"p_WB.x", "p_WB.y", "p_WB.z", "q_WB.w", "q_WB.x", "q_WB.y", "q_WB.z",
                                      "v_WB.x", "v_WB.y", "v_WB.z", "w_WB.x", "w_WB.y", "w_WB.z"};
  const auto of_feet = [](const std::string& what) {
    std::vector<std::string> columns;
    for (const char* leg : {"FL", "FR", "RL", "RR"}) {
      for (const char* axis : {"x", "y", "z"}) columns.push_back(what + "." + leg + "." + axis);
    }
    return columns;
  };
  const std::vector<std::string> forces = of_feet("force"), points = of_feet("p_WP");
  const std::vector<std::string> contacts{"contact.FL", "contact.FR", "contact.RL", "contact.RR"},
      loads{"load.FL", "load.FR", "load.RL", "load.RR"}, angles{"q.hip", "q.knee"},
      rates{"qd.hip", "qd.knee"}, targets{"target.hip"}, torques{"torque.hip", "torque.knee"},
      planned{"planned.FL", "planned.FR", "planned.RL", "planned.RR"};
  std::vector<std::string> names{"time"};
  for (const auto* group :
       {&base, &angles, &rates, &targets, &torques, &contacts, &loads, &forces, &points, &planned})
    names.insert(names.end(), group->begin(), group->end());
  for (const ParameterRow& row : gait_parameters()) names.push_back("param." + std::string(row.name));
  EXPECT_EQ(table.names(), names);
  EXPECT_EQ(table.time(), (Column{0.1, 0.2}));
  int number = 0;
  for (const auto* group : {&base, &angles, &targets, &loads, &rates, &forces, &points}) {
    for (const std::string& name : *group)
      EXPECT_EQ(table.column(name), Column(2, ++number + 1.0 / 3)) << name;
  }
  EXPECT_EQ(table.column("torque.knee"), Column(2, 1.0 / 9));
  EXPECT_EQ(table.column("contact.FL"), Column(2, 0));
  EXPECT_EQ(table.column("contact.FR"), Column(2, 1));
  EXPECT_EQ(table.column("contact.RL"), Column(2, 0));
  EXPECT_EQ(table.column("contact.RR"), Column(2, 1));
  EXPECT_EQ(table.column("planned.FL"), (Column{0, 1}));
  EXPECT_EQ(table.column("planned.FR"), (Column{1, 1}));
  EXPECT_EQ(table.column("planned.RR"), (Column{0, 1}));
  EXPECT_EQ(table.column("param.cycle_time"), (Column{1.0 / 7, GaitParameters{}.cycle_time}));
}

TEST(TracesInMemory, AreWhatWasAddedAndNoMoreThanAsked) {
  TraceRecorder recorder(2);
  recorder.add(numbered(1));
  recorder.add(numbered(2));
  EXPECT_NE(std::string(config_error([&] { recorder.add(numbered(3)); }).what()).find("at most 2"),
            std::string::npos);
  EXPECT_EQ(recorder.samples().size(), 2U);
  const Trace taken = recorder.take();
  ASSERT_EQ(taken.size(), 2U);
  EXPECT_EQ(taken.back().state.time, 2);
  EXPECT_TRUE(recorder.samples().empty());
}

TEST_F(TraceFiles, HaveNoColumnsForWhatIsNotKnown) {
  TraceWriter writer(two_joints(), path("plain.csv"));
  writer.add(numbered(1));
  writer.finish();
  const TraceTable table(path("plain.csv"));
  EXPECT_EQ(table.names().size(), 25U + 2 + 24);  // with velocities of joints, and forces and points of feet
  EXPECT_EQ(table.names().back(), "p_WP.RR.z");
  EXPECT_FALSE(table.has("torque.hip"));
  TraceWriter nothing(two_joints(), path("empty.csv"));
  nothing.finish();
  const std::string text = read(path("empty.csv"));
  EXPECT_TRUE(text.starts_with("time,p_WB.x,")) << text;
  EXPECT_TRUE(text.ends_with(",p_WP.RR.z\n")) << text;
}

}  // namespace
}  // namespace crossgait
