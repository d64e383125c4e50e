#include "physics/robot_files/mjcf/mjcf_reader.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/error.h"
#include "physics/robot/rigid_pair.h"
#include "physics/robot/robot_check.h"
#include "physics/robot_files/inertia_repair.h"
#include "physics/robot_files/joint_limits.h"
#include "physics/robot_files/mjcf/mjcf_actuators.h"
#include "physics/robot_files/mjcf/mjcf_compile.h"
#include "physics/robot_files/mjcf/mjcf_connects.h"
#include "physics/robot_files/mjcf/mjcf_contact.h"
#include "physics/robot_files/mjcf/mjcf_couplings.h"
#include "physics/robot_files/mjcf/mjcf_drives.h"
#include "physics/robot_files/mjcf/mjcf_frames.h"
#include "physics/robot_files/mjcf/mjcf_newer.h"
#include "physics/robot_files/mjcf/mjcf_shapes.h"

namespace crossgait {
namespace {

constexpr double kMostPlay = 0.2;                      // rad, from stop to stop
constexpr double kParallel = 1e-6, kSamePoint = 1e-6;  // 1 - cos; m

bool is_range_of_play(double lower, double upper) {
  return lower <= 0 && upper >= 0 && upper - lower <= kMostPlay;
}

class MjcfTree {
 public:
  MjcfTree(const std::string& path, const MjcfParts& parts, const MjcfModel& model,
           const MjcfConnects& connects, const std::vector<NamedCoupling>& couplings,
           ReaderWarnings& warnings)
      : path_(path),
        parts_(parts),
        model_(model),
        connects_(connects),
        warnings_(warnings),
        shapes_(path, parts, warnings) {
    for (std::size_t i = 0; i < model.bodies.size(); ++i) {
      if (model.bodies[i].parent >= 0) children_[model.bodies[i].parent].push_back(static_cast<int>(i));
    }
    for (const NamedCoupling& coupling : couplings) followers_.insert(coupling.follower);
    for (const MjcfJoint& joint : model.joints) joints_[joint.body].push_back(&joint);
    for (const MjcfGeom& geom : model.geoms) geoms_[geom.body].push_back(&geom);
  }

  ParsedRobot build() {
    const int base = find_base();
    check_base(base);
    Body body;
    body.name = at(base).name;
    add_body(base, std::move(body), Pose::Identity());
    connect();
    take_home();
    robot_.name = model_.name;
    robot_.mesh_vertices = std::move(shapes_.mesh_vertices());
    return std::move(robot_);
  }

 private:
  const MjcfBody& at(int i) const { return model_.bodies[static_cast<std::size_t>(i)]; }
  const MjcfElement& body_element(int i) const { return parts_.element("body", at(i).name); }
  const MjcfElement& joint_element(const MjcfJoint& joint) const {
    return parts_.element("joint", joint.name);
  }
  template <typename T>
  static const std::vector<T>& of(const std::map<int, std::vector<T>>& map, int i) {
    static const std::vector<T> kNone;
    const auto found = map.find(i);
    return found == map.end() ? kNone : found->second;
  }

  bool has_hinge(int body) const {
    const auto& joints = of(joints_, body);
    const auto& children = of(children_, body);
    return std::any_of(joints.begin(), joints.end(),
                       [](const MjcfJoint* j) { return j->type != MjcfJointType::kFree; }) ||
           std::any_of(children.begin(), children.end(), [this](int child) { return has_hinge(child); });
  }

  /// Whether bodies are chains whose base was welded to the world: each hangs on it by a joint that is not
  /// free, or there are as many without any as a quadruped has legs.
  bool are_welded(const std::vector<int>& bodies) const {
    const auto all = [&](const auto& predicate) {
      return std::all_of(bodies.begin(), bodies.end(), [&](int i) { return predicate(of(joints_, i)); });
    };
    using Joints = std::vector<const MjcfJoint*>;
    const bool none_free = all([](const Joints& joints) {
      return std::none_of(joints.begin(), joints.end(),
                          [](const MjcfJoint* j) { return j->type == MjcfJointType::kFree; });
    });
    return none_free && (bodies.size() >= static_cast<std::size_t>(kLegCount) ||
                         all([](const Joints& joints) { return !joints.empty(); }));
  }

  /// The body of the world that joints hang on.
  int find_base() const {
    std::vector<int> found;
    for (const int body : of(children_, 0)) {
      if (has_hinge(body) && !at(body).mocap) {
        found.push_back(body);
      } else {
        warnings_.count("left out ", " body or bodies beside the robot",
                        mjcf_place(body_element(body), path_));
      }
    }
    if (found.empty()) throw ConfigError(path_, "worldbody", "a body with joints", "none");
    if (found.size() > 1 && are_welded(found)) {
      std::vector<std::string> names;
      for (const int body : found) names.push_back(fmt::format("'{}'", at(body).name));
      fail_at(
          body_element(found[0]), "a base that floats, on which the legs hang",
          fmt::format("{} chains of joints that hang on the world itself ({}): the base was welded to the "
                      "world and its mass is lost; convert again with a floating base, or take the URDF",
                      found.size(), fmt::join(names, ", ")));
    }
    if (found.size() > 1) {
      fail_at(body_element(found[1]), "one robot: one body of the world on which joints hang",
              fmt::format("a second one beside '{}'", at(found[0]).name));
    }
    return found.front();
  }

  void check_base(int base) const {
    const auto& joints = of(joints_, base);
    if (joints.empty()) {
      warnings_.add(fmt::format("took body '{}', which has no free joint, for the free base", at(base).name));
    }
    for (const MjcfJoint* joint : joints) {
      if (joint->type != MjcfJointType::kFree) {
        fail_at(joint_element(*joint), "a free joint, or none, on the body that hangs on the world",
                "another one");
      }
      if (joint->damping > 0 || joint->armature > 0)
        warnings_.add(
            fmt::format("did not simulate the damping of {:g} and the armature of {:g} of the base's free "
                        "joint, which its class may have given it",
                        joint->damping, joint->armature));
    }
  }

  /// Whether a joint is the play of another one of its body: about the same axis, over hundredths around
  /// zero.
  static bool is_play(const MjcfJoint& joint, const MjcfJoint& of) {
    return joint.type == MjcfJointType::kHinge && of.type == MjcfJointType::kHinge && joint.limited &&
           is_range_of_play(joint.lower, joint.upper) &&
           !(of.limited && is_range_of_play(of.lower, of.upper)) &&
           std::abs(joint.axis.normalized().dot(of.axis.normalized())) > 1 - kParallel &&
           (joint.p_BJ - of.p_BJ).norm() < kSamePoint;
  }

  /// The one hinge of a moving body, or null; a second one that is its play becomes its backlash.
  /// @throws ConfigError for other joints
  const MjcfJoint* hinge_of(int body) const {
    const auto& joints = of(joints_, body);
    if (joints.empty()) return nullptr;
    if (joints.size() == 2 && is_play(*joints[1], *joints[0])) return joints[0];
    if (joints.size() == 2 && is_play(*joints[0], *joints[1])) return joints[1];
    if (joints.size() > 1) {
      fail_at(joint_element(*joints[1]),
              "one joint on a body, or a second hinge of its axis with a range of "
              "hundredths of a radian (backlash)",
              fmt::format("a second one on '{}'", at(body).name));
    }
    if (joints[0]->type != MjcfJointType::kHinge) {
      fail_at(joint_element(*joints[0]), "a hinge",
              joints[0]->type == MjcfJointType::kSlide ? "a slide joint" : "a ball joint");
    }
    return joints[0];
  }

  struct Pending {
    int body;
    Pose X_PB;  ///< in the moving body above it
  };

  /// @param X_BA  pose of the frame of the MJCF's body in that of ours
  void add_body(int first, Body started, const Pose& X_BA) {
    const auto index = static_cast<int>(robot_.bodies.size());
    robot_.bodies.push_back(std::move(started));
    std::vector<Pending> moving;
    merge(first, index, X_BA, moving);
    Body& body = robot_.bodies[static_cast<std::size_t>(index)];
    const std::string_view repair = repair_inertia(body.inertia, body.shapes);
    if (!repair.empty())
      warnings_.list(fmt::format(" moving link(s) {}", repair), fmt::format("'{}'", body.name));
    check_inertia(body.inertia, path_, fmt::format("body '{}'", body.name));
    for (const Pending& next : moving) {
      const MjcfJoint& joint = *hinge_of(next.body);
      Body child;
      child.name = at(next.body).name;
      child.parent = index;
      child.joint = read_joint(joint);
      // The frame of the joint at zero angle: at its anchor, turned back from where the file has the body.
      child.X_PB = next.X_PB * Eigen::Translation3d(joint.p_BJ);
      if (joint.reference != 0) {
        child.X_PB = child.X_PB * Eigen::AngleAxisd(-joint.reference, joint.axis);
        robot_.drawn_at[joint.name] = joint.reference;
      }
      Pose X_child = Pose::Identity();
      X_child.translation() = -joint.p_BJ;
      add_body(next.body, std::move(child), X_child);
    }
  }

  /// Adds a body of the file and what is fixed to it to one of ours; those that move are appended to
  /// `moving`.
  void merge(int body, int index, const Pose& X_BA, std::vector<Pending>& moving) {
    Body& ours = robot_.bodies[static_cast<std::size_t>(index)];
    if (at(body).inertia.mass > 0) ours.inertia = combine(ours.inertia, moved(X_BA, at(body).inertia));
    LinkPlacement& link = robot_.links[at(body).name];
    link.body = index;
    link.X_BL = X_BA;
    for (const MjcfGeom* geom : of(geoms_, body)) {
      for (const int shape : shapes_.add(*geom, X_BA, ours)) link.shapes.push_back(shape);
    }
    for (const int child : of(children_, body)) {
      const Pose X = X_BA * at(child).X_PB;
      if (hinge_of(child) != nullptr) {
        moving.push_back({child, X});
      } else {
        merge(child, index, X, moving);
      }
    }
  }

  Joint read_joint(const MjcfJoint& source) {
    Joint joint;
    joint.name = source.name;
    joint.axis = source.axis.normalized();
    const std::string place = mjcf_place(joint_element(source), path_);
    if (source.limited) {
      // MuJoCo's margin is where a limit acts from: the same as a limit there.
      const double margin = source.limit_margin;
      if (margin != 0)
        warnings_.count(fmt::format("took limits closer by their margin of {:g} rad in ", margin),
                        " joint(s)", place);
      set_limits(source.lower + margin, source.upper - margin, followers_.contains(joint.name), place, joint,
                 warnings_);
      joint.limit_softness = softness_of(source.limit_solref, source.limit_solimp);
    }
    joint.damping = source.damping;
    joint.armature = source.armature;
    joint.friction = source.friction;
    joint.stiffness = source.stiffness;
    joint.spring_reference = source.stiffness != 0 ? source.spring_reference : 0;
    for (const MjcfJoint* play : of(joints_, source.body)) {
      if (play == &source) continue;
      joint.backlash = play->upper - play->lower;
      robot_.reasons[joint.name]["backlash"] = fmt::format("range of the hinge '{}'", play->name);
      warnings_.count(fmt::format("read as a backlash of {:g} rad the second hinge (its damping of {:g} and "
                                  "friction of {:g} are not simulated) of ",
                                  joint.backlash, play->damping, play->friction),
                      " joint(s)", place);
    }
    check_joint(joint, path_);
    return joint;
  }

  void connect() {
    for (const MjcfConnect& connect : model_.connects) {
      const std::string &a = at(connect.body_a).name, &b = at(connect.body_b).name;
      if (!robot_.links.contains(a) || !robot_.links.contains(b)) {
        warnings_.count("ignored ", " <connect> to what is not the robot",
                        fmt::format("connect '{}'", connect.name));
        continue;
      }
      const std::string name =
          connect.name.empty() ? fmt::format("connect_{}", robot_.loops.size()) : connect.name;
      const auto end = connects_.ends.find(connect.name);
      robot_.loops.push_back(
          {name, a, b, connect.p_AP, end == connects_.ends.end() ? connect.p_BP : end->second});
    }
  }

  /// The keyframe of the name home, else the first.
  void take_home() {
    if (model_.keys.empty()) return;
    const auto home = std::find_if(model_.keys.begin(), model_.keys.end(),
                                   [](const MjcfKey& key) { return key.name == "home"; });
    const MjcfKey& key = home == model_.keys.end() ? model_.keys.front() : *home;
    robot_.home_name = key.name.empty() ? "the first keyframe" : fmt::format("keyframe '{}'", key.name);
    for (const MjcfJoint& joint : model_.joints) {
      if (joint.type == MjcfJointType::kHinge)
        robot_.home[joint.name] = key.q[static_cast<std::size_t>(joint.q)];
    }
  }

  const std::string& path_;
  const MjcfParts& parts_;
  const MjcfModel& model_;
  const MjcfConnects& connects_;
  ReaderWarnings& warnings_;
  MjcfShapes shapes_;
  std::map<int, std::vector<int>> children_;
  std::map<int, std::vector<const MjcfJoint*>> joints_;
  std::map<int, std::vector<const MjcfGeom*>> geoms_;
  std::set<std::string> followers_;  ///< joints that follow others
  ParsedRobot robot_;
};

/// Makes backlash of joints that are the play of the one that they hang on: about the same line, over
/// hundredths around zero, and driven by nothing. What they move becomes part of what moves them.
ParsedRobot merge_play(ParsedRobot robot, ReaderWarnings& warnings) {
  std::map<std::string, double> play;
  for (std::size_t i = 1; i < robot.bodies.size(); ++i) {
    const Body& body = robot.bodies[i];
    if (body.parent < 1) continue;
    Joint& driven = robot.bodies[static_cast<std::size_t>(body.parent)].joint;
    const Joint& joint = body.joint;
    const Vector3 offset = body.X_PB.translation();
    const bool one_line = std::abs((body.X_PB.linear() * joint.axis).dot(driven.axis)) > 1 - kParallel &&
                          (offset - offset.dot(driven.axis) * driven.axis).norm() < kSamePoint;
    const bool is_driven = joint.kp > 0 || joint.kd > 0 || joint.effort_limit > 0;
    if (!one_line || is_driven || !is_range_of_play(joint.lower, joint.upper) ||
        is_range_of_play(driven.lower, driven.upper))
      continue;
    play[joint.name] = 0;
    driven.backlash += joint.upper - joint.lower;
    robot.reasons[driven.name]["backlash"] = fmt::format("range of the hinge '{}'", joint.name);
    warnings.count(
        fmt::format("read as a backlash of {:g} rad a hinge (its damping of {:g} and friction of {:g} are "
                    "not simulated) on the bodies of ",
                    joint.upper - joint.lower, joint.damping, joint.friction),
        " joint(s)", fmt::format("joint '{}'", driven.name));
  }
  return play.empty() ? robot : lock_joints(std::move(robot), play);
}

/// MuJoCo's integrators but RK4 take the damping of joints at a step's end (mj_Euler, mj_implicit).
void take_damping_law(ParsedRobot& robot) {
  const std::string integrator = robot.contact.integrator.value_or("Euler");
  if (integrator == "RK4" || (integrator == "Euler" && robot.contact.has_explicit_dampers)) return;
  for (Body& body : robot.bodies) {
    Joint& joint = body.joint;
    if (!(joint.damping > 0)) continue;
    joint.implicit_joint_damping = 1;
    robot.reasons[joint.name]["implicit_joint_damping"] = fmt::format(
        "the file's integrator, {}{}", integrator, robot.contact.integrator ? "" : ", MuJoCo's default");
  }
}

/// Notes which of the robot's joints are held; others are of what was left out.
void hold_joints(const std::map<std::string, double>& angles, ParsedRobot& robot, ReaderWarnings& warnings) {
  for (std::size_t i = 1; i < robot.bodies.size(); ++i) {
    const auto held = angles.find(robot.bodies[i].joint.name);
    if (held == angles.end()) continue;
    robot.held.insert(*held);
    warnings.list(" joint(s) are held rigidly, which <joint> in <equality> holds softly: ",
                  fmt::format("'{}' at {:.4g} rad", held->first, held->second));
  }
}

}  // namespace

ParsedRobot read_mjcf(const std::string& path) {
  ReaderWarnings warnings;
  MjcfDocument document(path);
  const MjcfDefaults defaults(document.root());
  write_out_frames(document, defaults);
  const MjcfContact contact(document.root(), defaults);
  const MjcfConnects connects = take_connects(document, defaults, warnings);
  MjcfCouplings couplings = find_couplings(document, defaults);
  const std::vector<MjcfActuator> actuators = take_actuators(document, defaults, warnings);
  MjcfParts parts = take_parts(document, warnings);
  const MjcfJointForces forces = take_newer(document, defaults, warnings);
  const MjcfModel model = compile_parts(document, defaults, parts, warnings);
  ParsedRobot robot = MjcfTree(path, parts, model, connects, couplings.followers, warnings).build();
  robot.loop_softness = connects.softness;
  robot.coupled = std::move(couplings.others);
  robot.couplings = std::move(couplings.followers);
  std::map<std::string, double> references;
  for (const MjcfJoint& joint : model.joints) {
    if (joint.type == MjcfJointType::kHinge) references[joint.name] = joint.reference;
  }
  for (NamedCoupling& coupling : robot.couplings) refer_to_zero(coupling, references, path);
  robot.contact = contact.read(document.root());
  drive_joints(actuators, forces, model, path, robot, warnings);
  for (const MjcfActuator& actuator : actuators) robot.servos.insert(actuator.joint);
  take_damping_law(robot);
  robot = merge_play(std::move(robot), warnings);
  hold_joints(held_angles(couplings.held, references, path), robot, warnings);
  robot.warnings = warnings.sentences();
  return robot;
}

}  // namespace crossgait
