#include <algorithm>
#include <filesystem>
#include <limits>
#include <set>

#include <fmt/format.h>

#include "crossgait/physics/error.h"
#include "crossgait/physics/loop_closing.h"
#include "crossgait/physics/multibody.h"
#include "crossgait/physics/robot.h"
#include "crossgait/physics/robot_check.h"
#include "crossgait/physics/urdf_reader.h"
#include "crossgait/physics/yaml_reader.h"

namespace crossgait {
namespace {

namespace fs = std::filesystem;

/// A stated home angle may be this far from the one that closes the loops, rad: rounding, not another working
/// mode.
constexpr double kHomeAngleTolerance = 0.1;

/// Puts one robot together from its two files.
class RobotLoader {
 public:
  explicit RobotLoader(YamlValue root) : root_(std::move(root)) {
    root_.allow_keys(
        {"name", "urdf", "armature", "servo", "joints", "loop_softness", "legs", "loops", "home"});
    const fs::path path = fs::path(root_.source()).parent_path() / root_.at("urdf").text();
    urdf_ = read_urdf(path.string());
    robot_.name = root_.at("name").text();
    robot_.source = root_.source();
  }

  RobotDescription load() {
    const YamlValue legs = root_.at("legs");
    order_bodies(legs);
    read_joints();
    read_loops();
    read_feet(legs);
    check_structure(robot_);
    read_home();
    robot_.validate();
    return std::move(robot_);
  }

 private:
  const LinkPlacement& link(const YamlValue& value) const {
    const auto found = urdf_.links.find(value.text());
    if (found == urdf_.links.end()) value.fail("a link of the URDF", fmt::format("'{}'", value.text()));
    return found->second;
  }

  /// Index of the body that a joint of the URDF moves, in the URDF's order.
  int moved_body(const YamlValue& value, const std::string& joint) const {
    for (std::size_t i = 1; i < urdf_.bodies.size(); ++i) {
      if (urdf_.bodies[i].joint.name == joint) return static_cast<int>(i);
    }
    value.fail("a moving joint of the URDF", fmt::format("'{}'", joint));
  }

  /// Bodies of the legs first, leg by leg and role by role, then the rest in the URDF's order.
  void order_bodies(const YamlValue& legs) {
    legs.allow_keys({name(Leg::FL), name(Leg::FR), name(Leg::RL), name(Leg::RR)});
    std::vector<int> order{0};
    std::set<int> placed{0};
    LegArray<LegModel> models{};
    for (const Leg leg : kLegs) {
      const YamlValue values = legs.at(name(leg));
      values.allow_keys({"tilt", "shoulder_left", "shoulder_right", "elbow_left", "elbow_right", "foot"});
      for (const LegRole& role : kLegRoles) {
        const YamlValue value = values.at(role.name);
        const int body = moved_body(value, value.text());
        if (!placed.insert(body).second) {
          value.fail("each joint once", fmt::format("'{}' again", value.text()));
        }
        models[leg].*role.joint = static_cast<int>(order.size()) - 1;
        order.push_back(body);
      }
    }
    for (int i = 0; i < static_cast<int>(urdf_.bodies.size()); ++i) {
      if (placed.insert(i).second) order.push_back(i);
    }
    body_index_.resize(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      body_index_[static_cast<std::size_t>(order[i])] = static_cast<int>(i);
    }
    for (const int i : order) {
      robot_.bodies.push_back(urdf_.bodies[static_cast<std::size_t>(i)]);
      int& parent = robot_.bodies.back().parent;
      if (parent >= 0) parent = body_index_[static_cast<std::size_t>(parent)];
    }
    robot_.legs = models;
  }

  int body_of(const LinkPlacement& placement) const {
    return body_index_[static_cast<std::size_t>(placement.body)];
  }
  Joint& joint(int i) { return robot_.bodies[static_cast<std::size_t>(i) + 1].joint; }

  void read_joints() {
    const double armature = root_.at("armature").number();
    const YamlValue servo = root_.at("servo");
    servo.allow_keys({"kp", "kd"});
    for (int i = 0; i < robot_.joint_count(); ++i) joint(i).armature = armature;
    for (const LegModel& leg : *robot_.legs) {
      for (const LegRole& role : kLegRoles) {
        if (!role.actuated) continue;
        Joint& driven = joint(leg.*role.joint);
        driven.actuated = true;
        driven.kp = servo.at("kp").number();
        driven.kd = servo.at("kd").number();
      }
    }
    if (const auto exceptions = root_.find("joints")) {
      for (const auto& [joint_name, values] : exceptions->entries()) read_exception(joint_name, values);
    }
  }

  void read_exception(const std::string& joint_name, const YamlValue& values) {
    Joint& target = joint(body_index_[static_cast<std::size_t>(moved_body(values, joint_name))] - 1);
    if (target.actuated) {
      values.allow_keys({"armature", "kp", "kd"});
    } else {
      values.allow_keys({"armature"});
    }
    if (const auto value = values.find("armature")) target.armature = value->number();
    if (const auto value = values.find("kp")) target.kp = value->number();
    if (const auto value = values.find("kd")) target.kd = value->number();
  }

  void read_loops() {
    for (const YamlValue& value : root_.at("loops").items()) {
      value.allow_keys({"name", "link_a", "point_a", "link_b", "point_b"});
      const LinkPlacement& a = link(value.at("link_a"));
      const LinkPlacement& b = link(value.at("link_b"));
      robot_.loops.push_back({value.at("name").text(), body_of(a), body_of(b),
                              a.X_BL * value.at("point_a").vector3(),
                              b.X_BL * value.at("point_b").vector3()});
    }
    const auto softness = root_.find("loop_softness");
    if (!softness) return;
    softness->allow_keys(
        {"time_constant", "damping_ratio", "impedance_min", "impedance_max", "impedance_width"});
    Softness& s = robot_.loop_softness;
    for (const auto& [key, member] : {std::pair{"time_constant", &s.time_constant},
                                      {"damping_ratio", &s.damping_ratio},
                                      {"impedance_min", &s.impedance_min},
                                      {"impedance_max", &s.impedance_max},
                                      {"impedance_width", &s.impedance_width}}) {
      if (const auto value = softness->find(key)) *member = value->number();
    }
  }

  void read_feet(const YamlValue& legs) {
    for (const Leg leg : kLegs) {
      const YamlValue value = legs.at(name(leg)).at("foot");
      const LinkPlacement& placement = link(value);
      const Body& body = urdf_.bodies[static_cast<std::size_t>(placement.body)];
      if (placement.shapes.size() != 1 ||
          body.shapes[static_cast<std::size_t>(placement.shapes[0])].type != ShapeType::kSphere) {
        value.fail("a link with one collision sphere, the foot", fmt::format("link '{}'", value.text()));
      }
      const CollisionShape& foot = body.shapes[static_cast<std::size_t>(placement.shapes[0])];
      LegModel& model = (*robot_.legs)[leg];
      model.foot_body = body_of(placement);
      model.p_BF = foot.X_BG.translation();
      model.foot_radius = foot.size[0];
    }
  }

  /// Angles per role, the same for every leg; the passive joints' are refined until the loops are closed.
  void read_home() {
    const YamlValue home = root_.at("home");
    home.allow_keys({"tilt", "shoulder_left", "shoulder_right", "elbow_left", "elbow_right"});
    robot_.home = JointVector::Zero(robot_.joint_count());
    for (const LegRole& role : kLegRoles) {
      const double angle = home.at(role.name).number();
      for (const LegModel& leg : *robot_.legs) robot_.home[leg.*role.joint] = angle;
    }
    const JointVector stated = robot_.home;
    close_loops(robot_, robot_.home);
    if (!((robot_.home - stated).cwiseAbs().maxCoeff() < kHomeAngleTolerance)) {
      home.fail(fmt::format("angles within {} rad of closed loops", kHomeAngleTolerance),
                "loops that stay open");
    }

    RobotState state;
    state.q = robot_.home;
    std::vector<Pose> poses;
    forward_kinematics(robot_, state, poses);
    double lowest = std::numeric_limits<double>::infinity();
    for (const Leg leg : kLegs) {
      const double sole = foot_position(robot_, leg, poses).z() - (*robot_.legs)[leg].foot_radius;
      lowest = std::min(lowest, sole);
    }
    robot_.home_height = -lowest;
  }

  YamlValue root_;
  UrdfRobot urdf_;
  std::vector<int> body_index_;  ///< from the URDF's order of bodies to the robot's
  RobotDescription robot_;
};

}  // namespace

RobotDescription load_robot(const std::string& path) {
  fs::path yaml(path);
  if (yaml.extension() == ".yaml" || yaml.extension() == ".yml")
    return RobotLoader(YamlValue::load(path)).load();
  if (yaml.extension() != ".urdf") {
    throw ConfigError(path, "file name", "a .yaml or .urdf file",
                      fmt::format("'{}'", yaml.filename().string()));
  }
  if (!fs::exists(path)) throw ConfigError(path, "file", "a readable file", "none");
  yaml.replace_extension(".yaml");
  if (!fs::exists(yaml)) yaml.replace_filename("robot.yaml");
  const YamlValue root = YamlValue::load(yaml.string());
  const YamlValue urdf = root.at("urdf");
  std::error_code missing;  // of the file that the YAML names: then it is another one
  const fs::path named = yaml.parent_path() / urdf.text();
  // By name too: what is no regular file is equivalent to nothing, and the reader says so.
  if (named.lexically_normal() != fs::path(path).lexically_normal() &&
      !fs::equivalent(named, path, missing)) {
    urdf.fail(fmt::format("'{}'", fs::path(path).filename().string()), fmt::format("'{}'", urdf.text()));
  }
  return RobotLoader(root).load();
}

}  // namespace crossgait
