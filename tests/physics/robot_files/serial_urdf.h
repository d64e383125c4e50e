// A quadruped with serial legs as the text of a URDF, to be changed at will.
#pragma once

#include <cmath>
#include <functional>
#include <string>

#include <fmt/format.h>

#include "physics/core/math.h"
#include "physics/robot/leg.h"

namespace crossgait {

/// Has hips 0.4 m apart along and 0.1 m across, legs of 0.08 m aside and twice 0.2 m down, feet of radius
/// 0.02 m; 1 kg a link and a trunk of 8 kg whose centre of mass is 0.03 m ahead.
struct SerialUrdf {
  bool abduction = true;
  Vector3 abduction_axis = Vector3::UnitX(), hip_axis = Vector3::UnitY();
  std::string knee_limits = R"(lower="-2.6" upper="-0.5" effort="30" velocity="1")";
  std::string foot_shape = R"(<sphere radius="0.02"/>)";  ///< empty: none
  Vector3 foot_at = {0, 0, -0.2};                         ///< from the knee, or the ankle, m
  /// Attributes of `<mimic>` of knees, and of ankles, which there are none without them; {0} is the prefix.
  std::string knee_mimic, ankle_mimic;
  std::string more;  ///< before </robot>
  /// Names of the legs' joints begin with it.
  std::function<std::string(Leg)> prefix = [](Leg leg) { return std::string(name(leg)); };
  /// Columns: the robot's forward, left and up in the file's axes.
  Matrix3 R = Matrix3::Identity();

  std::string text() const {
    std::string out = "<robot name=\"made\">\n" + link("trunk", 8, {0.03, 0, 0}, "");
    for (const Leg leg : kLegs) out += leg_text(leg);
    return out + more + "</robot>\n";
  }

  static std::string inertia(double mass, const Vector3& at) {
    return fmt::format(
        "<inertial><origin xyz=\"{} {} {}\"/><mass value=\"{}\"/>"
        "<inertia ixx=\"0.02\" iyy=\"0.03\" izz=\"0.04\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>",
        at.x(), at.y(), at.z(), mass);
  }
  std::string link(const std::string& name, double mass, const Vector3& at,
                   const std::string& collision) const {
    return fmt::format("<link name=\"{}\">{}{}</link>\n", name, inertia(mass, R * at),
                       collision.empty() ? "" : "<collision>" + collision + "</collision>");
  }
  std::string joint(const std::string& name, const std::string& parent, const std::string& child,
                    const Vector3& at, const Vector3& axis, const std::string& limits) const {
    const Vector3 p = R * at, a = R * axis;
    return fmt::format(
        "<joint name=\"{}\" type=\"revolute\"><parent link=\"{}\"/><child link=\"{}\"/>"
        "<origin xyz=\"{} {} {}\"/><axis xyz=\"{} {} {}\"/><limit {}/></joint>\n",
        name, parent, child, p.x(), p.y(), p.z(), a.x(), a.y(), a.z(), limits);
  }

 private:
  std::string leg_text(Leg leg) const {
    const std::string p = prefix(leg), usual = R"(lower="-2" upper="3" effort="20" velocity="1")";
    const Vector3 hip(is_front(leg) ? 0.2 : -0.2, 0.05 * side_sign(leg), 0),
        aside(0, 0.08 * side_sign(leg), 0);
    std::string out;
    if (abduction) {
      out += link(p + "_hip", 1, Vector3::Zero(), "");
      out += joint(p + "_abduction", "trunk", p + "_hip", hip, abduction_axis, usual);
      out += joint(p + "_pitch", p + "_hip", p + "_thigh", aside, hip_axis, usual);
    } else {
      out += joint(p + "_pitch", "trunk", p + "_thigh", hip + aside, hip_axis, usual);
    }
    const Vector3 foot = R * foot_at;
    const std::string shape = foot_shape.empty()
                                  ? ""
                                  : fmt::format("<origin xyz=\"{} {} {}\"/><geometry>{}</geometry>", foot.x(),
                                                foot.y(), foot.z(), foot_shape);
    out += link(p + "_thigh", 1, {0, 0, -0.1}, "");
    out += link(p + "_shin", 1, {0, 0, -0.1}, ankle_mimic.empty() ? shape : "");
    out +=
        mimicking(joint(p + "_knee", p + "_thigh", p + "_shin", {0, 0, -0.2}, Vector3::UnitY(), knee_limits),
                  knee_mimic, p);
    if (ankle_mimic.empty()) return out;
    out += link(p + "_toe", 0.2, {0, 0, -0.05}, shape);
    return out +
           mimicking(joint(p + "_ankle", p + "_shin", p + "_toe", {0, 0, -0.2}, Vector3::UnitY(), usual),
                     ankle_mimic, p);
  }

  static std::string mimicking(std::string joint, const std::string& attributes, const std::string& prefix) {
    if (attributes.empty()) return joint;
    const std::string mimic = fmt::format("<mimic {}/>", fmt::format(fmt::runtime(attributes), prefix));
    return joint.insert(joint.rfind("</joint>"), mimic);
  }
};

}  // namespace crossgait
