#include "study/robot_parts.h"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/engine/world_quantities.h"
#include "physics/robot/joint_numbers.h"
#include "physics/robot/multibody.h"
#include "physics/robot/robot_members.h"

namespace crossgait {
namespace {

constexpr std::string_view kGeometry = "geometry", kMasses = "mass properties", kSoftness = "softness";

[[noreturn]] void refuse(const RobotDescription& b, const std::string& element, std::string_view expected,
                         std::string_view found) {
  throw ConfigError(b.source.empty() ? b.name : b.source, element, expected, found);
}

// Which body of `b` is each of `a`: by the roles of the legs, what is none of a leg as it comes.
std::vector<std::size_t> bodies_like(const RobotDescription& a, const RobotDescription& b) {
  if (a.bodies.size() != b.bodies.size())
    refuse(b, "bodies", fmt::format("{}, as of {}", a.bodies.size(), a.name),
           fmt::format("{}", b.bodies.size()));
  std::vector<std::size_t> place(a.bodies.size(), 0);
  std::vector<bool> taken(b.bodies.size());
  taken[0] = true;
  if (a.legs && b.legs) {
    for (const Leg leg : kLegs) {
      const LegModel &of_a = (*a.legs)[leg], &of_b = (*b.legs)[leg];
      if (of_a.linkage != of_b.linkage || of_a.joints().size() != of_b.joints().size())
        refuse(b, fmt::format("leg {}", name(leg)), "the joints that it has in " + a.name, "others");
      for (std::size_t i = 0; i < of_a.joints().size(); ++i) {
        const auto own = static_cast<std::size_t>(of_a.joints()[i]) + 1;
        place[own] = static_cast<std::size_t>(of_b.joints()[i]) + 1;
        taken[place[own]] = true;
      }
    }
  }
  std::size_t next = 1;
  for (std::size_t i = 1; i < place.size(); ++i) {
    if (place[i] != 0) continue;
    while (taken[next]) ++next;
    place[i] = next;
    taken[next] = true;
  }
  return place;
}

// Zero stays what it is, without a sign.
void turn_around(Joint& joint, double& home) {
  joint.axis = Vector3::Zero() - joint.axis;
  joint.lower = 0 - std::exchange(joint.upper, 0 - joint.lower);
  joint.target_lower = 0 - std::exchange(joint.target_upper, 0 - joint.target_lower);
  joint.spring_reference = 0 - joint.spring_reference;
  if (joint.effort_negative > 0) std::swap(joint.effort_limit, joint.effort_negative);
  home = 0 - home;
}

// One controller commands both, so the angles of `a` have to mean the same in `b`: feet stay where they are,
// but for what lengths differ by, which is less than half of how high a robot stands.
void check_angles(const RobotDescription& a, const RobotDescription& b) {
  if (!a.legs || !b.legs || a.home.size() != a.joint_count()) return;
  RobotState home;
  home.q = a.home;
  home.qd = JointVector::Zero(a.joint_count());
  std::vector<Pose> of_a, of_b;
  forward_kinematics(a, home, of_a);
  forward_kinematics(b, home, of_b);
  for (const Leg leg : kLegs) {
    const double away = (foot_position(a, leg, of_a) - foot_position(b, leg, of_b)).norm();
    if (away > 0.5 * a.standing_height)
      refuse(b, fmt::format("leg {}", name(leg)),
             fmt::format("joint angles counted from the same zero as those of {}: feet within {:.3g} m",
                         a.name, 0.5 * a.standing_height),
             fmt::format("{:.3g} m", away));
  }
}

// Copies the numbers of joints that are of a part, of springs with the angle at which they rest.
void copy_numbers(std::string_view part, const RobotDescription& from, RobotDescription& to) {
  for (const JointNumber& number : kJointNumbers) {
    if (joint_number_group(number) != part) continue;
    for (std::size_t i = 1; i < to.bodies.size(); ++i) {
      Joint& joint = to.bodies[i].joint;
      joint.*number.member = from.bodies[i].joint.*number.member;
      if (number.member == &Joint::stiffness) joint.spring_reference = from.bodies[i].joint.spring_reference;
    }
  }
}

void copy_part(std::string_view part, const RobotDescription& from, RobotDescription& to) {
  if (part == kMasses) {
    for (std::size_t i = 0; i < to.bodies.size(); ++i) to.bodies[i].inertia = from.bodies[i].inertia;
  } else if (part == kSoftness) {
    to.loop_softness = from.loop_softness;
    to.friction_softness = from.friction_softness;
    // Where both have the same joints coupled.
    for (JointCoupling& coupling : to.couplings) {
      const JointCoupling* other = from.coupling_of(coupling.follower);
      if (other != nullptr) coupling.softness = other->softness;
    }
    for (std::size_t i = 1; i < to.bodies.size(); ++i)
      to.bodies[i].joint.limit_softness = from.bodies[i].joint.limit_softness;
  } else {
    copy_numbers(part, from, to);
  }
}

// The numbers and texts of a robot but for what bodies look like.
struct Leaves {
  std::vector<double> numbers;
  std::vector<std::string> texts;
};

Leaves leaves_of(RobotDescription robot) {
  for (Body& body : robot.bodies) body.visuals.clear();
  Leaves leaves;
  for_each_leaf(robot, [&leaves](const MemberPath&, const auto& leaf) {
    if constexpr (std::same_as<std::remove_cvref_t<decltype(leaf)>, std::string>) {
      leaves.texts.push_back(leaf);
    } else {
      leaves.numbers.push_back(static_cast<double>(leaf));
    }
  });
  return leaves;
}

// But for rounding: files write the same number in several ways.
bool are_alike(const Leaves& a, const Leaves& b) {
  constexpr double kShare = 1e-9, kRounding = 1e-12;  // of a number; in any unit here
  return a.texts == b.texts &&
         std::equal(a.numbers.begin(), a.numbers.end(), b.numbers.begin(), b.numbers.end(),
                    [](double x, double y) {
                      return std::abs(x - y) <= kRounding + kShare * std::max(std::abs(x), std::abs(y));
                    });
}

// Says where each body of `b` goes, and which joints were turned around on the way.
struct Reordering {
  const RobotDescription& a;
  std::vector<int> now;
  std::vector<bool> is_turned;

  int joint_now(int joint) const { return now[static_cast<std::size_t>(joint) + 1] - 1; }
};

// Of couplings of `a` first, in its order.
void reorder_couplings(const Reordering& to, std::vector<JointCoupling>& couplings) {
  const auto order = [&a = to.a](const JointCoupling& coupling) {
    const JointCoupling* own = a.coupling_of(coupling.follower);
    return std::pair(own == nullptr ? a.couplings.size() : static_cast<std::size_t>(own - a.couplings.data()),
                     coupling.follower);
  };
  for (JointCoupling& coupling : couplings) {
    coupling.follower = to.joint_now(coupling.follower);
    coupling.leader = to.joint_now(coupling.leader);
    if (to.is_turned[static_cast<std::size_t>(coupling.leader)]) {
      coupling.coefficients[1] = 0 - coupling.coefficients[1];
      coupling.coefficients[3] = 0 - coupling.coefficients[3];
    }
    if (to.is_turned[static_cast<std::size_t>(coupling.follower)]) {
      for (double& coefficient : coupling.coefficients) coefficient = 0 - coefficient;
    }
  }
  std::sort(couplings.begin(), couplings.end(),
            [&](const JointCoupling& x, const JointCoupling& y) { return order(x) < order(y); });
}

void reorder_loops(const Reordering& to, std::vector<LoopClosure>& loops) {
  for (std::size_t i = 0; i < loops.size(); ++i) {
    LoopClosure& loop = loops[i];
    loop.body_a = to.now[static_cast<std::size_t>(loop.body_a)];
    loop.body_b = to.now[static_cast<std::size_t>(loop.body_b)];
    if (i < to.a.loops.size()) loop.name = to.a.loops[i].name;
  }
}

void reorder_legs(const Reordering& to, LegArray<LegModel>& legs) {
  const auto joint_now = [&to](int joint) { return to.joint_now(joint); };
  for (const Leg leg : kLegs) {
    LegModel& model = legs[leg];
    std::transform(model.servos.begin(), model.servos.end(), model.servos.begin(), joint_now);
    std::transform(model.passive.begin(), model.passive.end(), model.passive.begin(), joint_now);
    model.foot_body = to.now[static_cast<std::size_t>(model.foot_body)];
  }
}

}  // namespace

RobotDescription in_order_of(const RobotDescription& a, const RobotDescription& b) {
  const std::vector<std::size_t> place = bodies_like(a, b);
  Reordering to{a, std::vector<int>(place.size()),
                std::vector<bool>(static_cast<std::size_t>(b.joint_count()))};
  for (std::size_t i = 0; i < place.size(); ++i) to.now[place[i]] = static_cast<int>(i);
  RobotDescription robot = b;
  for (std::size_t i = 0; i < place.size(); ++i) {
    const Body& like = a.bodies[i];
    Body& body = robot.bodies[i] = b.bodies[place[i]];
    if (i > 0) body.parent = to.now[static_cast<std::size_t>(body.parent)];
    if (body.parent != like.parent || body.joint.actuated != like.joint.actuated)
      refuse(b, fmt::format("body '{}'", body.name),
             fmt::format("what it hangs on, and whether a servo moves it, as '{}' of {}", like.name, a.name),
             "otherwise");
    if (i > 0 && b.home.size() == b.joint_count())
      robot.home[static_cast<Eigen::Index>(i) - 1] = b.home[static_cast<Eigen::Index>(place[i]) - 1];
    body.name = like.name;
    body.joint.name = like.joint.name;
    for (std::size_t k = 0; k < std::min(body.shapes.size(), like.shapes.size()); ++k)
      body.shapes[k].name = like.shapes[k].name;
    if (i > 0 && body.joint.axis.dot(like.joint.axis) < 0 && b.home.size() == b.joint_count()) {
      turn_around(body.joint, robot.home[static_cast<Eigen::Index>(i) - 1]);
      to.is_turned[i - 1] = true;
    }
  }
  reorder_loops(to, robot.loops);
  reorder_couplings(to, robot.couplings);
  if (robot.legs) reorder_legs(to, *robot.legs);
  robot.validate();
  check_angles(a, robot);
  return robot;
}

std::vector<std::string> robot_parts() {
  std::vector<std::string> parts{std::string(kGeometry), std::string(kMasses)};
  for (const JointNumber& number : kJointNumbers) {
    const std::string part(joint_number_group(number));
    if (std::find(parts.begin(), parts.end(), part) == parts.end()) parts.push_back(part);
  }
  parts.emplace_back(kSoftness);
  return parts;
}

std::vector<std::string> unlike_parts(const RobotDescription& a, const RobotDescription& b) {
  const Leaves own = leaves_of(a);
  std::vector<std::string> unlike;
  for (const std::string& part : robot_parts()) {
    if (!are_alike(leaves_of(with_part(a, b, part)), own)) unlike.push_back(part);
  }
  return unlike;
}

RobotDescription with_part(const RobotDescription& a, const RobotDescription& b, const std::string& part) {
  if (part != kGeometry) {
    RobotDescription robot = a;
    copy_part(part, b, robot);
    return robot;
  }
  // All that no other part has, whatever a description holds.
  RobotDescription robot = b;
  for (const std::string& other : robot_parts()) {
    if (other != kGeometry) copy_part(other, a, robot);
  }
  robot.name = a.name;
  robot.source = a.source;
  robot.contact = a.contact;
  return robot;
}

}  // namespace crossgait
