#include "study/robot_difference.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "physics/core/table.h"
#include "physics/robot/joint_numbers.h"

namespace crossgait {
namespace {

constexpr double kAlike = 0.01;
constexpr double kNothing = 1e-9;  // in any unit here: two numbers that are both none

class DifferenceFinder {
 public:
  DifferenceFinder(const RobotDescription& a, const RobotDescription& b) : a_(a), b_(b) {}

  RobotDifference find() {
    add("robot", "mass", "kg", a_.total_mass(), b_.total_mass());
    add("robot", "base mass", "kg", a_.bodies[0].inertia.mass, b_.bodies[0].inertia.mass);
    add("robot", "standing height", "m", a_.standing_height, b_.standing_height);
    add("robot", "servos", "", static_cast<double>(a_.actuated_joints().size()),
        static_cast<double>(b_.actuated_joints().size()));
    if (a_.legs && b_.legs) {
      for (const Leg leg : kLegs) add_leg(leg);
    }
    return std::move(difference_);
  }

 private:
  void add(const std::string& of, std::string_view name, std::string_view unit, double a, double b) {
    if (std::abs(a - b) <= std::max(kNothing, kAlike * std::max(std::abs(a), std::abs(b)))) {
      ++difference_.alike;
    } else {
      difference_.unlike.push_back({of, std::string(name), std::string(unit), a, b});
    }
  }

  void add_leg(Leg leg) {
    const LegModel &a = (*a_.legs)[leg], &b = (*b_.legs)[leg];
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
    const Body& a = a_.bodies[static_cast<std::size_t>(i) + 1];
    const Body& b = b_.bodies[static_cast<std::size_t>(j) + 1];
    add(of, "mass", "kg", a.inertia.mass, b.inertia.mass);
    add(of, "inertia (trace)", "kg m^2", a.inertia.I_C.trace(), b.inertia.I_C.trace());
    add(of, "distance from what it hangs on", "m", a.X_PB.translation().norm(), b.X_PB.translation().norm());
    // Of an axis that points the other way limits and angles have the other sign.
    add(of, "range", "rad", a.joint.upper - a.joint.lower, b.joint.upper - b.joint.lower);
    add(of, "home, without its sign", "rad", std::abs(a_.home[i]), std::abs(b_.home[j]));
    for (const JointNumber& number : kJointNumbers)
      add(of, number.name, number.unit, a.joint.*number.member, b.joint.*number.member);
  }

  const RobotDescription &a_, &b_;
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
