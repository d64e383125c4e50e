// A robot with four legs of any joints as the text of a URDF.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "physics/core/math.h"
#include "physics/robot/leg.h"

namespace crossgait {

/// Describes a joint of a leg and the way from it to the next one, or to the foot.
struct ChainJoint {
  std::string name;
  Vector3 axis;
  Vector3 next;  ///< m, in the base's frame
  double lower = -1, upper = 1;
  bool is_continuous = false;
};

/// Has hips 0.4 m apart along and 0.12 m across.
struct ChainUrdf {
  std::function<std::vector<ChainJoint>(Leg)> joints = usual;
  std::function<std::string(Leg)> prefix = [](Leg leg) { return std::string(name(leg)); };
  std::function<std::string(Leg)> parent = [](Leg) { return std::string("trunk"); };
  std::string foot = "<collision><geometry><sphere radius=\"0.02\"/></geometry></collision>";
  std::string more;

  /// Puts an abduction 0.07 m aside of the hip, thigh and shin of 0.2 m.
  static std::vector<ChainJoint> usual(Leg leg) {
    return {{"abduction", Vector3::UnitX(), {0, 0.07 * side_sign(leg), 0}, -0.9, 0.9},
            {"hip", Vector3::UnitY(), {0, 0, -0.2}, -1.5, 2.5},
            {"knee", Vector3::UnitY(), {0, 0, -0.2}, -2.6, -0.6}};
  }

  static std::string link(const std::string& name, double mass, const std::string& shapes = "") {
    return fmt::format(
        "<link name=\"{}\"><inertial><mass value=\"{}\"/><inertia ixx=\"0.002\" iyy=\"0.002\" izz=\"0.002\" "
        "ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>{}</link>\n",
        name, mass, shapes);
  }
  static std::string joint(const std::string& prefix, const ChainJoint& j, const std::string& parent,
                           const std::string& child, const Vector3& at) {
    return fmt::format(
        "<joint name=\"{}{}\" type=\"{}\"><parent link=\"{}\"/><child link=\"{}\"/><origin xyz=\"{} {} {}\"/>"
        "<axis xyz=\"{} {} {}\"/><limit lower=\"{}\" upper=\"{}\" effort=\"30\" velocity=\"9\"/></joint>\n",
        prefix, j.name, j.is_continuous ? "continuous" : "revolute", parent, child, at.x(), at.y(), at.z(),
        j.axis.x(), j.axis.y(), j.axis.z(), j.lower, j.upper);
  }

  std::string text() const {
    std::string out = "<robot name=\"made\">\n" + link("trunk", 6);
    for (const Leg at : kLegs) {
      const std::string p = prefix(at) + "_";
      Vector3 place(is_front(at) ? 0.2 : -0.2, 0.06 * side_sign(at), 0);
      std::string on = parent(at);
      for (const ChainJoint& j : joints(at)) {
        out += link(p + j.name + "_link", 0.3) + joint(p, j, on, p + j.name + "_link", place);
        on = p + j.name + "_link";
        place = j.next;
      }
      out += link(p + "foot", 0.03, foot);
      out += fmt::format(
          "<joint name=\"{0}sole\" type=\"fixed\"><parent link=\"{1}\"/><child link=\"{0}foot\"/>"
          "<origin xyz=\"{2} {3} {4}\"/></joint>\n",
          p, on, place.x(), place.y(), place.z());
    }
    return out + more + "</robot>\n";
  }
};

}  // namespace crossgait
