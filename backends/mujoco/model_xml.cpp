#include "backends/mujoco/model_xml.h"

#include <algorithm>
#include <iterator>
#include <string_view>

#include <fmt/format.h>

#include "backends/mujoco/version.h"
#include "physics/engine/contact_features.h"
#include "physics/robot/actuator.h"
#include "physics/robot/principal_inertia.h"
#include "physics/robot/state.h"

namespace crossgait::mujoco {
namespace {

// Bit masks: the robot collides with the terrain and with nothing else.
constexpr int kTerrainBit = 1;
constexpr int kRobotBit = 2;
// mj_ray's geometry groups, so that a height query sees terrain alone.
constexpr int kTerrainGroup = 0;
constexpr int kRobotGroup = 1;

class Xml {
 public:
  template <typename... Args>
  void add(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Args>(args)...);
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

std::string numbers(const Vector3& v) { return fmt::format("{:.17g} {:.17g} {:.17g}", v.x(), v.y(), v.z()); }

std::string quaternion(const Pose& X) {
  const Quaternion q(X.linear());
  return fmt::format("{:.17g} {:.17g} {:.17g} {:.17g}", q.w(), q.x(), q.y(), q.z());
}

std::string placement(const Pose& X) {
  return fmt::format("pos='{}' quat='{}'", numbers(X.translation()), quaternion(X));
}

// @param suffix of the attributes' names: "", "friction" or "limit"
std::string softness(const Softness& s, std::string_view suffix = "") {
  return fmt::format("solref{}='{:.17g} {:.17g}' solimp{}='{:.17g} {:.17g} {:.17g} {:.17g} {:.17g}'", suffix,
                     s.time_constant, s.damping_ratio, suffix, s.impedance_min, s.impedance_max,
                     s.impedance_width, s.impedance_midpoint, s.impedance_power);
}

std::string contact_attributes(const ContactSpec& contact, int type, int affinity, int group) {
  const bool twists = contact.condim >= 4, rolls = contact.condim >= 6;
  return fmt::format(
      "contype='{}' conaffinity='{}' group='{}' condim='{}' friction='{:.17g} {:.17g} {:.17g}' {}", type,
      affinity, group, contact.condim, contact.friction, twists ? contact.torsional_friction : 0,
      rolls ? contact.rolling_friction : 0, softness(contact.softness));
}

std::string shape_geometry(const CollisionShape& shape) {
  switch (shape.type) {
    case ShapeType::kSphere:
      return fmt::format("type='sphere' size='{:.17g}'", shape.size.x());
    case ShapeType::kBox:
      return fmt::format("type='box' size='{}'", numbers(shape.size));
    case ShapeType::kCylinder:
      return fmt::format("type='cylinder' size='{:.17g} {:.17g}'", shape.size.x(), shape.size.y());
    case ShapeType::kCapsule:
      return fmt::format("type='capsule' size='{:.17g} {:.17g}'", shape.size.x(), shape.size.y());
    case ShapeType::kHull: {
      // Its vertices touch (terrain_collision.h): all that MuJoCo needs is how far they reach.
      Vector3 reach = Vector3::Zero();
      for (const Vector3& vertex : shape.vertices) reach = reach.cwiseMax(vertex.cwiseAbs());
      return fmt::format("type='box' size='{}'", numbers(reach.cwiseMax(1e-6)));
    }
  }
  return {};
}

void add_terrain(Xml& xml, const WorldSpec& spec) {
  const std::string contact = contact_attributes(spec.contact, kTerrainBit, kRobotBit, kTerrainGroup);
  if (const HeightField* field = spec.terrain.field()) {
    // Heights are stored relative to the lowest point: MuJoCo's ray test takes the field to start at its
    // base.
    xml.add("<geom name='terrain' type='hfield' hfield='terrain' pos='0 0 {:.17g}' {}/>", field->min(),
            contact);
  } else {
    xml.add("<geom name='terrain' type='plane' size='0 0 1' {}/>", contact);
  }
}

// A pose in the body `index` of the description, as MuJoCo's body has it.
Pose from_origin(const RobotDescription& robot, int index, const Pose& X) {
  Pose result = X;
  result.translation() -= body_origin(robot, index);
  return result;
}

void add_body(Xml& xml, const WorldSpec& spec, int index) {
  const RobotDescription& robot = *spec.robot;
  const Body& body = robot.bodies[static_cast<std::size_t>(index)];
  // The base's own place is set by reset.
  xml.add("<body name='{}' {}>", body_name(index),
          placement(index > 0 ? from_origin(robot, body.parent, body.X_PB) : Pose::Identity()));
  if (index > 0) {
    const Joint& joint = body.joint;
    xml.add(
        "<joint name='{}' type='hinge' axis='{}' armature='{:.17g}' frictionloss='{:.17g}' {} "
        "limited='{}' range='{:.17g} {:.17g}' {}/>",
        joint_name(index - 1), numbers(joint.axis), joint.armature, joint.friction,
        softness(robot.friction_softness, "friction"), joint.limited, joint.lower, joint.upper,
        softness(joint.limit_softness, "limit"));
  } else if (!spec.fixed_base) {
    xml.add("<freejoint/>");
  }
  const PrincipalInertia inertia = principal_inertia(body.inertia);
  xml.add("<inertial {} mass='{:.17g}' diaginertia='{}'/>",
          placement(from_origin(robot, index, inertia.X_BP)), body.inertia.mass, numbers(inertia.moments));
  const std::string contact = contact_attributes(spec.contact, kRobotBit, kTerrainBit, kRobotGroup);
  for (std::size_t k = 0; k < body.shapes.size(); ++k) {
    const CollisionShape& shape = body.shapes[k];
    for (int part = 0; part <= part_of(shape, feature_count(shape) - 1); ++part) {
      xml.add("<geom name='{}' {} {} {}/>", shape_name(index, static_cast<int>(k), part),
              shape_geometry(shape), placement(from_origin(robot, index, shape.X_BG)), contact);
    }
  }
  for (int child = index + 1; child <= robot.joint_count(); ++child) {
    if (robot.bodies[static_cast<std::size_t>(child)].parent == index) add_body(xml, spec, child);
  }
  xml.add("</body>");
}

void add_equalities(Xml& xml, const RobotDescription& robot) {
  if (robot.loops.empty() && robot.couplings.empty()) return;
  xml.add("<equality>");
  for (std::size_t i = 0; i < robot.loops.size(); ++i) {
    const LoopClosure& loop = robot.loops[i];
    xml.add("<connect name='loop{}' body1='{}' body2='{}' anchor='{}' {}/>", i, body_name(loop.body_a),
            body_name(loop.body_b), numbers(loop.p_AP - body_origin(robot, loop.body_a)),
            softness(robot.loop_softness));
  }
  for (const JointCoupling& coupling : robot.couplings) {
    const auto& c = coupling.coefficients;
    xml.add("<joint joint1='{}' joint2='{}' polycoef='{:.17g} {:.17g} {:.17g} {:.17g} {:.17g}' {}/>",
            joint_name(coupling.follower), joint_name(coupling.leader), c[0], c[1], c[2], c[3], c[4],
            softness(coupling.softness));
  }
  xml.add("</equality>");
}

/// An implicit servo is a row of friction in a tendon of one joint: bounded, with a regularisation that at
/// this impedance is the tendon's inverse weight. Its numbers are set in each step (mujoco_backend.cpp).
void add_servo_rows(Xml& xml, const RobotDescription& robot) {
  std::string rows;
  for (const int i : robot.actuated_joints()) {
    if (!is_implicit(robot.joint(i))) continue;
    rows += fmt::format(
        "<fixed name='{}' frictionloss='1' solimpfriction='0.5 0.5 1'><joint joint='{}' coef='1'/></fixed>",
        servo_name(i), joint_name(i));
  }
  if (!rows.empty()) xml.add("<tendon>{}</tendon>", rows);
}

}  // namespace

std::string servo_name(int joint) { return fmt::format("servo{}", joint); }
std::string body_name(int body) { return fmt::format("body{}", body); }
std::string joint_name(int joint) { return fmt::format("joint{}", joint); }
std::string shape_name(int body, int shape, int part) {
  return fmt::format("shape{}_{}_{}", body, shape, part);
}

int part_of(const CollisionShape& shape, int feature) {
  const int contacts = shape.type == ShapeType::kCylinder ? 3 : 1;  // of a feature
  return feature / (kMaxPlaneContacts / contacts);
}

Vector3 body_origin(const RobotDescription& robot, int body) {
  return body == 0 ? robot.bodies[0].inertia.p_BC : Vector3::Zero();
}

double elevation_scale(const HeightField& field) {
  double scale = 1;
  while (scale < field.max() - field.min()) scale *= 2;
  return scale;
}

std::string model_xml(const WorldSpec& spec) {
  Xml xml;
  // Masses and inertias are the description's own; MuJoCo must neither infer, bound nor balance them.
  xml.add(
      "<mujoco><compiler angle='radian' inertiafromgeom='false' balanceinertia='false' boundmass='0' "
      "boundinertia='0' autolimits='false'/>");
  xml.add(
      "<option timestep='{:.17g}' gravity='{}' integrator='Euler' solver='Newton' cone='{}' "
      "jacobian='dense' iterations='{}' tolerance='{:.17g}' impratio='{:.17g}'/>",
      spec.physics_dt, numbers(spec.gravity), name(spec.contact.cone), spec.solver.iterations,
      solver_tolerance(spec.solver.tolerance), spec.contact.impratio);
  // As much room as can be needed (terrain_collision.h) and no more: MuJoCo's own memory grows with the
  // square of the rows, 1 MB of 264.
  const std::size_t loops = spec.robot->loops.size(), couplings = spec.robot->couplings.size();
  const auto joints = static_cast<std::size_t>(spec.robot->joint_count());
  // An elliptic cone has a row for each dimension, a pyramid two for each direction of friction.
  const auto dims = static_cast<std::size_t>(spec.contact.condim);
  const std::size_t rows = spec.contact.cone == FrictionCone::kPyramidal ? 2 * (dims - 1) : dims;
  const auto contacts = static_cast<std::size_t>(
      std::clamp(most_contact_points(*spec.robot, spec.fixed_base), 1, kMaxContacts));
  xml.add("<size nconmax='{}' njmax='{}'/>", contacts, rows * contacts + 3 * loops + couplings + 3 * joints);
  if (const HeightField* field = spec.terrain.field()) {
    // The second figure is the depth of the solid below the lowest point.
    xml.add("<asset><hfield name='terrain' nrow='{}' ncol='{}' size='{:.17g} {:.17g} {:.17g} 0.1'/></asset>",
            field->rows(), field->columns(), field->size_x() / 2, field->size_y() / 2,
            elevation_scale(*field));
  }
  xml.add("<worldbody>");
  add_terrain(xml, spec);
  add_body(xml, spec, 0);
  xml.add("</worldbody>");
  add_servo_rows(xml, *spec.robot);
  add_equalities(xml, *spec.robot);
  xml.add("</mujoco>");
  return xml.take();
}

}  // namespace crossgait::mujoco
