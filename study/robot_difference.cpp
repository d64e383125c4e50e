#include "study/robot_difference.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "physics/core/table.h"
#include "physics/robot/actuator.h"
#include "physics/robot/hips.h"
#include "physics/robot/joint_numbers.h"
#include "physics/robot/multibody.h"
#include "study/link_box.h"

namespace crossgait {
namespace {

constexpr double kAlike = 0.01;
constexpr double kNoTarget = 1e6;  // rad, beyond any range
constexpr double kNothing = 1e-9;  // in any unit here: two numbers that are both none

/// A robot at home, with what is measured in it.
struct AtHome {
  explicit AtHome(const RobotDescription& description)
      : robot(description), poses(home_poses(robot)), middle(hip_middle(robot)) {}
  const Body& body(int joint) const { return robot.bodies[static_cast<std::size_t>(joint) + 1]; }
  const Pose& pose(int joint) const { return poses[static_cast<std::size_t>(joint) + 1]; }

  const RobotDescription& robot;
  std::vector<Pose> poses;
  Vector3 middle;  ///< of the hips, m: a base's own origin is anywhere
};

/// The largest distance between two points of what collides of a body, m; 0 of nothing.
double length_of(const Body& body) {
  LinkOutline outline;
  for (const CollisionShape& shape : body.shapes) outline.add(shape);
  return outline.length();
}

class DifferenceFinder {
 public:
  DifferenceFinder(const RobotDescription& a, const RobotDescription& b)
      : a_(a), b_(b), length_(std::max(a.standing_height, b.standing_height)) {}

  RobotDifference find() {
    const RobotDescription &a = a_.robot, &b = b_.robot;
    add("robot", "mass", "kg", a.total_mass(), b.total_mass());
    add("robot", "base mass", "kg", a.bodies[0].inertia.mass, b.bodies[0].inertia.mass);
    add("robot", "standing height", "m", a.standing_height, b.standing_height);
    add("robot", "servos", "", static_cast<double>(a.actuated_joints().size()),
        static_cast<double>(b.actuated_joints().size()));
    add("robot", "couplings", "", static_cast<double>(a.couplings.size()),
        static_cast<double>(b.couplings.size()));
    add("robot", "loops", "", static_cast<double>(a.loops.size()), static_cast<double>(b.loops.size()));
    if (!a.loops.empty() && !b.loops.empty()) {
      add("loops", "solref", "s", a.loop_softness.time_constant, b.loop_softness.time_constant);
      add("loops", "solimp", "-", a.loop_softness.impedance_max, b.loop_softness.impedance_max);
    }
    add("base", "collision shapes", "", static_cast<double>(a.bodies[0].shapes.size()),
        static_cast<double>(b.bodies[0].shapes.size()));
    add("base", "length of the collision shapes", "m", length_of(a.bodies[0]), length_of(b.bodies[0]),
        length_);
    add_place("base", "origin from the middle of the hips", -a_.middle, -b_.middle);
    add_place("base", "centre of mass", a_.poses[0] * a.bodies[0].inertia.p_BC - a_.middle,
              b_.poses[0] * b.bodies[0].inertia.p_BC - b_.middle);
    add_contact();
    if (a.legs && b.legs) {
      for (const Leg leg : kLegs) add_leg(leg);
    }
    return std::move(difference_);
  }

 private:
  /// @param scale  of which a hundredth is alike, where it is larger than the numbers
  void add(const std::string& of, std::string_view name, std::string_view unit, double a, double b,
           double scale = 0) {
    if (std::abs(a - b) <= std::max(kNothing, kAlike * std::max({std::abs(a), std::abs(b), scale}))) {
      ++difference_.alike;
    } else {
      difference_.unlike.push_back({of, std::string(name), std::string(unit), a, b});
    }
  }

  void add_place(const std::string& of, const std::string& name, const Vector3& a, const Vector3& b) {
    for (const int axis : {0, 1, 2})
      add(of, fmt::format("{} at home, {}", name, "xyz"[axis]), "m", a[axis], b[axis], length_);
  }

  void add_contact() {
    const ContactSpec a = resolve_contact(a_.robot.contact, {}, a_.robot.source),
                      b = resolve_contact(b_.robot.contact, {}, b_.robot.source);
    for (const ContactSetting& setting : contact_settings()) {
      const std::vector<double> of_a = setting.get(a), of_b = setting.get(b);
      for (std::size_t i = 0; i < std::min(of_a.size(), of_b.size()); ++i)
        add("contact", of_a.size() == 1 ? std::string(setting.name) : fmt::format("{} {}", setting.name, i),
            setting.unit, of_a[i], of_b[i]);
    }
  }

  void add_leg(Leg leg) {
    const LegModel &a = (*a_.robot.legs)[leg], &b = (*b_.robot.legs)[leg];
    add(fmt::format("{} foot", name(leg)), "radius", "m", a.foot_radius, b.foot_radius);
    add(fmt::format("{} foot", name(leg)), "distance from its joint", "m", a.p_BF.norm(), b.p_BF.norm());
    for (const LegRole& role : a.roles()) {
      const int i = a.joint(role.name), j = b.joint(role.name);
      const std::string of = fmt::format("{} {}", name(leg), role.name);
      add(of, "joints", "", 1, j < 0 ? 0 : 1);
      if (j >= 0) add_joint(of, i, j);
    }
  }

  void add_joint(const std::string& of, int i, int j) {
    const Body &a = a_.body(i), &b = b_.body(j);
    const Pose &X_a = a_.pose(i), &X_b = b_.pose(j);
    add(of, "mass", "kg", a.inertia.mass, b.inertia.mass);
    add(of, "inertia (trace)", "kg m^2", a.inertia.I_C.trace(), b.inertia.I_C.trace());
    add_place(of, "place", X_a.translation() - a_.middle, X_b.translation() - b_.middle);
    add_place(of, "centre of mass", X_a * a.inertia.p_BC - a_.middle, X_b * b.inertia.p_BC - b_.middle);
    const double cosine = (X_a.linear() * a.joint.axis).dot(X_b.linear() * b.joint.axis);
    add(of, "axis turned by", "deg", 0, std::acos(std::min(1.0, std::abs(cosine))) * kDegreesPerRadian, 90);
    // Of an axis that points the other way limits and angles have the other sign.
    const bool turned = cosine < 0;
    const double sign = turned ? -1 : 1;
    const auto add_range = [&](const std::string& what, double low_a, double high_a, double low_b,
                               double high_b) {
      add(of, what + ", least", "rad", low_a, turned ? -high_b : low_b);
      add(of, what + ", most", "rad", high_a, turned ? -low_b : high_b);
    };
    add_range("range", a.joint.lower, a.joint.upper, b.joint.lower, b.joint.upper);
    if (a.joint.actuated && b.joint.actuated)
      add_range("targets", clip_target(a.joint, -kNoTarget), clip_target(a.joint, kNoTarget),
                clip_target(b.joint, -kNoTarget), clip_target(b.joint, kNoTarget));
    if (a.joint.limited && b.joint.limited) {
      add(of, "limit_solref", "s", a.joint.limit_softness.time_constant,
          b.joint.limit_softness.time_constant);
      add(of, "limit_solimp", "-", a.joint.limit_softness.impedance_max,
          b.joint.limit_softness.impedance_max);
    }
    add(of, "collision shapes", "", static_cast<double>(a.shapes.size()),
        static_cast<double>(b.shapes.size()));
    add(of, "length of the collision shapes", "m", length_of(a), length_of(b), length_);
    add(of, "home", "rad", a_.robot.home[i], sign * b_.robot.home[j]);
    for (const JointNumber& number : kJointNumbers) {
      if (number.member != &Joint::effort_negative)
        add(of, number.name, number.unit, a.joint.*number.member, b.joint.*number.member);
    }
    if (a.joint.effort_negative > 0 || b.joint.effort_negative > 0)
      add(of, "effort_negative", "N m", negative_effort(a.joint), negative_effort(b.joint));
    if (a.joint.stiffness > 0 || b.joint.stiffness > 0)
      add(of, "spring_reference", "rad", a.joint.spring_reference, sign * b.joint.spring_reference);
  }

  const AtHome a_, b_;
  const double length_;  ///< of which places are alike to a hundredth, m
  RobotDifference difference_;
};

}  // namespace

RobotDifference robot_difference(const RobotDescription& a, const RobotDescription& b) {
  return DifferenceFinder(a, b).find();
}

WalkGaps walk_gaps(const Trial& a, const Trial& b) {
  WalkGaps gaps;
  for (const Trial* trial : {&a, &b}) {
    for (const TrialWalk& one : trial->walks) {
      for (const TrialWalk& other : trial->walks)
        gaps.engines = std::max(gaps.engines, std::abs(one.speed_ratio - other.speed_ratio));
    }
  }
  for (std::size_t i = 0; i < std::min(a.walks.size(), b.walks.size()); ++i)
    gaps.descriptions =
        std::max(gaps.descriptions, std::abs(a.walks[i].speed_ratio - b.walks[i].speed_ratio));
  return gaps;
}

std::string describe(const RobotDifference& difference, const WalkGaps& gaps) {
  Table table({"of", "quantity", "first", "second"});
  for (const UnlikeQuantity& q : difference.unlike)
    table.add_row({q.of, q.unit.empty() ? q.name : fmt::format("{}, {}", q.name, q.unit),
                   fmt::format("{:.4g}", q.a), fmt::format("{:.4g}", q.b)});
  const std::string unlike = difference.unlike.empty() ? "" : table.str() + "\n";
  return fmt::format(
      "{}{} quantities are unlike by more than a hundredth, {} are alike.\nSpeeds over the commanded one in "
      "two "
      "seconds of trot: descriptions are up to {:.3f} apart, engines up to {:.3f}: {}.\n",
      unlike, difference.unlike.size(), difference.alike, gaps.descriptions, gaps.engines,
      gaps.descriptions > gaps.engines ? "which description it is matters more"
                                       : "which engine it is matters as much or more");
}

nlohmann::ordered_json to_json(const RobotDifference& difference, const WalkGaps& gaps) {
  nlohmann::ordered_json unlike = nlohmann::ordered_json::array();
  for (const UnlikeQuantity& q : difference.unlike)
    unlike.push_back({{"of", q.of}, {"name", q.name}, {"unit", q.unit}, {"a", q.a}, {"b", q.b}});
  return {{"unlike", unlike},
          {"alike", difference.alike},
          {"gap_of_descriptions", gaps.descriptions},
          {"gap_of_engines", gaps.engines}};
}

}  // namespace crossgait
