#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/yaml_reader.h"
#include "physics/robot/drives.h"
#include "physics/robot_files/mjcf/mjcf_reader.h"
#include "physics/robot_files/robot_report.h"

namespace crossgait {
namespace {

std::string yaml_vector(const Vector3& v) { return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z()); }

std::string yaml_legs(const RobotDescription& robot) {
  std::string out = "legs:\n";
  for (const Leg leg : kLegs) {
    const LegModel& model = (*robot.legs)[leg];
    out += fmt::format("  {}:\n", name(leg));
    for (const LegRole& role : model.roles())
      out += fmt::format("    {}: {}\n", role.name, yaml_quoted(robot.joint(model.joint(role.name)).name));
    const Body& link = robot.bodies[static_cast<std::size_t>(model.foot_body)];
    out += fmt::format("    foot: {{link: {}, point: {}, radius: {}}}\n", yaml_quoted(link.name),
                       yaml_vector(model.p_BF), model.foot_radius);
  }
  return out;
}

std::string yaml_softness(std::string_view key, const Softness& s) {
  return fmt::format(
      "{}: {{time_constant: {}, damping_ratio: {}, impedance_min: {}, impedance_max: {}, impedance_width: "
      "{}}}\n",
      key, s.time_constant, s.damping_ratio, s.impedance_min, s.impedance_max, s.impedance_width);
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

/// The first servo's, and exceptions to them.
std::string yaml_joints(const RobotDescription& robot) {
  const Joint& usual = robot.joint((*robot.legs)[Leg::FL].servos.front());
  std::string out = fmt::format(
      "armature: {}  # kg m^2\nservo: {{kp: {}, kd: {}, effort: {}}}  # N m/rad, N m s/rad, N m\n",
      usual.armature, usual.kp, usual.kd, usual.effort_limit);
  std::vector<std::string> drive;
  for (const DriveSetting& setting : drive_settings()) {
    if (usual.*setting.member != 0)
      drive.push_back(fmt::format("{}: {}", setting.name, usual.*setting.member));
  }
  if (!drive.empty()) out += fmt::format("drive: {{{}}}\n", fmt::join(drive, ", "));
  std::string exceptions;
  for (int i = 0; i < robot.joint_count(); ++i) {
    const Joint& joint = robot.joint(i);
    std::vector<std::string> values;
    if (joint.armature != usual.armature) values.push_back(fmt::format("armature: {}", joint.armature));
    if (joint.damping != 0) values.push_back(fmt::format("damping: {}", joint.damping));
    if (joint.friction != 0) values.push_back(fmt::format("friction: {}", joint.friction));
    if (joint.actuated) {
      if (joint.kp != usual.kp) values.push_back(fmt::format("kp: {}", joint.kp));
      if (joint.kd != usual.kd) values.push_back(fmt::format("kd: {}", joint.kd));
      if (joint.effort_limit != usual.effort_limit)
        values.push_back(fmt::format("effort: {}", joint.effort_limit));
      for (const DriveSetting& setting : drive_settings()) {
        if (joint.*setting.member != usual.*setting.member)
          values.push_back(fmt::format("{}: {}", setting.name, joint.*setting.member));
      }
    }
    if (!values.empty())
      exceptions += fmt::format("  {}: {{{}}}\n", yaml_quoted(joint.name), fmt::join(values, ", "));
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
  std::string out =
      fmt::format("# SI units, radians. Format: models/README.md.\nname: {}\n{}: {}\n",
                  yaml_quoted(robot.name), is_mjcf_path(file) ? "mjcf" : "urdf", yaml_quoted(file));
  out += fmt::format("frame: {{forward: {}, up: {}}}  # in the base frame of that file\n",
                     yaml_vector(report.R_BA.col(0)), yaml_vector(report.R_BA.col(2)));
  std::vector<std::string> locked;
  for (const std::string& joint : report.locked) locked.push_back(yaml_quoted(joint));
  out += fmt::format("locked: [{}]  # joints held at zero\n", fmt::join(locked, ", "));
  out += yaml_joints(robot) + yaml_softness("friction_softness", robot.friction_softness) + yaml_legs(robot) +
         yaml_loops(robot) + yaml_home(robot);
  return out + fmt::format(
                   "standing_height: {}  # m, of hips or shoulders above the feet: the scale of gaits\n"
                   "stance_offset: {}  # m, of the feet ahead of the hips\n",
                   robot.standing_height, robot.stance_offset);
}

}  // namespace crossgait
