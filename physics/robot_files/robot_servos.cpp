#include "physics/robot_files/robot_servos.h"

#include <algorithm>

#include <fmt/format.h>

#include "physics/robot/joint_numbers.h"

namespace crossgait {
namespace {

Joint& joint_of(RobotDescription& robot, int i) {
  return robot.bodies[static_cast<std::size_t>(i) + 1].joint;
}

/// Those of the numbers of one kind that are there.
void read_numbers(const YamlValue& values, JointNumberOf of, Joint& joint) {
  for (const JointNumber& number : kJointNumbers) {
    if (number.of != of) continue;
    if (const auto value = values.find(number.name)) joint.*number.member = value->number();
  }
}

void read_exception(const std::string& name, const YamlValue& values, RobotDescription& robot) {
  using enum JointNumberOf;
  int i = 0;
  while (i < robot.joint_count() && robot.joint(i).name != name) ++i;
  if (i == robot.joint_count()) values.fail("a moving joint of the robot's file", fmt::format("'{}'", name));
  Joint& target = joint_of(robot, i);
  values.allow_keys(target.actuated ? joint_number_names({kJoint, kServo, kDrive})
                                    : joint_number_names({kJoint}));
  for (const JointNumberOf of : {kJoint, kServo, kDrive}) read_numbers(values, of, target);
}

/// Torque limits of servos for which no robot.yaml speaks. @returns those whose file says nothing real
std::vector<std::string> fill_efforts(const ServoRule& rule, const std::set<int>& unknown,
                                      RobotDescription& robot) {
  std::vector<std::string> filled;
  for (const LegModel& leg : *robot.legs) {
    for (const int i : leg.servos) {
      Joint& joint = joint_of(robot, i);
      if (unknown.count(i) == 0 && joint.effort_limit < rule.largest_real_effort) continue;
      filled.push_back(joint.name);
      joint.effort_limit = rule.effort_limit;
    }
  }
  return filled;
}

void infer_gains(const ServoRule& rule, const std::set<int>& unknown, RobotDescription& robot,
                 std::vector<Inference>& inferred) {
  std::vector<std::string> of_file, undamped, of_rule;
  for (const LegModel& leg : *robot.legs) {
    for (const int i : leg.servos) {
      Joint& joint = joint_of(robot, i);
      (joint.kp > 0 ? of_file : of_rule).push_back(joint.name);
      if (joint.kp > 0 && joint.kd == 0 && joint.damping == 0) undamped.push_back(joint.name);
      if (joint.kp > 0 && (joint.kd > 0 || joint.damping > 0)) continue;
      // A stiffness of the file is damped as the rule's would be.
      joint.kd = joint.kp > 0 ? rule.kd * joint.kp / rule.kp : rule.kd;
      if (joint.kp == 0) joint.kp = rule.kp;
    }
  }
  if (!of_file.empty()) {
    const Joint& first = joint_of(robot, (*robot.legs)[Leg::FL].servos.front());
    inferred.push_back(
        {"servo",
         fmt::format("{} joints from '{}', whose kp is {:.3g} N m/rad and kd {:.3g} N m s/rad",
                     of_file.size(), of_file.front(), first.kp, first.kd),
         undamped.empty()
             ? "the file's position actuators; what damps them is theirs or the joints'"
             : fmt::format(
                   "the file's position actuators; nothing damps {} of them from '{}': damping ratio .3 "
                   "of a leg that gives way by .03 h",
                   undamped.size(), undamped.front())});
  }
  if (!of_rule.empty()) {
    inferred.push_back({"servo", fmt::format("kp {:.3g} N m/rad, kd {:.3g} N m s/rad", rule.kp, rule.kd),
                        "kp = 3 m g h; damping ratio .3 of a leg that gives way by .03 h"});
  }
  const std::vector<std::string> filled = fill_efforts(rule, unknown, robot);
  if (filled.empty()) return;
  inferred.push_back(
      {"effort",
       fmt::format("{:.3g} N m, of {} joints from '{}'", rule.effort_limit, filled.size(), filled.front()),
       fmt::format(".8 m g h where the file says nothing between 0 and {:.3g} N m (3 m g times the leg)",
                   rule.largest_real_effort)});
}

void set_armatures(const std::optional<YamlValue>& given, const ServoRule& rule, RobotDescription& robot,
                   std::vector<Inference>& inferred) {
  int of_rule = 0;
  for (int i = 0; i < robot.joint_count(); ++i) {
    double& armature = joint_of(robot, i).armature;
    if (given) armature = given->number();
    if (given || armature > 0) continue;
    armature = rule.armature;
    ++of_rule;
  }
  if (of_rule == 0) return;
  inferred.push_back({"armature", fmt::format("{:.3g} kg m^2", rule.armature),
                      of_rule == robot.joint_count()
                          ? ".005 m h^2, of every joint"
                          : fmt::format(".005 m h^2, of {} of whose the file says nothing", of_rule)});
}

void read_gains(const YamlValue& servo, const std::set<int>& unknown, RobotDescription& robot) {
  servo.allow_keys(joint_number_names({JointNumberOf::kServo}));
  for (const char* required : {"kp", "kd"})
    static_cast<void>(servo.at(required));  // throws if it is not there
  for (const LegModel& leg : *robot.legs) {
    for (const int i : leg.servos) {
      Joint& joint = joint_of(robot, i);
      if (unknown.count(i) > 0) joint.effort_limit = 0;  // refused by name unless it is said here
      read_numbers(servo, JointNumberOf::kServo, joint);
    }
  }
}

}  // namespace

void read_servos(const std::optional<YamlValue>& yaml, const std::set<int>& unknown_effort,
                 RobotDescription& robot, std::vector<Inference>& inferred) {
  const auto find = [&yaml](std::string_view key) { return yaml ? yaml->find(key) : std::nullopt; };
  const ServoRule rule =
      servo_rule(robot.total_mass(), robot.standing_height, robot.standing_height / kStandingShare);
  set_armatures(find("armature"), rule, robot, inferred);
  if (const auto servo = find("servo")) {
    read_gains(*servo, unknown_effort, robot);
  } else {
    infer_gains(rule, unknown_effort, robot, inferred);
  }
  if (const auto drive = find("drive")) {
    drive->allow_keys(joint_number_names({JointNumberOf::kDrive}));
    for (const int i : robot.actuated_joints())
      read_numbers(*drive, JointNumberOf::kDrive, joint_of(robot, i));
  }
  if (const auto exceptions = find("joints")) {
    for (const auto& [name, values] : exceptions->entries()) read_exception(name, values, robot);
  }
}

}  // namespace crossgait
