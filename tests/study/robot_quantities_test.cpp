// What a robot's file says beside what is used.
#include "study/robot_quantities.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "physics/robot/joint_numbers.h"
#include "physics/robot_files/data_path.h"

namespace crossgait {
namespace {

LoadedRobot serial() { return load_robot_with_report(find_robot("serial_quadruped")); }

const RobotQuantity& find(const std::vector<RobotQuantity>& rows, const std::string& of,
                          const std::string& name) {
  const auto row = std::find_if(rows.begin(), rows.end(),
                                [&](const RobotQuantity& q) { return q.of == of && q.name == name; });
  if (row == rows.end()) throw std::runtime_error(of + " has no " + name);
  return *row;
}

bool any_holds(const std::vector<std::string>& warnings, const std::string& text) {
  return std::any_of(warnings.begin(), warnings.end(),
                     [&](const std::string& w) { return w.find(text) != std::string::npos; });
}

TEST(RobotQuantities, EveryNumberOfAServoIsARowWithWhatIsUsed) {
  const LoadedRobot loaded = serial();
  const std::vector<RobotQuantity> rows = robot_quantities(loaded, {});
  for (int i = 0; i < loaded.robot.joint_count(); ++i) {
    const Joint& joint = loaded.robot.joint(i);
    for (const JointNumber& number : kJointNumbers) {
      if (number.of != JointNumberOf::kServo || is_off_at_zero(number)) continue;
      const RobotQuantity& row = find(rows, joint.name, std::string(number.name));
      EXPECT_EQ(std::get<double>(row.used), joint.*number.member) << joint.name << " " << number.name;
      EXPECT_FALSE(row.why.empty());
    }
    // Of this URDF torque limits are its own, gains the rule's.
    const std::string& name = joint.name;
    EXPECT_TRUE(std::holds_alternative<std::monostate>(find(rows, name, "kp").file));
    EXPECT_EQ(find(rows, name, "kp").why, "3 m g h");
    EXPECT_EQ(std::get<double>(find(rows, name, "effort").file), joint.effort_limit);
    EXPECT_EQ(find(rows, name, "effort").why, "the file");
  }
}

TEST(RobotQuantities, SpeedsOfTheFileAreShownBesideWhatTakesTheirPlace) {
  LoadedRobot loaded = serial();
  const std::string name = loaded.robot.joint(0).name;
  const double limit = loaded.report.velocity_limits.at(name);
  EXPECT_GT(limit, 0);
  const auto row = [&] { return find(robot_quantities(loaded, {}), name, "velocity_limit"); };
  EXPECT_EQ(std::get<double>(row().file), limit);
  EXPECT_TRUE(std::holds_alternative<std::monostate>(row().used));
  EXPECT_TRUE(row().why.starts_with("not simulated"));
  loaded.robot.bodies[1].joint.no_load_speed = 20;
  EXPECT_EQ(std::get<double>(row().used), 20);
  loaded.report.velocity_limits.clear();
  EXPECT_THROW(row(), std::runtime_error);
}

TEST(RobotQuantities, NumbersOfJointsThatAreHeldAreShownAndSaidToBeNoPartOfIt) {
  LoadedRobot loaded = serial();
  Joint& wheel = loaded.report.joints_of_file["wheel"];
  wheel.effort_limit = 7, wheel.damping = 0.3;
  wheel.limited = true, wheel.lower = -1, wheel.upper = 2;
  loaded.report.locked = {{"wheel", 0.25}};
  const std::vector<RobotQuantity> rows = robot_quantities(loaded, {});
  EXPECT_EQ(std::get<double>(find(rows, "wheel", "angle").used), 0.25);
  for (const auto& [name, number] : {std::pair{"effort", 7.0}, {"damping", 0.3}}) {
    EXPECT_EQ(std::get<double>(find(rows, "wheel", name).file), number);
    EXPECT_TRUE(std::holds_alternative<std::monostate>(find(rows, "wheel", name).used));
  }
  EXPECT_EQ(std::get<std::vector<double>>(find(rows, "wheel", "limits").file), (std::vector<double>{-1, 2}));
  EXPECT_THROW(find(rows, "wheel", "kp"), std::runtime_error);
}

TEST(RobotQuantities, ContactThatTheFileSaysAndNothingSimulatesIsWarnedOfWithBothNumbers) {
  LoadedRobot loaded = serial();
  EXPECT_FALSE(any_holds(robot_warnings(loaded, {}), "not as the file says"));
  const LegModel& model = (*loaded.robot.legs)[Leg::FL];
  for (const Leg leg : kLegs) {
    const auto& body = loaded.robot.bodies[static_cast<std::size_t>((*loaded.robot.legs)[leg].foot_body)];
    ContactNumbers& numbers = loaded.report.contact.shapes[body.shapes.back().name];
    numbers.friction[0] = 0.8;
    numbers.stated.insert("friction");
  }
  ASSERT_GE(model.foot_body, 0);
  loaded.report.contact.impratio = 100;
  loaded.report.contact.cone = "elliptic";
  const std::vector<RobotQuantity> rows = robot_quantities(loaded, {});
  EXPECT_EQ(std::get<double>(find(rows, "foot FL", "friction").file), 0.8);
  EXPECT_EQ(std::get<double>(find(rows, "foot FL", "friction").used), WorldSpec().contact.friction);
  EXPECT_EQ(std::get<std::string>(find(rows, "world", "cone").file), "elliptic");
  const std::vector<std::string> warnings = robot_warnings(loaded, {});
  EXPECT_TRUE(any_holds(warnings, "friction 0.8 of the file's feet (0.6 is used)"));
  EXPECT_TRUE(any_holds(warnings, "impratio 100 of the file (1 is used)"));
  EXPECT_FALSE(any_holds(warnings, "cone"));
}

TEST(RobotQuantities, APyramidOfTheFileIsNoPyramidOfTheWorldAndSaid) {
  LoadedRobot loaded = serial();
  loaded.report.contact.has_mujoco_defaults = true;
  const auto cone = [&] { return find(robot_quantities(loaded, world_of(loaded)), "world", "cone"); };
  EXPECT_TRUE(std::holds_alternative<std::monostate>(cone().file));
  EXPECT_TRUE(cone().why.starts_with("MuJoCo's pyramids, its default, are of no other engine")) << cone().why;
  loaded.report.contact.cone = "pyramidal";
  EXPECT_EQ(std::get<std::string>(cone().used), "elliptic");
  EXPECT_TRUE(
      any_holds(robot_warnings(loaded, world_of(loaded)), "cone pyramidal of the file (elliptic is used)"));
}

TEST(RobotQuantities, SoftnessOfLoopsIsARow) {
  LoadedRobot loaded{load_robot(find_robot("scara_quadruped")), {}};
  const auto row = [&] { return find(robot_quantities(loaded, {}), "loops", "loop_solref"); };
  EXPECT_TRUE(std::holds_alternative<std::monostate>(row().file));
  loaded.report.loop_softness = loaded.robot.loop_softness;
  EXPECT_EQ(row().why, "the file");
  loaded.report.loop_softness->time_constant *= 2;
  EXPECT_EQ(row().why, "loop_softness of the robot.yaml");
}

TEST(RobotQuantities, WhatIsNotSimulatedIsARowWithoutAUsedNumber) {
  LoadedRobot loaded = serial();
  const std::string joint = loaded.robot.joint(0).name;
  loaded.report.unused = {{joint, "mechanicalReduction", "6.33", "", "not simulated: gears"},
                          {"link 'trunk'", "fdir1", "1 0 0", "", "not simulated: directions"}};
  const auto& body = loaded.robot.bodies[static_cast<std::size_t>((*loaded.robot.legs)[Leg::FL].foot_body)];
  ContactNumbers numbers;
  numbers.not_simulated["kp"] = {1e6, "a spring of ODE's"};
  for (const CollisionShape& shape : body.shapes) loaded.report.contact.shapes[shape.name] = numbers;
  const std::vector<RobotQuantity> rows = robot_quantities(loaded, {});
  const RobotQuantity& gear = find(rows, joint, "mechanicalReduction");
  EXPECT_EQ(std::get<double>(gear.file), 6.33);
  EXPECT_TRUE(std::holds_alternative<std::monostate>(gear.used));
  EXPECT_EQ(std::get<std::string>(find(rows, "link 'trunk'", "fdir1").file), "1 0 0");
  EXPECT_EQ(std::get<double>(find(rows, "foot FL", "kp").file), 1e6);
  EXPECT_EQ(find(rows, "foot FL", "kp").why, "not simulated: a spring of ODE's");
  EXPECT_TRUE(std::holds_alternative<std::monostate>(find(rows, "foot FL", "friction").file))
      << "no default of MuJoCo's in a file that is no MJCF";
  EXPECT_FALSE(any_holds(robot_warnings(loaded, {}), "not as the file says"));
}

TEST(RobotQuantities, SoftnessOfCouplingsIsTheFilesWhereItSaysIt) {
  LoadedRobot loaded = serial();
  const std::string follower = loaded.robot.joint(1).name;
  loaded.robot.couplings = {{.follower = 1, .leader = 0}};
  NamedCoupling coupling;
  coupling.follower = follower, coupling.leader = loaded.robot.joint(0).name, coupling.place = "mimic";
  const auto row = [&](const std::string& name) {
    loaded.report.couplings = {{follower, coupling}};
    return find(robot_quantities(loaded, {}), follower, name);
  };
  EXPECT_TRUE(std::holds_alternative<std::monostate>(row("follows").file)) << "a robot.yaml alone says it";
  loaded.report.couplings_of_file = {{follower, coupling}};
  EXPECT_EQ(std::get<std::string>(row("follows").file), coupling.leader);
  EXPECT_TRUE(std::holds_alternative<std::monostate>(row("coupling_solref").file));
  EXPECT_EQ(row("coupling_solref").why, "none is given");
  coupling.says_softness = true;
  loaded.report.couplings_of_file = {{follower, coupling}};
  EXPECT_EQ(std::get<std::vector<double>>(row("coupling_solref").file), (std::vector{0.005, 1.0}));
  EXPECT_EQ(row("coupling_solref").why, "mimic");
}

TEST(RobotQuantities, StepsThatAreTooLongForTheServosAreWarnedOf) {
  LoadedRobot loaded = serial();
  EXPECT_EQ(servo_loop_warning(loaded.robot, 1e-3), "");
  for (Body& body : loaded.robot.bodies) body.joint.kd = 50;
  EXPECT_NE(servo_loop_warning(loaded.robot, 5e-3).find("kd 50 + damping"), std::string::npos);
  // The file's step counts where it is longer.
  loaded.report.contact.timestep = 5e-3;
  EXPECT_TRUE(any_holds(robot_warnings(loaded, {}), "in steps of 0.005 s is"));
}

TEST(RobotQuantities, JsonHasNumbersListsWordsAndNulls) {
  const std::vector<RobotQuantity> rows{
      {"a", "kp", "N m/rad", {}, 2.0, "why"},
      {"a", "limits", "rad", std::vector<double>{-1, 1}, std::vector<double>{-1, 1}, "why"},
      {"world", "cone", "", std::string("pyramidal"), std::string("elliptic"), "why"}};
  EXPECT_EQ(to_json(rows).dump(),
            R"([{"of":"a","name":"kp","unit":"N m/rad","file":null,"used":2.0,"why":"why"},)"
            R"({"of":"a","name":"limits","unit":"rad","file":[-1.0,1.0],"used":[-1.0,1.0],"why":"why"},)"
            R"({"of":"world","name":"cone","unit":"","file":"pyramidal","used":"elliptic","why":"why"}])");
}

TEST(RobotQuantities, WhatIsAlikeIsOneRowOfTheTable) {
  std::vector<RobotQuantity> rows;
  for (const char* joint : {"a", "b", "c"}) rows.push_back({joint, "kp", "N m/rad", {}, 2.0, "why"});
  rows.push_back({"d", "kp", "N m/rad", 3.0, 3.0, "the file"});
  const std::string table = describe(rows);
  EXPECT_NE(table.find("a and 2 more"), std::string::npos) << table;
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 4) << table;
}

}  // namespace
}  // namespace crossgait
