#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/yaml_reader.h"
#include "physics/robot/joint_numbers.h"
#include "physics/robot/robot_members.h"
#include "physics/robot_files/robot_contact.h"
#include "physics/robot_files/robot_formats.h"
#include "physics/robot_files/robot_report.h"

namespace crossgait {
namespace {

std::string yaml_vector(const Vector3& v) { return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z()); }

std::string yaml_legs(const RobotDescription& robot) {
  std::string out = "legs:\n";
  for (const Leg leg : kLegs) {
    const LegModel& model = (*robot.legs)[leg];
    out += fmt::format("  {}:\n", name(leg));
    const LegRoles roles = model.roles();
    for (std::size_t i = 0; i < roles.size(); ++i) {
      // Bars follow from the loops.
      if (!model.parts.empty() && model.parts[i] == LegPart::kBar) continue;
      out += fmt::format("    {}: {}\n", roles[i].name, yaml_quoted(robot.joint(model.joints()[i]).name));
    }
    const Body& link = robot.bodies[static_cast<std::size_t>(model.foot_body)];
    out += fmt::format("    foot: {{link: {}, point: {}, radius: {}}}\n", yaml_quoted(link.name),
                       yaml_vector(model.p_BF), model.foot_radius);
  }
  return out;
}

std::string yaml_softness_of(std::string_view key, const Softness& softness) {
  std::vector<std::string> values;
  for_each_member(softness, [&values](std::string_view name, double value) {
    values.push_back(fmt::format("{}: {}", name, value));
  });
  return fmt::format("{}: {{{}}}", key, fmt::join(values, ", "));
}

std::string yaml_softness(std::string_view key, const Softness& softness) {
  return yaml_softness_of(key, softness) + "\n";
}

/// If all joints have one that is not the usual one: else it is their file's.
std::string yaml_limit_softness(const RobotDescription& robot) {
  std::vector<std::string> written;
  for (int i = 0; i < robot.joint_count(); ++i)
    written.push_back(yaml_softness("limit_softness", robot.joint(i).limit_softness));
  const bool alike = std::equal(written.begin() + 1, written.end(), written.begin());
  return alike && written.front() != yaml_softness("limit_softness", {}) ? written.front() : "";
}

std::string yaml_loops(const RobotDescription& robot) {
  if (robot.loops.empty()) return "";
  std::string out = "loops:\n";
  for (const LoopClosure& loop : robot.loops) {
    const auto link = [&](int body) {
      return yaml_quoted(robot.bodies[static_cast<std::size_t>(body)].name);
    };
    out += fmt::format("  - {{name: {}, link_a: {}, point_a: {}, link_b: {}, point_b: {}}}\n",
                       yaml_quoted(loop.name), link(loop.body_a), yaml_vector(loop.p_AP), link(loop.body_b),
                       yaml_vector(loop.p_BP));
  }
  return out + yaml_softness("loop_softness", robot.loop_softness);
}

std::string yaml_couplings(const LoadedRobot& loaded) {
  const RobotDescription& robot = loaded.robot;
  if (robot.couplings.empty()) return "";
  std::string out = "couplings:  # follower = sum of coefficient times leader^power, rad\n";
  for (const JointCoupling& coupling : robot.couplings) {
    out +=
        fmt::format("  - {{follower: {}, leader: {}, coefficients: [{}], servo: {}, {}}}\n",
                    yaml_quoted(robot.joint(coupling.follower).name),
                    yaml_quoted(robot.joint(coupling.leader).name), fmt::join(coupling.coefficients, ", "),
                    robot.joint(coupling.follower).actuated, yaml_softness_of("softness", coupling.softness));
  }
  return out;
}

/// `KEY: {...}  # units`, of the numbers of one kind.
std::string yaml_numbers(std::string_view key, JointNumberOf of, const Joint& joint) {
  std::vector<std::string> values;
  std::vector<std::string_view> units;
  for (const JointNumber& number : kJointNumbers) {
    if (number.of != of || (is_off_at_zero(number) && joint.*number.member == 0)) continue;
    values.push_back(fmt::format("{}: {}", number.name, joint.*number.member));
    units.push_back(number.unit);
  }
  if (values.empty()) return "";
  return fmt::format("{}: {{{}}}  # {}\n", key, fmt::join(values, ", "), fmt::join(units, ", "));
}

/// What a joint has otherwise than the usual one.
std::vector<std::string> yaml_exceptions(const Joint& joint, const Joint& usual) {
  std::vector<std::string> values;
  for (const JointNumber& number : kJointNumbers) {
    const bool of_any_joint = number.of == JointNumberOf::kJoint;
    if (!of_any_joint && !joint.actuated) continue;
    // Of what any joint has, armature alone stands above for all of them; the others are zero unless said.
    const bool stands_above = !of_any_joint || number.member == &Joint::armature;
    // A torque limit that is written says both directions.
    const bool goes_with_effort = number.member == &Joint::effort_negative && joint.effort_negative != 0 &&
                                  joint.effort_limit != usual.effort_limit;
    if (goes_with_effort || joint.*number.member != (stands_above ? usual.*number.member : 0))
      values.push_back(fmt::format("{}: {}", number.name, joint.*number.member));
  }
  return values;
}

/// The first servo's, and exceptions to them.
std::string yaml_joints(const RobotDescription& robot) {
  const Joint& usual = robot.joint((*robot.legs)[Leg::FL].servos.front());
  const std::string out = fmt::format("armature: {}  # kg m^2\n", usual.armature) +
                          yaml_numbers("servo", JointNumberOf::kServo, usual) +
                          yaml_numbers("drive", JointNumberOf::kDrive, usual);
  std::string exceptions;
  for (int i = 0; i < robot.joint_count(); ++i) {
    const std::vector<std::string> values = yaml_exceptions(robot.joint(i), usual);
    if (!values.empty())
      exceptions += fmt::format("  {}: {{{}}}\n", yaml_quoted(robot.joint(i).name), fmt::join(values, ", "));
  }
  return out + (exceptions.empty() ? "" : "joints:\n" + exceptions);
}

std::string yaml_home(const RobotDescription& robot) {
  std::string out = "home:  # rad\n";
  for (const Leg leg : kLegs) {
    const LegModel& model = (*robot.legs)[leg];
    std::vector<std::string> angles;
    for (const LegRole& role : model.roles())
      angles.push_back(fmt::format("{}: {}", role.name, robot.home[model.joint(role.name)]));
    out += fmt::format("  {}: {{{}}}\n", name(leg), fmt::join(angles, ", "));
  }
  return out;
}

}  // namespace

std::string to_yaml(const LoadedRobot& loaded, const std::string& file) {
  const RobotDescription& robot = loaded.robot;
  const RobotReport& report = loaded.report;
  std::string out = fmt::format("# SI units, radians. Format: models/README.md.\nname: {}\n{}: {}\n",
                                yaml_quoted(robot.name), robot_format_of_any(file).key, yaml_quoted(file));
  if (!report.arguments.empty()) {
    std::vector<std::string> arguments;
    for (const auto& [argument, value] : report.arguments)
      arguments.push_back(fmt::format("{}: {}", yaml_quoted(argument), yaml_quoted(value)));
    out += fmt::format("xacro_args: {{{}}}\n", fmt::join(arguments, ", "));
  }
  out += fmt::format("frame: {{forward: {}, up: {}}}  # in the base frame of that file\n",
                     yaml_vector(report.R_BA.col(0)), yaml_vector(report.R_BA.col(2)));
  std::vector<std::string> locked;
  for (const auto& [joint, angle] : report.locked)
    locked.push_back(fmt::format("{}: {}", yaml_quoted(joint), angle));
  out += fmt::format("locked: {{{}}}  # joints that are held, rad\n", fmt::join(locked, ", "));
  if (!robot.contact.is_empty()) out += fmt::format("contact: {}\n", yaml_of(robot.contact));
  out += yaml_joints(robot) + yaml_softness("friction_softness", robot.friction_softness) +
         yaml_limit_softness(robot) + yaml_legs(robot) + yaml_loops(robot) + yaml_couplings(loaded) +
         yaml_home(robot);
  return out + fmt::format(
                   "standing_height: {}  # m, of hips or shoulders above the feet: the scale of gaits\n"
                   "stance_offset: {}  # m, of the feet ahead of the hips\n",
                   robot.standing_height, robot.stance_offset);
}

}  // namespace crossgait
