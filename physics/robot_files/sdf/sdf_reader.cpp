#include "physics/robot_files/sdf/sdf_reader.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/error.h"
#include "physics/robot/rigid_pair.h"
#include "physics/robot/robot_check.h"
#include "physics/robot_files/inertia_repair.h"
#include "physics/robot_files/joint_limits.h"
#include "physics/robot_files/reader_warnings.h"
#include "physics/robot_files/sdf/sdf_contact.h"
#include "physics/robot_files/sdf/sdf_joints.h"
#include "physics/robot_files/sdf/sdf_model.h"
#include "physics/robot_files/sdf/sdf_servos.h"
#include "physics/robot_files/sdf/sdf_shapes.h"
#include "physics/robot_files/sdf/sdf_values.h"

namespace crossgait {
namespace {

/// Says nothing of what is simulated so anyway, and counts what is said otherwise.
void pass_over_usual(const SdfModel& model) {
  for (const SdfElement* m : model.models) {
    for (const char* no : {"static", "self_collide", "enable_wind"}) m->pass_over(no, {"false", "0"});
    m->pass_over("allow_auto_disable");  // whether what rests is computed
  }
  for (const SdfLink& link : model.links) {
    for (const char* no : {"self_collide", "enable_wind", "kinematic"})
      link.element->pass_over(no, {"false", "0"});
    link.element->pass_over("gravity", {"true", "1"});
    link.element->pass_over("must_be_base_link");
    if (const SdfElement* decay = link.element->find("velocity_decay"))
      for (const char* zero : {"linear", "angular"}) decay->pass_over(zero, {"0", "0.0"});
  }
}

class SdfTreeBuilder {
 public:
  SdfTreeBuilder(const std::string& path, const SdfModel& model, ReaderWarnings& warnings)
      : path_(path), model_(model), warnings_(warnings), shapes_(path, warnings) {
    for (const SdfLink& link : model.links) links_[link.name] = &link;
  }

  ParsedRobot build() {
    const SdfJoints joints = sort_joints(model_, path_, warnings_);
    for (const SdfJoint* joint : joints.of_tree) children_[joint->parent].push_back(joint);
    // As every format has them: siblings by the names of their joints.
    for (auto& [parent, children] : children_)
      std::ranges::stable_sort(children, {}, [](const SdfJoint* joint) { return joint->name; });
    add_body(*links_.at(joints.root), nullptr, -1);
    close_loops_of(joints);
    for (const SdfLink& link : model_.links) {
      if (!robot_.links.contains(link.name))
        warnings_.count("left out ", " link(s) that no joint holds to the robot",
                        sdf_place(*link.element, path_));
    }
    robot_.name = model_.name;
    robot_.mesh_vertices = std::move(shapes_.mesh_vertices());
    robot_.contact.shapes = std::move(shapes_.contacts());
    return std::move(robot_);
  }

 private:
  /// A link's frame at the origin of the joint that moves it; the base's as it is.
  static Pose body_frame(const SdfLink& link, const SdfJoint* joint) {
    Pose X_MB = link.X_ML;
    if (joint != nullptr) X_MB.translation() = joint->X_MJ.translation();
    return X_MB;
  }

  void add_body(const SdfLink& first, const SdfJoint* joint, int parent) {
    const auto index = static_cast<int>(robot_.bodies.size());
    const Pose X_MB = body_frame(first, joint);
    frames_.push_back(X_MB);
    Body started;
    started.name = first.name;
    started.parent = parent;
    if (joint != nullptr) {
      started.X_PB = frames_[static_cast<std::size_t>(parent)].inverse() * X_MB;
      started.joint = read_joint(*joint, X_MB);
    }
    robot_.bodies.push_back(std::move(started));
    std::vector<const SdfJoint*> moving;
    merge_links(first, index, moving);
    check_whole(robot_.bodies[static_cast<std::size_t>(index)], true, path_, sdf_place(*first.element, path_),
                warnings_);
    for (const SdfJoint* next : moving) add_body(*links_.at(next->child), next, index);
  }

  /// Adds a link and what is fixed to it to a body, depth first; joints that move are appended to `moving`.
  void merge_links(const SdfLink& first, int index, std::vector<const SdfJoint*>& moving) {
    Body& body = robot_.bodies[static_cast<std::size_t>(index)];
    const Pose X_BM = frames_[static_cast<std::size_t>(index)].inverse();
    std::vector<const SdfJoint*> waiting;
    const auto add = [&](const SdfLink& link) {
      const Pose X_BL = X_BM * link.X_ML;
      body.inertia = combine(body.inertia, read_inertia(link, X_BL));
      robot_.links[link.name] = {index, X_BL, shapes_.add(*link.element, link.name, X_BL, body)};
      shapes_.add_visuals(*link.element, X_BL, body);
      const auto children = children_.find(link.name);
      if (children != children_.end())
        waiting.insert(waiting.end(), children->second.rbegin(), children->second.rend());
    };
    add(first);
    while (!waiting.empty()) {
      const SdfJoint* next = waiting.back();
      waiting.pop_back();
      if (next->type == "fixed") {
        next->element->pass_over("axis");
        add(*links_.at(next->child));
      } else {
        moving.push_back(next);
      }
    }
  }

  SpatialInertia read_inertia(const SdfLink& link, const Pose& X_BL) {
    const std::string place = sdf_place(*link.element, path_);
    const SdfElement* inertial = link.element->find("inertial");
    double mass = 1;
    Matrix3 I = Matrix3::Identity();
    const auto usual = [&](const char* what, const char* element) {
      warnings_.count(fmt::format("took SDF's default of {} for ", what),
                      fmt::format(" link(s) without <{}>", element), place);
    };
    if (inertial == nullptr) {
      usual("1 kg and 1 kg m^2", "inertial");
      return moved(X_BL, {mass, Vector3::Zero(), I});
    }
    if (const std::string automatic = inertial->attribute("auto"); automatic == "true" || automatic == "1")
      fail_at(*inertial, "mass and inertia that are written out", "auto=\"true\"");
    if (inertial->find("mass") == nullptr) usual("1 kg", "mass");
    mass = sdf_number(*inertial, "mass", mass);
    if (const SdfElement* inertia = inertial->find("inertia")) {
      const auto moment = [&](const char* name) { return sdf_numbers(sdf_needed(*inertia, name), 1)[0]; };
      const auto product = [&](const char* name) { return sdf_number(*inertia, name, 0); };
      const double xx = moment("ixx"), yy = moment("iyy"), zz = moment("izz");
      const double xy = product("ixy"), xz = product("ixz"), yz = product("iyz");
      I << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    } else {
      usual("1 kg m^2", "inertia");
    }
    check_part(mass, I, path_, place, warnings_);
    return moved(X_BL * sdf_pose(inertial->find("pose")), {mass, Vector3::Zero(), I});
  }

  Joint read_joint(const SdfJoint& source, const Pose& X_MB) {
    Joint joint;
    joint.name = source.name;
    joint.axis = (X_MB.linear().transpose() * source.axis_M).normalized();
    const SdfElement* axis = source.element->find("axis");
    if (axis == nullptr || axis->find("xyz") == nullptr)
      warnings_.count("took SDF's default of z for the axis of ", " joint(s) that say none",
                      sdf_place(*source.element, path_));
    if (axis != nullptr) {
      if (const SdfElement* limit = axis->find("limit"))
        read_limits(*limit, source, axis->find("mimic") != nullptr, joint);
      if (const SdfElement* dynamics = axis->find("dynamics")) {
        joint.damping = sdf_number(*dynamics, "damping", 0);
        joint.friction = sdf_number(*dynamics, "friction", 0);
        joint.stiffness = sdf_number(*dynamics, "spring_stiffness", 0);
        const double reference = sdf_number(*dynamics, "spring_reference", 0);
        joint.spring_reference = joint.stiffness != 0 ? reference : 0;
      }
      if (const SdfElement* mimic = axis->find("mimic")) {
        read_mimic(*mimic, joint.name);
      }
    }
    check_joint(joint, path_);
    return joint;
  }

  /// Angle = multiplier (leader's - reference) + offset (SDF 1.11).
  void read_mimic(const SdfElement& mimic, const std::string& follower) {
    NamedCoupling coupling;
    coupling.follower = follower;
    coupling.leader = mimic.attribute("joint");
    if (const std::string axis = mimic.attribute("axis"); !axis.empty() && axis != "axis")
      fail_at(mimic, "the one axis of its joint", fmt::format("axis '{}'", printable_text(axis, 200)));
    const bool is_moving = std::ranges::any_of(model_.joints, [&](const SdfJoint& other) {
      return other.name == coupling.leader && other.name != follower && other.type != "fixed";
    });
    if (!is_moving)
      fail_at(mimic, "another joint of this model that moves",
              fmt::format("'{}'", printable_text(coupling.leader, 200)));
    const double multiplier = sdf_number(mimic, "multiplier", 1);
    coupling.coefficients = {sdf_number(mimic, "offset", 0) - multiplier * sdf_number(mimic, "reference", 0),
                             multiplier};
    coupling.place = fmt::format("mimic (line {})", mimic.line);
    robot_.couplings.push_back(std::move(coupling));
  }

  void read_limits(const SdfElement& limit, const SdfJoint& source, bool follows, Joint& joint) {
    const double infinity = std::numeric_limits<double>::infinity();
    const double lower = sdf_bound(limit, "lower", -infinity), upper = sdf_bound(limit, "upper", infinity);
    const bool is_bounded = std::isfinite(lower) || std::isfinite(upper);
    if (source.type == "revolute" && is_bounded)
      set_limits(lower, upper, follows, sdf_place(*source.element, path_), joint, warnings_);
    const double effort = sdf_bound(limit, "effort", -1);
    joint.effort_limit = std::isfinite(effort) ? std::max(0.0, effort) : 0;
    keep_velocity_limit(sdf_bound(limit, "velocity", -1), joint.name, robot_.velocity_limits);
    limit.pass_over("stiffness", {"1e8", "1e+08", "100000000"});
    limit.pass_over("dissipation", {"1", "1.0"});
  }

  void close_loops_of(const SdfJoints& joints) {
    for (const SdfJoint* joint : joints.of_loops) {
      if (!robot_.links.contains(joint->parent) || !robot_.links.contains(joint->child)) continue;
      const Vector3 p = joint->X_MJ.translation();
      robot_.loops.push_back({joint->name, joint->parent, joint->child,
                              links_.at(joint->parent)->X_ML.inverse() * p,
                              links_.at(joint->child)->X_ML.inverse() * p});
      joint->element->pass_over("axis");
      warnings_.count(
          "closed a loop at the place of ",
          " joint(s) of links that hang on another one already; axis, limits, damping and friction "
          "there are not simulated",
          sdf_place(*joint->element, path_));
    }
  }

  const std::string& path_;
  const SdfModel& model_;
  ReaderWarnings& warnings_;
  SdfShapes shapes_;
  std::map<std::string, const SdfLink*> links_;
  std::map<std::string, std::vector<const SdfJoint*>> children_;  ///< by the parent link
  std::vector<Pose> frames_;                                      ///< of the bodies in the model
  ParsedRobot robot_;
};

/// A model of the file and the world that it is in, if any.
struct FoundModel {
  const SdfElement* model;
  const SdfElement* world;
};

bool has_moving_joint(const SdfElement& model) {
  return std::ranges::any_of(model.children, [](const SdfElement& e) {
    return e.tag == "joint" ? e.attribute("type") != "fixed" : e.tag == "model" && has_moving_joint(e);
  });
}

bool is_static(const SdfElement& model) {
  return std::ranges::any_of(model.children, [](const SdfElement& e) {
    return e.tag == "static" && (e.text == "true" || e.text == "1");
  });
}

FoundModel find_robot(const SdfDocument& document, ReaderWarnings& warnings) {
  std::vector<FoundModel> found;
  std::vector<std::string> names, static_ones;
  const auto look_at = [&](const SdfElement& parent, const SdfElement* world) {
    for (const SdfElement* model : parent.all("model")) {
      const std::string name = fmt::format("'{}'", printable_text(model->attribute("name"), 200));
      if (!has_moving_joint(*model) || is_static(*model)) {
        if (has_moving_joint(*model)) static_ones.push_back(name);
        warnings.count("left out ", " <model> beside the robot", sdf_place(*model, document.path()));
        continue;
      }
      names.push_back(name);
      found.push_back({model, world});
    }
  };
  look_at(document.root(), nullptr);
  for (const SdfElement* world : document.root().all("world")) look_at(*world, world);
  if (found.size() == 1) return found.front();
  if (found.empty())
    throw ConfigError(document.path(), "sdf", "a model with joints that is not <static>",
                      static_ones.empty() ? "none" : fmt::format("{}", fmt::join(static_ones, ", ")));
  throw ConfigError(document.path(), "sdf", "one model with joints: the others in files of their own",
                    fmt::format("{}", fmt::join(names, ", ")));
}

ParsedRobot read_model(const std::string& path, ReaderWarnings& warnings) {
  const SdfDocument document(path, warnings);
  const FoundModel found = find_robot(document, warnings);
  if (found.model->find("pose") != nullptr)
    sdf_pose(found.model->find("pose"));  // the world's, but no nonsense
  const SdfModel model = resolve_model(*found.model);
  pass_over_usual(model);
  ParsedRobot robot = SdfTreeBuilder(path, model, warnings).build();
  if (found.world != nullptr) {
    std::map<std::string, ContactNumbers> shapes = std::move(robot.contact.shapes);
    robot.contact = read_world(*found.world);
    robot.contact.shapes = std::move(shapes);
  }
  robot.contact.ground = "any ground, as the lesser mu is Gazebo's";
  read_servos_of(model, path, robot, warnings);
  for (NamedCoupling& coupling : robot.couplings) {
    coupling.is_driven = std::ranges::any_of(robot.bodies, [&](const Body& body) {
      return body.joint.name == coupling.follower && body.joint.kp > 0;
    });
  }
  count_unread(*found.model, path, warnings);
  robot.warnings = warnings.sentences();
  return robot;
}

}  // namespace

ParsedRobot read_sdf(const std::string& path) {
  ReaderWarnings warnings;
  try {
    return read_model(path, warnings);
  } catch (const ConfigError& error) {
    throw with_cause(error, warnings.sentences());
  }
}

}  // namespace crossgait
