// A robot that was read from another format as the text of an SDF.
#pragma once

#include <map>
#include <string>

#include <fmt/format.h>

#include "physics/core/math.h"
#include "physics/robot_files/parsed_robot.h"

namespace crossgait {

/// Says how poses are written: all in the model, or link on joint on link, as converters of URDF do.
enum class SdfStyle { kInModel, kRelative };

/// Writes what a ParsedRobot has of links, joints, masses and shapes but meshes, each number in full, drawn
/// with its joints at `angles` (rad; zero if not given), from where an SDF counts.
class SdfOf {
 public:
  explicit SdfOf(const ParsedRobot& robot, SdfStyle style, std::map<std::string, double> angles = {})
      : robot_(robot), style_(style), angles_(std::move(angles)) {
    for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
      const Body& body = robot.bodies[i];
      if (i == 0) {
        X_M_.push_back(Pose::Identity());
        continue;
      }
      const auto angle = angles_.find(body.joint.name);
      const double q = angle == angles_.end() ? 0 : angle->second;
      X_M_.push_back(X_M_[static_cast<std::size_t>(body.parent)] * body.X_PB *
                     Eigen::AngleAxisd(q, body.joint.axis));
    }
  }

  /// @param more  before all joints
  std::string text(const std::string& more = "") const {
    std::string out = fmt::format("<sdf version=\"1.9\">\n<model name=\"{}\">\n", robot_.name);
    for (const auto& [name, place] : robot_.links) out += link(name, place);
    out += more;
    for (std::size_t i = 1; i < robot_.bodies.size(); ++i) out += joint(i);
    return out + "</model>\n</sdf>\n";
  }

  static std::string pose(const Pose& X, const std::string& relative_to = "") {
    const Quaternion q(X.linear());
    const Vector3 p = X.translation();
    return fmt::format("<pose{} rotation_format=\"quat_xyzw\">{} {} {} {} {} {} {}</pose>",
                       relative_to.empty() ? "" : " relative_to=\"" + relative_to + "\"", p.x(), p.y(), p.z(),
                       q.x(), q.y(), q.z(), q.w());
  }

 private:
  const Body& body(int i) const { return robot_.bodies[static_cast<std::size_t>(i)]; }
  Pose in_model(const LinkPlacement& place) const {
    return X_M_[static_cast<std::size_t>(place.body)] * place.X_BL;
  }

  std::string link(const std::string& name, const LinkPlacement& place) const {
    const Body& of = body(place.body);
    const bool is_own = of.name == name;
    const SpatialInertia inertia = is_own ? of.inertia : SpatialInertia();
    Pose X_LC = Pose::Identity();
    X_LC.translation() = inertia.p_BC;
    std::string where = pose(in_model(place));
    if (style_ == SdfStyle::kRelative && !is_own) where = pose(place.X_BL, of.name);
    if (style_ == SdfStyle::kRelative && is_own && of.parent >= 0)
      where = pose(Pose::Identity(), of.joint.name);
    std::string out = fmt::format("<link name=\"{}\">{}<inertial>{}<mass>{}</mass><inertia>", name, where,
                                  pose(X_LC), inertia.mass);
    const Matrix3& I = inertia.I_C;
    out += fmt::format("<ixx>{}</ixx><ixy>{}</ixy><ixz>{}</ixz><iyy>{}</iyy><iyz>{}</iyz><izz>{}</izz>",
                       I(0, 0), I(0, 1), I(0, 2), I(1, 1), I(1, 2), I(2, 2));
    out += "</inertia></inertial>\n";
    for (const int i : place.shapes) out += collision(of.shapes[static_cast<std::size_t>(i)], place.X_BL);
    return out + "</link>\n" + (is_own ? "" : weld(name, of.name));
  }

  static std::string collision(const CollisionShape& shape, const Pose& X_BL) {
    const Vector3& s = shape.size;
    std::string geometry;
    if (shape.type == ShapeType::kSphere)
      geometry = fmt::format("<sphere><radius>{}</radius></sphere>", s[0]);
    if (shape.type == ShapeType::kBox)
      geometry = fmt::format("<box><size>{} {} {}</size></box>", 2 * s[0], 2 * s[1], 2 * s[2]);
    if (shape.type == ShapeType::kCylinder || shape.type == ShapeType::kCapsule)
      geometry = fmt::format("<{0}><radius>{1}</radius><length>{2}</length></{0}>", name_of(shape.type), s[0],
                             2 * s[1]);
    return fmt::format("<collision name=\"{}\">{}<geometry>{}</geometry></collision>\n", shape.name,
                       pose(X_BL.inverse() * shape.X_BG), geometry);
  }
  static std::string_view name_of(ShapeType type) { return crossgait::name(type); }

  static std::string weld(const std::string& link, const std::string& on) {
    return fmt::format(
        "<joint name=\"weld_{0}\" type=\"fixed\"><parent>{1}</parent><child>{0}</child></joint>\n", link, on);
  }

  std::string joint(std::size_t i) const {
    const Body& of = robot_.bodies[i];
    const Joint& j = of.joint;
    const std::string& parent = body(of.parent).name;
    Pose X_PJ = X_M_[static_cast<std::size_t>(of.parent)].inverse() * X_M_[i];
    std::string limits;
    if (j.limited) {
      const auto angle = angles_.find(j.name);
      const double zero = angle == angles_.end() ? 0 : angle->second;
      limits = fmt::format("<lower>{}</lower><upper>{}</upper>", j.lower - zero, j.upper - zero);
    }
    return fmt::format(
        "<joint name=\"{}\" type=\"revolute\">{}<parent>{}</parent><child>{}</child><axis><xyz>{} {} {}</xyz>"
        "<limit>{}<effort>{}</effort></limit><dynamics><damping>{}</damping><friction>{}</friction></"
        "dynamics>"
        "</axis></joint>\n",
        j.name, style_ == SdfStyle::kRelative ? pose(X_PJ, parent) : "", parent, of.name, j.axis.x(),
        j.axis.y(), j.axis.z(), limits, j.effort_limit, j.damping, j.friction);
  }

  const ParsedRobot& robot_;
  SdfStyle style_;
  std::map<std::string, double> angles_;
  std::vector<Pose> X_M_;  ///< of the bodies
};

}  // namespace crossgait
