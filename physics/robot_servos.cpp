#include "crossgait/physics/robot_servos.h"

#include <algorithm>

#include <fmt/format.h>

namespace crossgait {
namespace {

Joint& joint_of(RobotDescription& robot, int i) {
  return robot.bodies[static_cast<std::size_t>(i) + 1].joint;
}

void read_exception(const std::string& name, const YamlValue& values, RobotDescription& robot) {
  const auto body = std::find_if(robot.bodies.begin() + 1, robot.bodies.end(),
                                 [&name](const Body& b) { return b.joint.name == name; });
  if (body == robot.bodies.end()) values.fail("a moving joint of the URDF", fmt::format("'{}'", name));
  Joint& target = body->joint;
  if (target.actuated) {
    values.allow_keys({"armature", "damping", "friction", "kp", "kd", "effort"});
  } else {
    values.allow_keys({"armature", "damping", "friction"});
  }
  for (const auto& [key, member] : {std::pair{"armature", &target.armature},
                                    {"damping", &target.damping},
                                    {"friction", &target.friction},
                                    {"kp", &target.kp},
                                    {"kd", &target.kd},
                                    {"effort", &target.effort_limit}}) {
    if (const auto value = values.find(key)) *member = value->number();
  }
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
  for (const LegModel& leg : *robot.legs) {
    for (const int i : leg.servos) {
      joint_of(robot, i).kp = rule.kp;
      joint_of(robot, i).kd = rule.kd;
    }
  }
  inferred.push_back({"servo", fmt::format("kp {:.3g} N m/rad, kd {:.3g} N m s/rad", rule.kp, rule.kd),
                      "kp = 3 m g h; damping ratio .3 of a leg that gives way by .03 h"});
  const std::vector<std::string> filled = fill_efforts(rule, unknown, robot);
  if (filled.empty()) return;
  inferred.push_back(
      {"effort",
       fmt::format("{:.3g} N m, of {} joints from '{}'", rule.effort_limit, filled.size(), filled.front()),
       fmt::format(".8 m g h where the file says nothing between 0 and {:.3g} N m (3 m g times the leg)",
                   rule.largest_real_effort)});
}

void read_gains(const YamlValue& servo, const std::set<int>& unknown, RobotDescription& robot) {
  servo.allow_keys({"kp", "kd", "effort"});
  const auto effort = servo.find("effort");
  for (const LegModel& leg : *robot.legs) {
    for (const int i : leg.servos) {
      Joint& joint = joint_of(robot, i);
      joint.kp = servo.at("kp").number();
      joint.kd = servo.at("kd").number();
      if (unknown.count(i) > 0) joint.effort_limit = 0;  // refused by name unless it is said here
      if (effort) joint.effort_limit = effort->number();
    }
  }
}

}  // namespace

void read_servos(const std::optional<YamlValue>& yaml, const std::set<int>& unknown_effort,
                 RobotDescription& robot, std::vector<Inference>& inferred) {
  const auto find = [&yaml](std::string_view key) { return yaml ? yaml->find(key) : std::nullopt; };
  const ServoRule rule =
      servo_rule(robot.total_mass(), robot.standing_height, robot.standing_height / kStandingShare);
  const auto armature = find("armature");
  for (int i = 0; i < robot.joint_count(); ++i)
    joint_of(robot, i).armature = armature ? armature->number() : rule.armature;
  if (!armature)
    inferred.push_back(
        {"armature", fmt::format("{:.3g} kg m^2", rule.armature), ".005 m h^2, of every joint"});
  if (const auto servo = find("servo")) {
    read_gains(*servo, unknown_effort, robot);
  } else {
    infer_gains(rule, unknown_effort, robot, inferred);
  }
  if (const auto exceptions = find("joints")) {
    for (const auto& [name, values] : exceptions->entries()) read_exception(name, values, robot);
  }
}

}  // namespace crossgait
