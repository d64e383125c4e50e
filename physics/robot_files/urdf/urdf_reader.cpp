#include "physics/robot_files/urdf/urdf_reader.h"

#include <algorithm>
#include <memory>
#include <set>

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <urdf_parser/urdf_parser.h>

#include "physics/core/error.h"
#include "physics/core/text.h"
#include "physics/core/undivided.h"
#include "physics/robot/rigid_pair.h"
#include "physics/robot/robot_check.h"
#include "physics/robot_files/inertia_repair.h"
#include "physics/robot_files/joint_limits.h"
#include "physics/robot_files/reader_warnings.h"
#include "physics/robot_files/urdf/urdf_check.h"
#include "physics/robot_files/urdf/urdf_pose.h"
#include "physics/robot_files/urdf/urdf_shapes.h"

namespace crossgait {
namespace {

/// Collects the errors that urdfdom would print, for as long as it lives.
class ErrorCapture : public console_bridge::OutputHandler {
 public:
  ErrorCapture() { console_bridge::useOutputHandler(this); }
  ~ErrorCapture() override { console_bridge::restorePreviousOutputHandler(); }
  ErrorCapture(const ErrorCapture&) = delete;
  ErrorCapture& operator=(const ErrorCapture&) = delete;
  ErrorCapture(ErrorCapture&&) = delete;
  ErrorCapture& operator=(ErrorCapture&&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char* /*filename*/,
           int /*line*/) override {
    if (level == console_bridge::CONSOLE_BRIDGE_LOG_ERROR) errors_ += (errors_.empty() ? "" : "; ") + text;
  }
  const std::string& errors() const { return errors_; }

 private:
  std::string errors_;
};

urdf::ModelInterfaceSharedPtr parse(const std::string& text, const std::string& path) {
  const Undivided alone;  // console_bridge has one output handler per process
  const ErrorCapture capture;
  urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(text);
  if (!model || !capture.errors().empty()) {
    throw ConfigError(path, "robot", "a URDF that urdfdom accepts", capture.errors());
  }
  return model;
}

class TreeBuilder {
 public:
  TreeBuilder(const std::string& path, const CheckedUrdf& urdf, ReaderWarnings& warnings)
      : path_(path), visuals_(urdf.visuals), warnings_(warnings), shapes_(path, warnings) {
    for (const NamedCoupling& coupling : urdf.couplings) followers_.insert(coupling.follower);
  }

  ParsedRobot build(const urdf::Link& root) {
    add_body(root, -1, Pose::Identity());
    robot_.mesh_vertices = std::move(shapes_.mesh_vertices());
    robot_.warnings = warnings_.sentences();
    return std::move(robot_);
  }

 private:
  void add_body(const urdf::Link& link, int parent, const Pose& X_PB) {
    const auto index = static_cast<int>(robot_.bodies.size());
    Body body;
    body.name = link.name;
    body.parent = parent;
    body.X_PB = X_PB;
    if (link.parent_joint) body.joint = read_joint(*link.parent_joint);
    robot_.bodies.push_back(std::move(body));
    std::vector<PendingChild> children;
    merge_links(link, index, children);
    check_whole(robot_.bodies[static_cast<std::size_t>(index)], link.inertial != nullptr, path_,
                fmt::format("link '{}'", link.name), warnings_);
    for (const PendingChild& child : children) add_body(*child.link, index, child.X_PB);
  }

  struct PendingChild {
    const urdf::Link* link;
    Pose X_PB;
    bool moves;  ///< against its parent
  };

  /// Adds a link and what is fixed to it to a body; links that move against it are appended to `children`.
  /// Depth first, in the file's order, but not by recursion: a thousand links in a chain are a deep stack.
  void merge_links(const urdf::Link& first, int index, std::vector<PendingChild>& children) {
    Body& body = robot_.bodies[static_cast<std::size_t>(index)];
    std::vector<PendingChild> waiting{{&first, Pose::Identity(), false}};
    while (!waiting.empty()) {
      const PendingChild next = waiting.back();
      waiting.pop_back();
      if (next.moves) {
        children.push_back(next);
        continue;
      }
      const urdf::Link& link = *next.link;
      if (link.inertial) body.inertia = combine(body.inertia, read_inertia(link, next.X_PB));
      robot_.links[link.name] = {index, next.X_PB, shapes_.add(link, next.X_PB, body)};
      add_visuals(link.name, next.X_PB, body);
      for (auto joint = link.child_joints.rbegin(); joint != link.child_joints.rend(); ++joint) {
        const urdf::Joint& j = **joint;
        const auto child = std::find_if(link.child_links.begin(), link.child_links.end(),
                                        [&](const auto& l) { return l->name == j.child_link_name; });
        waiting.push_back({child->get(), next.X_PB * to_pose(j.parent_to_joint_origin_transform),
                           j.type != urdf::Joint::FIXED});
      }
    }
  }

  void add_visuals(const std::string& link, const Pose& X_BL, Body& body) const {
    const auto visuals = visuals_.find(link);
    if (visuals == visuals_.end()) return;
    for (VisualShape visual : visuals->second) {
      visual.X_BG = X_BL * visual.X_BG;
      body.visuals.push_back(std::move(visual));
    }
  }

  SpatialInertia read_inertia(const urdf::Link& link, const Pose& X_BL) {
    const urdf::Inertial& in = *link.inertial;
    const Pose X_BI = X_BL * to_pose(in.origin);
    Matrix3 I;
    I << in.ixx, in.ixy, in.ixz, in.ixy, in.iyy, in.iyz, in.ixz, in.iyz, in.izz;
    check_part(in.mass, I, path_, fmt::format("link '{}'", link.name), warnings_);
    return moved(X_BI, {in.mass, Vector3::Zero(), I});
  }

  Joint read_joint(const urdf::Joint& source) {
    Joint joint;
    joint.name = source.name;
    const std::string element = fmt::format("joint '{}'", joint.name);
    const Vector3 axis = to_vector(source.axis);
    if (axis.norm() < 1e-6) {  // far below any rounding of a unit axis
      throw ConfigError(path_, element, "an axis of non-zero length",
                        fmt::format("({}, {}, {})", axis.x(), axis.y(), axis.z()));
    }
    joint.axis = axis.normalized();
    if (source.type == urdf::Joint::REVOLUTE)
      set_limits(source.limits->lower, source.limits->upper, followers_.contains(joint.name), element, joint,
                 warnings_);
    if (source.limits) {
      joint.effort_limit = std::max(0.0, source.limits->effort);
      keep_velocity_limit(source.limits->velocity, joint.name, robot_.velocity_limits);
    }
    if (source.dynamics) {
      joint.damping = source.dynamics->damping;
      joint.friction = source.dynamics->friction;
    }
    check_joint(joint, path_);
    return joint;
  }

  const std::string& path_;
  const std::map<std::string, std::vector<VisualShape>>& visuals_;
  ReaderWarnings& warnings_;
  UrdfShapes shapes_;
  std::set<std::string> followers_;  ///< joints that follow others
  ParsedRobot robot_;
};

void add_extensions(const UrdfExtensions& extensions, const std::string& path, ParsedRobot& robot) {
  robot.unused = extensions.unused;
  robot.contact.ground = extensions.ground;
  for (const auto& [link, numbers] : extensions.surfaces) {
    const auto place = robot.links.find(link);
    if (place == robot.links.end()) continue;  // a root that stood for the world
    const Body& body = robot.bodies[static_cast<std::size_t>(place->second.body)];
    for (const int shape : place->second.shapes)
      robot.contact.shapes[body.shapes[static_cast<std::size_t>(shape)].name] = numbers;
  }
  for (Body& body : robot.bodies) {
    const auto spring = extensions.springs.find(body.joint.name);
    if (spring == extensions.springs.end() || spring->second.stiffness == 0) continue;
    body.joint.stiffness = spring->second.stiffness;
    body.joint.spring_reference = spring->second.reference;
    check_joint(body.joint, path);
  }
}

}  // namespace

ParsedRobot read_urdf(const std::string& path) {
  return read_urdf_text(read_text_file(path, kUrdfBudget), path);
}

ParsedRobot read_urdf_text(const std::string& text, const std::string& path) {
  ReaderWarnings warnings;
  const CheckedUrdf checked = check_urdf(text, path, warnings);
  const urdf::ModelInterfaceSharedPtr model = parse(checked.text, path);
  ParsedRobot robot = TreeBuilder(path, checked, warnings).build(*model->getRoot());
  robot.name = model->getName();
  robot.couplings = checked.couplings;
  add_extensions(checked.extensions, path, robot);
  return robot;
}

}  // namespace crossgait
