#include "crossgait/physics/urdf_reader.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <set>

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <urdf_parser/urdf_parser.h>

#include "crossgait/physics/error.h"
#include "crossgait/physics/robot_check.h"
#include "crossgait/physics/text.h"
#include "crossgait/physics/urdf_check.h"

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
  static std::mutex mutex;  // console_bridge has one output handler per process
  const std::lock_guard lock(mutex);
  const ErrorCapture capture;
  urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(text);
  if (!model || !capture.errors().empty()) {
    throw ConfigError(path, "robot", "a URDF that urdfdom accepts", capture.errors());
  }
  return model;
}

Vector3 to_vector(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

Pose to_pose(const urdf::Pose& pose) {
  const urdf::Rotation& r = pose.rotation;
  return make_pose(Quaternion(r.w, r.x, r.y, r.z).normalized(), to_vector(pose.position));
}

/// Mass properties of a rigid pair (parallel-axis theorem).
SpatialInertia combine(const SpatialInertia& a, const SpatialInertia& b) {
  if (a.mass == 0) return b;
  SpatialInertia sum;
  sum.mass = a.mass + b.mass;
  sum.p_BC = (a.mass * a.p_BC + b.mass * b.p_BC) / sum.mass;
  for (const SpatialInertia* part : {&a, &b}) {
    const Vector3 d = part->p_BC - sum.p_BC;
    sum.I_C += part->I_C + part->mass * (d.squaredNorm() * Matrix3::Identity() - d * d.transpose());
  }
  return sum;
}

class TreeBuilder {
 public:
  explicit TreeBuilder(std::string path) : path_(std::move(path)) {}

  UrdfRobot build(const urdf::Link& root) {
    add_body(root, -1, Pose::Identity());
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
    if (robot_.bodies[static_cast<std::size_t>(index)].inertia.mass == 0) {
      throw ConfigError(path_, fmt::format("link '{}'", link.name), "an <inertial> element on a moving link",
                        "none");
    }
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
      robot_.links[link.name] = {index, next.X_PB, add_shapes(link, next.X_PB, body)};
      for (auto joint = link.child_joints.rbegin(); joint != link.child_joints.rend(); ++joint) {
        const urdf::Joint& j = **joint;
        const auto child = std::find_if(link.child_links.begin(), link.child_links.end(),
                                        [&](const auto& l) { return l->name == j.child_link_name; });
        waiting.push_back({child->get(), next.X_PB * to_pose(j.parent_to_joint_origin_transform),
                           j.type != urdf::Joint::FIXED});
      }
    }
  }

  SpatialInertia read_inertia(const urdf::Link& link, const Pose& X_BL) const {
    const urdf::Inertial& in = *link.inertial;
    const Pose X_BI = X_BL * to_pose(in.origin);
    Matrix3 I;
    I << in.ixx, in.ixy, in.ixz, in.ixy, in.iyy, in.iyz, in.ixz, in.iyz, in.izz;
    SpatialInertia inertia{in.mass, X_BI.translation(), I};
    check_inertia(inertia, path_, fmt::format("link '{}'", link.name));
    inertia.I_C = X_BI.linear() * I * X_BI.linear().transpose();
    inertia.I_C = 0.5 * (inertia.I_C + inertia.I_C.transpose()).eval();  // exactly symmetric despite rounding
    return inertia;
  }

  std::vector<int> add_shapes(const urdf::Link& link, const Pose& X_BL, Body& body) {
    std::vector<int> indices;
    for (const urdf::CollisionSharedPtr& collision : link.collision_array) {
      CollisionShape shape;
      shape.name = collision->name.empty() ? fmt::format("{}_collision_{}", link.name, indices.size())
                                           : collision->name;
      shape.X_BG = X_BL * to_pose(collision->origin);
      const urdf::Geometry& geometry = *collision->geometry;
      if (geometry.type == urdf::Geometry::SPHERE) {
        shape.type = ShapeType::kSphere;
        shape.size = {static_cast<const urdf::Sphere&>(geometry).radius, 0, 0};
      } else if (geometry.type == urdf::Geometry::BOX) {
        shape.type = ShapeType::kBox;
        shape.size = to_vector(static_cast<const urdf::Box&>(geometry).dim) / 2;
      } else {  // check_urdf has let nothing else pass
        const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
        shape.type = ShapeType::kCylinder;
        shape.size = {cylinder.radius, cylinder.length / 2, 0};
      }
      const std::string element = fmt::format("link '{}', collision '{}'", link.name, shape.name);
      if (!shape_names_.insert(shape.name).second) {
        throw ConfigError(path_, element, "a unique name", "a second one");
      }
      check_shape(shape, path_, element);
      indices.push_back(static_cast<int>(body.shapes.size()));
      body.shapes.push_back(std::move(shape));
    }
    return indices;
  }

  Joint read_joint(const urdf::Joint& source) const {
    Joint joint;
    joint.name = source.name;
    const auto fail = [&](std::string_view expected, std::string_view found) {
      throw ConfigError(path_, fmt::format("joint '{}'", joint.name), expected, found);
    };
    const Vector3 axis = to_vector(source.axis);
    if (axis.norm() < 1e-6) {  // far below any rounding of a unit axis
      fail("an axis of non-zero length", fmt::format("({}, {}, {})", axis.x(), axis.y(), axis.z()));
    }
    joint.axis = axis.normalized();
    if (source.type == urdf::Joint::REVOLUTE) {
      joint.lower = source.limits->lower;
      joint.upper = source.limits->upper;
    }
    if (source.limits) joint.effort_limit = source.limits->effort;
    if (source.dynamics) {
      joint.damping = source.dynamics->damping;
      if (source.dynamics->friction != 0) {
        fail("joint friction 0 (it is not simulated)", fmt::format("{}", source.dynamics->friction));
      }
    }
    check_joint(joint, path_);
    return joint;
  }

  std::string path_;
  UrdfRobot robot_;
  std::set<std::string> shape_names_;
};

}  // namespace

UrdfRobot read_urdf(const std::string& path) {
  const std::string text = read_text_file(path, kUrdfBudget);
  check_urdf(text, path);
  return TreeBuilder(path).build(*parse(text, path)->getRoot());
}

}  // namespace crossgait
