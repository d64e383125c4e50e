#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/yaml_reader.h"
#include "physics/robot/loop_closing.h"
#include "physics/robot/multibody.h"
#include "physics/robot/robot.h"
#include "physics/robot/robot_check.h"
#include "physics/robot_files/inference/robot_inference.h"
#include "physics/robot_files/mjcf/mjcf_reader.h"
#include "physics/robot_files/robot_report.h"
#include "physics/robot_files/robot_servos.h"
#include "physics/robot_files/urdf/urdf_reader.h"
#include "physics/robot_files/urdf/urdf_tree.h"

namespace crossgait {
namespace {

namespace fs = std::filesystem;

/// A stated home angle may be this far from the one that closes the loops, rad: rounding, not another working
/// mode.
constexpr double kHomeAngleTolerance = 0.1;
constexpr const char* kClosedHome = "angles within 0.1 rad of closed loops";

/// Puts one robot together from its URDF or MJCF and, where there is one, the robot.yaml that says more; what
/// neither says is inferred.
class RobotLoader {
 public:
  RobotLoader(const std::string& file, const std::string& source, std::optional<YamlValue> yaml)
      : yaml_(std::move(yaml)), urdf_(is_mjcf_path(file) ? read_mjcf(file) : read_urdf(file)) {
    const auto name = find("name");
    robot_.name = name ? name->text() : urdf_.name.empty() ? fs::path(file).stem().string() : urdf_.name;
    robot_.source = source;
    report_.file = file;
    report_.warnings = urdf_.warnings;
  }

  LoadedRobot load() {
    read_frame_and_legs();
    read_loops();
    read_softness("loop_softness", robot_.loop_softness);
    read_softness("friction_softness", robot_.friction_softness);
    read_feet();
    name_servos();
    check_before_home();
    read_heights_and_home();
    read_servos(yaml_, unknown_effort_, robot_, report_.inferred);
    robot_.validate();
    return {std::move(robot_), std::move(report_)};
  }

 private:
  std::optional<YamlValue> find(std::string_view key) const {
    return yaml_ ? yaml_->find(key) : std::nullopt;
  }
  void infer(std::string what, std::string value, std::string reason) {
    report_.inferred.push_back({std::move(what), std::move(value), std::move(reason)});
  }
  const LinkPlacement& link(const YamlValue& value) const {
    const auto found = urdf_.links.find(value.text());
    if (found == urdf_.links.end())
      value.fail("a link of the robot's file", fmt::format("'{}'", value.text()));
    return found->second;
  }

  /// Index of the body that a joint of the URDF moves, in the URDF's order.
  int moved_body(const std::string& joint) const {
    for (std::size_t i = 1; i < urdf_.bodies.size(); ++i) {
      if (urdf_.bodies[i].joint.name == joint) return static_cast<int>(i);
    }
    return -1;
  }
  int moved_body(const YamlValue& value, const std::string& joint) const {
    const int body = moved_body(joint);
    if (body < 0) value.fail("a moving joint of the robot's file", fmt::format("'{}'", joint));
    return body;
  }

  void read_frame_and_legs() {
    const auto legs = find("legs"), frame = find("frame"), locked = find("locked");
    LegSearch search;
    if (!legs) search = find_legs(urdf_, robot_.source, report_.inferred, report_.warnings);
    if (frame) search.R_BA = read_frame(*frame);
    if (locked) {
      search.locked.clear();
      for (const YamlValue& joint : locked->items()) {
        static_cast<void>(moved_body(joint, joint.text()));
        search.locked.insert(joint.text());
      }
    }
    urdf_ = lock_joints(std::move(urdf_), search.locked);
    if (!search.R_BA.isIdentity(0)) urdf_ = turn_base(std::move(urdf_), search.R_BA);
    report_.locked = std::move(search.locked);
    report_.R_BA = search.R_BA;
    if (legs) {
      read_legs(*legs);
    } else {
      take_legs(search.legs);
    }
  }

  static Matrix3 read_frame(const YamlValue& frame) {
    frame.allow_keys({"forward", "up"});
    const Vector3 forward = frame.at("forward").vector3(), up = frame.at("up").vector3();
    constexpr double kRightAngle = 1e-6;  // of directions written with six decimals
    if (!(forward.norm() > 0 && up.norm() > 0 &&
          std::abs(forward.normalized().dot(up.normalized())) < kRightAngle)) {
      frame.fail("forward and up at a right angle", "directions that are not");
    }
    Matrix3 R;
    R.col(0) = forward.normalized();
    R.col(1) = up.cross(forward).normalized();
    R.col(2) = R.col(0).cross(R.col(1));
    return R;
  }

  void take_legs(const LegArray<LegChain>& chains) {
    LegArray<std::vector<int>> bodies;
    LegArray<LegModel> models;
    for (const Leg leg : kLegs) {
      models[leg].linkage = LegLinkage::kSerial;
      models[leg].servos.resize(chains[leg].size(), -1);
      for (const std::string& joint : chains[leg]) bodies[leg].push_back(moved_body(joint));
    }
    order_bodies(std::move(models), bodies);
  }

  void read_legs(const YamlValue& legs) {
    legs.allow_keys({name(Leg::FL), name(Leg::FR), name(Leg::RL), name(Leg::RR)});
    LegArray<std::vector<int>> bodies;
    LegArray<LegModel> models;
    std::set<int> placed;
    for (const Leg leg : kLegs) {
      const YamlValue values = legs.at(name(leg));
      LegModel& model = models[leg];
      if (values.find("tilt") || !(values.find("hip") || values.find("knee"))) {
        values.allow_keys({"tilt", "shoulder_left", "shoulder_right", "elbow_left", "elbow_right", "foot"});
        model.servos.resize(3, -1);
        model.passive.resize(2, -1);
      } else {
        values.allow_keys({"abduction", "hip", "knee", "foot"});
        model.linkage = LegLinkage::kSerial;
        model.servos.resize(values.find("abduction") ? 3 : 2, -1);
      }
      for (const LegRole& role : model.roles()) {
        const YamlValue value = values.at(role.name);
        const int body = moved_body(value, value.text());
        if (!placed.insert(body).second) {
          value.fail("each joint once", fmt::format("'{}' again", value.text()));
        }
        bodies[leg].push_back(body);
      }
    }
    order_bodies(std::move(models), bodies);
  }

  /// Bodies of the legs first, leg by leg and role by role, then the rest in the URDF's order.
  void order_bodies(LegArray<LegModel> models, const LegArray<std::vector<int>>& legs) {
    std::vector<int> order{0};
    std::set<int> placed{0};
    for (const Leg leg : kLegs) {
      for (std::size_t i = 0; i < legs[leg].size(); ++i) {
        LegModel& model = models[leg];
        const std::size_t servos = model.servos.size();
        (i < servos ? model.servos[i] : model.passive[i - servos]) = static_cast<int>(order.size()) - 1;
        order.push_back(legs[leg][i]);
        placed.insert(legs[leg][i]);
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
    robot_.legs = std::move(models);
  }

  int body_of(const LinkPlacement& placement) const {
    return body_index_[static_cast<std::size_t>(placement.body)];
  }
  Joint& joint(int i) { return robot_.bodies[static_cast<std::size_t>(i) + 1].joint; }

  void name_servos() {
    for (const LegModel& leg : *robot_.legs) {
      for (const int i : leg.servos) joint(i).actuated = true;
    }
  }

  void read_loops() {
    const auto loops = find("loops");
    if (loops) {
      for (const YamlValue& value : loops->items()) {
        value.allow_keys({"name", "link_a", "point_a", "link_b", "point_b"});
        const LinkPlacement& a = link(value.at("link_a"));
        const LinkPlacement& b = link(value.at("link_b"));
        robot_.loops.push_back({value.at("name").text(), body_of(a), body_of(b),
                                a.X_BL * value.at("point_a").vector3(),
                                b.X_BL * value.at("point_b").vector3()});
      }
    } else {
      for (const LinkLoop& loop : urdf_.loops) {
        const LinkPlacement &a = urdf_.links.at(loop.link_a), &b = urdf_.links.at(loop.link_b);
        robot_.loops.push_back({loop.name, body_of(a), body_of(b), a.X_BL * loop.p_a, b.X_BL * loop.p_b});
      }
    }
  }

  void read_softness(std::string_view key_of_robot, Softness& s) {
    const auto softness = find(key_of_robot);
    if (!softness) return;
    softness->allow_keys(
        {"time_constant", "damping_ratio", "impedance_min", "impedance_max", "impedance_width"});
    for (const auto& [key, member] : {std::pair{"time_constant", &s.time_constant},
                                      {"damping_ratio", &s.damping_ratio},
                                      {"impedance_min", &s.impedance_min},
                                      {"impedance_max", &s.impedance_max},
                                      {"impedance_width", &s.impedance_width}}) {
      if (const auto value = softness->find(key)) *member = value->number();
    }
  }

  void read_feet() {
    const auto legs = find("legs");
    for (const Leg leg : kLegs) {
      const auto foot = legs ? legs->at(name(leg)).find("foot") : std::nullopt;
      if (foot) {
        read_foot(*foot, leg);
      } else if ((*robot_.legs)[leg].linkage == LegLinkage::kSerial) {
        infer_foot(leg);
      } else {
        static_cast<void>(legs->at(name(leg)).at("foot"));  // throws
      }
    }
    if (left_out_ > 0) {
      report_.warnings.push_back(
          fmt::format("left out {} collision shape(s) around feet, first of '{}': feet alone touch",
                      left_out_, first_left_out_));
    }
  }

  void infer_foot(Leg leg) {
    LegModel& model = (*robot_.legs)[leg];
    const int last = model.servos.back() + 1;
    const auto in_file = std::find(body_index_.begin(), body_index_.end(), last) - body_index_.begin();
    const FootPlace foot = find_foot(urdf_, static_cast<int>(in_file), leg, robot_.source, report_.inferred);
    put_foot(leg, last, foot.p_BF, foot.radius);
  }

  /// A link with one collision sphere, or a point of a link: `{link, point, radius}`.
  void read_foot(const YamlValue& value, Leg leg) {
    if (value.is_mapping()) {
      value.allow_keys({"link", "point", "radius"});
      const LinkPlacement& placement = link(value.at("link"));
      put_foot(leg, body_of(placement), placement.X_BL * value.at("point").vector3(),
               value.at("radius").number());
      return;
    }
    const LinkPlacement& placement = link(value);
    const Body& body = urdf_.bodies[static_cast<std::size_t>(placement.body)];
    if (placement.shapes.size() != 1 ||
        body.shapes[static_cast<std::size_t>(placement.shapes[0])].type != ShapeType::kSphere) {
      value.fail("a link with one collision sphere, the foot", fmt::format("link '{}'", value.text()));
    }
    const CollisionShape& foot = body.shapes[static_cast<std::size_t>(placement.shapes[0])];
    set_foot(leg, body_of(placement), foot.X_BG.translation(), foot.size[0]);
  }

  Body& set_foot(Leg leg, int body_index, const Vector3& p_BF, double radius) {
    LegModel& model = (*robot_.legs)[leg];
    model.foot_body = body_index;
    model.p_BF = p_BF;
    model.foot_radius = radius;
    return robot_.bodies[static_cast<std::size_t>(body_index)];
  }

  /// Where there is no such sphere on the body, one takes the place of its shapes.
  void put_foot(Leg leg, int body_index, const Vector3& p_BF, double radius) {
    Body& body = set_foot(leg, body_index, p_BF, radius);
    if (const std::size_t count = leave_out_around(urdf_, p_BF, radius, body); count > 0) {
      if (left_out_ == 0) first_left_out_ = body.name;
      left_out_ += count;
    }
    for (std::size_t i = 0; i < body.shapes.size(); ++i) {
      if (leg_of_shape(robot_, body_index, static_cast<int>(i)) == static_cast<int>(leg)) return;
    }
    body.shapes.clear();
    CollisionShape foot;
    foot.name = fmt::format("{}_foot", name(leg));
    foot.size = {radius, 0, 0};
    foot.X_BG.translation() = p_BF;
    body.shapes.push_back(std::move(foot));
  }

  /// What the home pose is found by has to be right before.
  void check_before_home() {
    for (const LegModel& leg : *robot_.legs) {
      for (const int i : leg.servos) {
        double& effort = joint(i).effort_limit;
        if (effort > 0) continue;
        unknown_effort_.insert(i);
        effort = 1;  // until `read_servos` knows
      }
    }
    check_structure(robot_);
  }

  void read_heights_and_home() {
    const auto height = find("standing_height"), offset = find("stance_offset"), home = find("home");
    if (height) {
      robot_.standing_height = height->number();
      if (!(robot_.standing_height > 0))
        height->fail("a height above 0 m", fmt::format("{}", robot_.standing_height));
    }
    if (home) {
      read_home(*home);
    } else if (!take_home_of_file()) {
      infer_home(height.has_value());
    }
    if (offset) robot_.stance_offset = offset->number();
    set_home_height();
    if (robot_.standing_height == 0) {
      robot_.standing_height = home_depth();
      infer("standing_height", fmt::format("{:.4g} m", robot_.standing_height),
            "depth of the feet below the hips or shoulders in the home pose");
    }
  }

  void infer_home(bool has_height) {
    for (const LegModel& leg : *robot_.legs) {
      if (leg.linkage != LegLinkage::kSerial) static_cast<void>(yaml_->at("home"));  // throws
    }
    double length = 0;
    for (const Leg leg : kLegs) length += leg_lengths(robot_, leg).sum() / kLegCount;
    if (!has_height) robot_.standing_height = kStandingShare * length;
    const HomePose home = find_home(robot_, robot_.standing_height, report_.inferred);
    robot_.home = home.q;
    robot_.stance_offset = home.forward;
    infer("gait_scale",
          fmt::format("h = {:.4g} m, sqrt(h/g) = {:.3g} s", robot_.standing_height,
                      std::sqrt(robot_.standing_height / kGravity)),
          "gaits, ranges and limits are multiples of both");
  }

  /// The pose that the robot's file calls its home, if it has one and serial legs can stand in it.
  bool take_home_of_file() {
    if (urdf_.home.empty()) return false;
    JointVector q = JointVector::Zero(robot_.joint_count());
    for (int i = 0; i < robot_.joint_count(); ++i) q[i] = urdf_.home.at(joint(i).name);
    const bool is_serial = std::all_of(robot_.legs->begin(), robot_.legs->end(), [](const LegModel& leg) {
      return leg.linkage == LegLinkage::kSerial;
    });
    const std::string problem = is_serial ? problem_with_stance(robot_, q) : "";
    if (!problem.empty()) {
      report_.warnings.push_back(
          fmt::format("{} is not taken for the home pose: {}", urdf_.home_name, problem));
      return false;
    }
    robot_.home = std::move(q);
    if (!close_home()) {
      throw ConfigError(report_.file, urdf_.home_name, kClosedHome, "loops that stay open");
    }
    infer("home", fmt::format("the angles of {}", urdf_.home_name), "the file has it");
    if (!is_serial) return true;
    robot_.stance_offset = balanced_offset(robot_, robot_.home);
    infer("stance_offset", fmt::format("{:.4g} m", robot_.stance_offset), kStanceOffsetReason);
    return true;
  }

  /// Moves passive joints until the loops are closed. @returns whether they were nearly so
  bool close_home() {
    if (robot_.loops.empty()) return true;
    const JointVector stated = robot_.home;
    close_loops(robot_, robot_.home);
    return (robot_.home - stated).cwiseAbs().maxCoeff() < kHomeAngleTolerance;
  }

  /// Angles per role, for every leg or leg by leg; passive joints' are refined until the loops are closed.
  void read_home(const YamlValue& home) {
    robot_.home = JointVector::Zero(robot_.joint_count());
    const bool by_leg = home.find(name(Leg::FL)).has_value();
    if (by_leg) home.allow_keys({name(Leg::FL), name(Leg::FR), name(Leg::RL), name(Leg::RR)});
    for (const Leg leg : kLegs) {
      const LegModel& model = (*robot_.legs)[leg];
      const YamlValue values = by_leg ? home.at(name(leg)) : home;
      if (model.linkage == LegLinkage::kFiveBar) {
        values.allow_keys({"tilt", "shoulder_left", "shoulder_right", "elbow_left", "elbow_right"});
      } else {
        values.allow_keys({"abduction", "hip", "knee"});
      }
      for (const LegRole& role : model.roles()) {
        robot_.home[model.joint(role.name)] = values.at(role.name).number();
      }
    }
    if (!close_home()) home.fail(kClosedHome, "loops that stay open");
  }

  std::vector<Pose> home_poses() const {
    RobotState state;
    state.q = robot_.home;
    std::vector<Pose> poses;
    forward_kinematics(robot_, state, poses);
    return poses;
  }

  void set_home_height() {
    const std::vector<Pose> poses = home_poses();
    double lowest = std::numeric_limits<double>::infinity();
    for (const Leg leg : kLegs) {
      const double sole = foot_position(robot_, leg, poses).z() - (*robot_.legs)[leg].foot_radius;
      lowest = std::min(lowest, sole);
    }
    robot_.home_height = -lowest;
  }

  /// Mean depth of the feet below the joints that swing them: hips, or the left shoulders.
  double home_depth() const {
    const std::vector<Pose> poses = home_poses();
    double depth = 0;
    for (const Leg leg : kLegs) {
      const LegModel& model = (*robot_.legs)[leg];
      const int hip = model.joint(model.linkage == LegLinkage::kSerial ? "hip" : "shoulder_left");
      depth += (poses[static_cast<std::size_t>(hip) + 1].translation().z() -
                foot_position(robot_, leg, poses).z()) /
               kLegCount;
    }
    return depth;
  }

  std::optional<YamlValue> yaml_;
  UrdfRobot urdf_;
  std::vector<int> body_index_;  ///< from the URDF's order of bodies to the robot's
  std::set<int> unknown_effort_;
  std::size_t left_out_ = 0;  ///< shapes around feet, and whose the first was
  std::string first_left_out_;
  RobotDescription robot_;
  RobotReport report_;
};

/// The value of the key `urdf` or `mjcf`, of which a robot.yaml has one.
YamlValue named_file(const YamlValue& root) {
  const auto mjcf = root.find("mjcf");
  if (!mjcf) return root.at("urdf");
  if (root.find("urdf")) mjcf->fail("either `urdf` or `mjcf`", "both");
  if (!is_mjcf_path(mjcf->text())) mjcf->fail("a .xml or .mjcf file", fmt::format("'{}'", mjcf->text()));
  return *mjcf;
}

LoadedRobot load_yaml(const YamlValue& root) {
  root.allow_keys({"name", "urdf", "mjcf", "frame", "locked", "armature", "servo", "drive", "joints",
                   "loop_softness", "friction_softness", "legs", "loops", "home", "standing_height",
                   "stance_offset"});
  const fs::path file = fs::path(root.source()).parent_path() / named_file(root).text();
  return RobotLoader(file.string(), root.source(), root).load();
}

/// The robot.yaml of a URDF or MJCF: of the same stem, or `robot.yaml` beside it, which has to name this
/// file. One that names a file of the other format says nothing of this one.
std::optional<YamlValue> yaml_beside(const std::string& path) {
  fs::path yaml(path);
  yaml.replace_extension(".yaml");
  if (!fs::exists(yaml)) yaml.replace_filename("robot.yaml");
  if (!fs::exists(yaml)) return std::nullopt;
  YamlValue root = YamlValue::load(yaml.string());
  const YamlValue file = named_file(root);
  if (is_mjcf_path(file.text()) != is_mjcf_path(path)) return std::nullopt;
  std::error_code missing;  // of the file that the YAML names: then it is another one
  const fs::path named = yaml.parent_path() / file.text();
  // By name too: what is no regular file is equivalent to nothing, and the reader says so.
  if (named.lexically_normal() != fs::path(path).lexically_normal() &&
      !fs::equivalent(named, path, missing)) {
    file.fail(fmt::format("'{}'", fs::path(path).filename().string()), fmt::format("'{}'", file.text()));
  }
  return root;
}

}  // namespace

LoadedRobot load_robot_with_report(const std::string& path) {
  const fs::path file(path);
  if (file.extension() == ".yaml" || file.extension() == ".yml") return load_yaml(YamlValue::load(path));
  if (file.extension() != ".urdf" && !is_mjcf_path(path)) {
    throw ConfigError(path, "file name", "a .yaml, .urdf or .xml (MJCF) file",
                      fmt::format("'{}'", file.filename().string()));
  }
  if (!fs::exists(path)) throw ConfigError(path, "file", "a readable file", "none");
  if (const auto yaml = yaml_beside(path)) return load_yaml(*yaml);
  return RobotLoader(path, path, std::nullopt).load();
}

RobotDescription load_robot(const std::string& path) { return load_robot_with_report(path).robot; }

}  // namespace crossgait
