#include "physics/robot_files/robot_servos.h"

#include <algorithm>

#include <fmt/format.h>

#include "physics/robot/joint_numbers.h"
#include "physics/robot_files/servo_law.h"

namespace crossgait {
namespace {

Joint& joint_of(RobotDescription& robot, int i) {
  return robot.bodies[static_cast<std::size_t>(i) + 1].joint;
}

constexpr const char* kOfYaml = "the robot.yaml";

/// A law by its name, in the place of its numbers.
void read_law(const YamlValue& values, Joint& joint, RobotReport& report) {
  const auto law = values.find(kServoLawKey);
  if (!law) return;
  const ServoLaw& row = read_servo_law(values, *law);
  joint.implicit_stiffness = row.implicit_stiffness;
  joint.implicit_damping = row.implicit_damping;
  for (const char* number : {"implicit_stiffness", "implicit_damping"})
    report.reasons[joint.name][number] = kOfYaml;
}

/// Those of the numbers of one kind that are there.
void read_numbers(const YamlValue& values, JointNumberOf of, Joint& joint, RobotReport& report) {
  for (const JointNumber& number : kJointNumbers) {
    if (number.of != of) continue;
    const auto value = values.find(number.name);
    if (!value) continue;
    set_number(number, value->number(), joint);
    report.reasons[joint.name][std::string(number.name)] = kOfYaml;
  }
}

void read_exception(const std::string& name, const YamlValue& values, RobotDescription& robot,
                    RobotReport& report) {
  using enum JointNumberOf;
  int i = 0;
  while (i < robot.joint_count() && robot.joint(i).name != name) ++i;
  if (i == robot.joint_count()) values.fail("a moving joint of the robot's file", fmt::format("'{}'", name));
  Joint& target = joint_of(robot, i);
  std::vector<std::string_view> keys =
      target.actuated ? joint_number_names({kJoint, kServo, kDrive}) : joint_number_names({kJoint});
  if (target.actuated) keys.push_back(kServoLawKey);
  values.allow_keys(keys);
  for (const JointNumberOf of : {kJoint, kServo, kDrive}) read_numbers(values, of, target, report);
  read_law(values, target, report);
}

/// Names of joints, and a number that they share or the least and largest of it.
struct Group {
  std::vector<std::string> joints;
  double least = 0, most = 0;

  void add(const std::string& joint, double number) {
    least = joints.empty() ? number : std::min(least, number);
    most = joints.empty() ? number : std::max(most, number);
    joints.push_back(joint);
  }
  bool empty() const { return joints.empty(); }
  std::string of() const { return fmt::format("{} joint(s) from '{}'", joints.size(), joints.front()); }
  std::string numbers() const {
    return least == most ? fmt::format("{:.3g}", least) : fmt::format("{:.3g} to {:.3g}", least, most);
  }
};

constexpr const char* kEffortRule =
    ".8 m g h where the file says nothing between 0 and {:.3g} N m (3 m g times the leg)";

/// Torque limits of servos for which no robot.yaml speaks.
void fill_efforts(const ServoRule& rule, const std::set<int>& unknown, RobotDescription& robot,
                  RobotReport& report) {
  Group filled, overridden, unlimited;
  const std::string reason = fmt::format(fmt::runtime(kEffortRule), rule.largest_real_effort);
  for (const LegModel& leg : *robot.legs) {
    for (const int i : leg.servos) {
      Joint& joint = joint_of(robot, i);
      if (unknown.count(i) == 0 && joint.effort_limit < rule.largest_real_effort) continue;
      filled.add(joint.name, rule.effort_limit);
      if (unknown.count(i) == 0) overridden.add(joint.name, joint.effort_limit);
      if (unknown.count(i) != 0 && report.joints_of_file[joint.name].kp > 0)
        unlimited.add(joint.name, rule.effort_limit);
      joint.effort_limit = rule.effort_limit;
      joint.effort_negative = 0;
      report.reasons[joint.name]["effort"] = reason;
    }
  }
  if (filled.empty()) return;
  report.inferred.push_back(
      {"effort", fmt::format("{:.3g} N m, of {}", rule.effort_limit, filled.of()), reason});
  if (!unlimited.empty())
    report.warnings.push_back(fmt::format(
        "the file sets no limit to the torque of {}, whose kp it gives: {:.3g} N m is used (0.8 m g h)",
        unlimited.of(), rule.effort_limit));
  if (overridden.empty()) return;
  report.warnings.push_back(
      fmt::format("the file's torque limit of {} N m of {} is that of no servo of this "
                  "robot: {:.3g} N m is used (0.8 m g h)",
                  overridden.numbers(), overridden.of(), rule.effort_limit));
}

/// What stands and walks well is judged by: below this part of the rule's stiffness robots were seen to fall.
constexpr double kSoft = 0.4;

void warn_of_gains(const ServoRule& rule, const Group& of_file, const Group& of_rule, const Group& undamped,
                   const Group& soft, const Group& velocity, RobotReport& report) {
  if (!velocity.empty())
    report.warnings.push_back(
        fmt::format("the file gives kd {} N m s/rad and no kp for {}: kp {:.3g} N m/rad and kd {:.3g} N m "
                    "s/rad are used by rule",
                    velocity.numbers(), velocity.of(), rule.kp, rule.kd));
  if (!of_rule.empty() && !of_file.empty())
    report.warnings.push_back(fmt::format(
        "the file gives no kp for {}, beside kp {} N m/rad of {}: kp {:.3g} N m/rad and kd {:.3g} "
        "N m s/rad are used by rule",
        of_rule.of(), of_file.numbers(), of_file.of(), rule.kp, rule.kd));
  if (!undamped.empty())
    report.warnings.push_back(
        fmt::format("nothing in the file damps {} (kd 0, damping 0): kd {} N m s/rad is "
                    "used by rule",
                    undamped.of(), undamped.numbers()));
  if (!soft.empty())
    report.warnings.push_back(fmt::format(
        "the file's kp of {} N m/rad of {} is {:.2g} of the {:.3g} N m/rad that standing and walking "
        "take (3 m g h): the robot may sag or fall (`crossgait robots FILE --check --servos rule` "
        "tries the rule's)",
        soft.numbers(), soft.of(), soft.least / rule.kp, rule.kp));
}

void infer_gains(const ServoRule& rule, const std::set<int>& unknown, RobotDescription& robot,
                 RobotReport& report) {
  Group of_file, undamped, of_rule, soft, velocity;
  for (const LegModel& leg : *robot.legs) {
    for (const int i : leg.servos) {
      Joint& joint = joint_of(robot, i);
      const bool has_kp = joint.kp > 0, is_damped = joint.kd > 0 || joint.damping > 0;
      (has_kp ? of_file : of_rule).add(joint.name, has_kp ? joint.kp : rule.kp);
      if (has_kp && joint.kp < kSoft * rule.kp) soft.add(joint.name, joint.kp);
      if (has_kp && is_damped) continue;
      if (!has_kp && joint.kd > 0) velocity.add(joint.name, joint.kd);
      // A stiffness of the file is damped as the rule's would be.
      joint.kd = has_kp ? rule.kd * joint.kp / rule.kp : rule.kd;
      if (has_kp) undamped.add(joint.name, joint.kd);
      auto& reasons = report.reasons[joint.name];
      reasons["kd"] = "damping ratio 0.3 of a leg that gives way by 0.03 h";
      if (has_kp) continue;
      joint.kp = rule.kp;
      reasons["kp"] = "3 m g h";
    }
  }
  if (!of_file.empty()) {
    const Joint& first = joint_of(robot, (*robot.legs)[Leg::FL].servos.front());
    report.inferred.push_back(
        {"servo",
         fmt::format("{} joints from '{}', whose kp is {:.3g} N m/rad and kd {:.3g} N m s/rad",
                     of_file.joints.size(), of_file.joints.front(), first.kp, first.kd),
         undamped.empty()
             ? "the file's position actuators; what damps them is theirs or the joints'"
             : fmt::format(
                   "the file's position actuators; nothing damps {} of them from '{}': damping ratio 0.3 "
                   "of a leg that gives way by 0.03 h",
                   undamped.joints.size(), undamped.joints.front())});
  }
  if (!of_rule.empty()) {
    report.inferred.push_back({"servo",
                               fmt::format("kp {:.3g} N m/rad, kd {:.3g} N m s/rad", rule.kp, rule.kd),
                               "kp = 3 m g h; damping ratio 0.3 of a leg that gives way by 0.03 h"});
  }
  warn_of_gains(rule, of_file, of_rule, undamped, soft, velocity, report);
  fill_efforts(rule, unknown, robot, report);
}

/// Servos as if the file said nothing of them. Their torque limits stay the file's.
void forget_gains(RobotDescription& robot) {
  for (const LegModel& leg : *robot.legs) {
    for (const int i : leg.servos) {
      Joint& joint = joint_of(robot, i);
      joint.kp = joint.kd = joint.implicit_stiffness = joint.implicit_damping = 0;
    }
  }
}

void set_armatures(const std::optional<YamlValue>& given, const ServoRule& rule, RobotDescription& robot,
                   RobotReport& report) {
  int of_rule = 0;
  for (int i = 0; i < robot.joint_count(); ++i) {
    Joint& joint = joint_of(robot, i);
    // Rods and other joints without a motor have no rotor, and a file with gains is a whole machine.
    if (!given && (joint.armature > 0 || joint.kp > 0 || !joint.actuated)) continue;
    joint.armature = given ? given->number() : rule.armature;
    report.reasons[joint.name]["armature"] = given ? kOfYaml : ".005 m h^2";
    of_rule += given ? 0 : 1;
  }
  if (of_rule == 0) return;
  report.inferred.push_back(
      {"armature", fmt::format("{:.3g} kg m^2", rule.armature),
       of_rule == robot.joint_count()
           ? ".005 m h^2, of every joint"
           : fmt::format(".005 m h^2, of {} servos of which the file says nothing", of_rule)});
}

void read_gains(const YamlValue& servo, const std::set<int>& unknown, RobotDescription& robot,
                RobotReport& report) {
  std::vector<std::string_view> keys = joint_number_names({JointNumberOf::kServo});
  keys.push_back(kServoLawKey);
  servo.allow_keys(keys);
  for (const char* required : {"kp", "kd"})
    static_cast<void>(servo.at(required));  // throws if it is not there
  for (const LegModel& leg : *robot.legs) {
    for (const int i : leg.servos) {
      Joint& joint = joint_of(robot, i);
      if (unknown.count(i) > 0) joint.effort_limit = 0;  // refused by name unless it is said here
      read_numbers(servo, JointNumberOf::kServo, joint, report);
      read_law(servo, joint, report);
    }
  }
}

/// A home that no target reaches is left at once.
void warn_of_ranges(const RobotDescription& robot, RobotReport& report) {
  Group outside, ranges;
  for (const int i : robot.actuated_joints()) {
    const Joint& joint = robot.joint(i);
    if (robot.home[i] >= joint.target_lower && robot.home[i] <= joint.target_upper) continue;
    outside.add(joint.name, robot.home[i]);
    ranges.add(joint.name, joint.target_lower), ranges.add(joint.name, joint.target_upper);
  }
  if (outside.empty()) return;
  report.warnings.push_back(
      fmt::format("home angles of {} rad of {} are outside the {} rad to which the file's "
                  "actuators clip targets (ctrlrange): it does not stay there",
                  outside.numbers(), outside.of(), ranges.numbers()));
}

}  // namespace

void read_servos(const std::optional<YamlValue>& yaml, const std::set<int>& unknown_effort,
                 ServoSource source, RobotDescription& robot, RobotReport& report) {
  const auto find = [&yaml](std::string_view key) { return yaml ? yaml->find(key) : std::nullopt; };
  const ServoRule rule =
      servo_rule(robot.total_mass(), robot.standing_height, robot.standing_height / kStandingShare);
  set_armatures(find("armature"), rule, robot, report);
  const auto servo = find("servo");
  const bool says_rule = servo && !servo->is_mapping() && !servo->is_sequence() && servo->text() == "rule";
  const bool by_rule = says_rule || source == ServoSource::kRule;
  if (servo && !by_rule) {
    read_gains(*servo, unknown_effort, robot, report);
  } else {
    if (by_rule) forget_gains(robot);
    infer_gains(rule, unknown_effort, robot, report);
  }
  if (const auto drive = find("drive")) {
    drive->allow_keys(joint_number_names({JointNumberOf::kDrive}));
    for (const int i : robot.actuated_joints())
      read_numbers(*drive, JointNumberOf::kDrive, joint_of(robot, i), report);
  }
  if (const auto exceptions = find("joints")) {
    for (const auto& [name, values] : exceptions->entries()) read_exception(name, values, robot, report);
  }
  warn_of_ranges(robot, report);
}

}  // namespace crossgait
