// Every member of a robot by name. What has to know of all of them (a robot's identity, checks, tests) goes
// through here, and a member that is not visited does not compile.
#pragma once

#include <concepts>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

#include "physics/robot/joint_numbers.h"
#include "physics/robot/robot.h"

namespace crossgait {

/// `T` with or without const.
template <typename T, typename Type>
concept MaybeConst = std::same_as<std::remove_const_t<T>, Type>;

namespace members {

/// Initialises a member of any type.
struct Any {
  template <typename T>
  operator T() const;
};

/// Counts the members of an aggregate: as many values as it can be initialised with.
template <typename T, typename... Members>
consteval std::size_t count() {
  if constexpr (requires { T{Members{}..., Any{}}; }) {
    return count<T, Members..., Any>();
  } else {
    return sizeof...(Members);
  }
}

// What of a joint is no row of kJointNumbers: name, axis, actuated, the angles, which have a sign, and how
// they limit it.
static_assert(count<Joint>() == kJointNumbers.size() + 10,
              "a new member of Joint is a row of kJointNumbers, or visited by name below");

}  // namespace members

// Calls `visit(name, member)` for each member. The bindings take all members of a struct or do not compile.

template <MaybeConst<SpatialInertia> T, typename Visit>
void for_each_member(T& inertia, Visit&& visit) {
  auto& [mass, p_BC, I_C] = inertia;
  visit("mass", mass), visit("p_BC", p_BC), visit("I_C", I_C);
}

template <MaybeConst<CollisionShape> T, typename Visit>
void for_each_member(T& shape, Visit&& visit) {
  auto& [name, type, size, X_BG, vertices] = shape;
  visit("name", name), visit("type", type), visit("size", size), visit("X_BG", X_BG);
  visit("vertices", vertices);
}

template <MaybeConst<VisualShape> T, typename Visit>
void for_each_member(T& shape, Visit&& visit) {
  auto& [type, size, mesh, scale, X_BG, rgba] = shape;
  visit("type", type), visit("size", size), visit("mesh", mesh), visit("scale", scale);
  visit("X_BG", X_BG), visit("rgba", rgba);
}

template <MaybeConst<Joint> T, typename Visit>
void for_each_member(T& joint, Visit&& visit) {
  visit("name", joint.name), visit("axis", joint.axis), visit("actuated", joint.actuated);
  visit("lower", joint.lower), visit("upper", joint.upper), visit("limited", joint.limited);
  visit("limit_softness", joint.limit_softness);
  visit("target_lower", joint.target_lower), visit("target_upper", joint.target_upper);
  visit("spring_reference", joint.spring_reference);
  for (const JointNumber& number : kJointNumbers) visit(number.name, joint.*number.member);
}

template <MaybeConst<Body> T, typename Visit>
void for_each_member(T& body, Visit&& visit) {
  auto& [name, parent, X_PB, joint, inertia, shapes, visuals] = body;
  visit("name", name), visit("parent", parent), visit("X_PB", X_PB), visit("joint", joint);
  visit("inertia", inertia), visit("shapes", shapes), visit("visuals", visuals);
}

template <MaybeConst<LoopClosure> T, typename Visit>
void for_each_member(T& loop, Visit&& visit) {
  auto& [name, body_a, body_b, p_AP, p_BP] = loop;
  visit("name", name), visit("body_a", body_a), visit("body_b", body_b);
  visit("p_AP", p_AP), visit("p_BP", p_BP);
}

template <MaybeConst<JointCoupling> T, typename Visit>
void for_each_member(T& coupling, Visit&& visit) {
  auto& [follower, leader, coefficients, softness] = coupling;
  visit("follower", follower), visit("leader", leader), visit("coefficients", coefficients);
  visit("softness", softness);
}

template <MaybeConst<LegModel> T, typename Visit>
void for_each_member(T& leg, Visit&& visit) {
  auto& [linkage, servos, passive, parts, foot_body, p_BF, foot_radius] = leg;
  visit("linkage", linkage), visit("servos", servos), visit("passive", passive), visit("parts", parts);
  visit("foot_body", foot_body), visit("p_BF", p_BF), visit("foot_radius", foot_radius);
}

/// Visits members by names that are those of robot.yaml.
template <MaybeConst<Softness> T, typename Visit>
void for_each_member(T& softness, Visit&& visit) {
  auto& [time_constant, damping_ratio, impedance_min, impedance_max, impedance_width, impedance_midpoint,
         impedance_power] = softness;
  visit("time_constant", time_constant), visit("damping_ratio", damping_ratio);
  visit("impedance_min", impedance_min), visit("impedance_max", impedance_max);
  visit("impedance_width", impedance_width), visit("impedance_midpoint", impedance_midpoint);
  visit("impedance_power", impedance_power);
}

template <MaybeConst<ContactSettings> T, typename Visit>
void for_each_member(T& contact, Visit&& visit) {
  auto& [said] = contact;
  visit("said", said);
}

template <MaybeConst<RobotDescription> T, typename Visit>
void for_each_member(T& robot, Visit&& visit) {
  auto& [name, source, bodies, loops, couplings, contact, loop_softness, friction_softness, legs, home,
         home_height, standing_height, stance_offset] = robot;
  visit("name", name), visit("source", source), visit("bodies", bodies), visit("loops", loops);
  visit("couplings", couplings), visit("contact", contact), visit("loop_softness", loop_softness),
      visit("friction_softness", friction_softness), visit("legs", legs);
  visit("home", home), visit("home_height", home_height), visit("standing_height", standing_height);
  visit("stance_offset", stance_offset);
}

/// Says where a value is inside a robot. Its text is only made when it is asked for.
struct MemberPath {
  const MemberPath* outer = nullptr;
  std::string_view name = {};
  std::ptrdiff_t index = -1;  ///< of an element; -1: a member

  /// Writes the path: "bodies[3].joint.kp".
  std::string text() const {
    const std::string before = outer == nullptr ? "" : outer->text();
    if (index >= 0) return fmt::format("{}[{}]", before, index);
    return before.empty() ? std::string(name) : fmt::format("{}.{}", before, name);
  }
};

/// Calls `visit(path, leaf)` for each number, enumerator and text inside `value`: what has members by these,
/// lists, vectors and matrices by their elements. What is absent, or empty, has none.
template <typename T, typename Visit>
void for_each_leaf(T& value, Visit&& visit, const MemberPath& path = {}) {
  using Type = std::remove_const_t<T>;
  const auto each = [&](auto& elements) {
    for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(elements.size()); ++i)
      for_each_leaf(elements.data()[i], visit, MemberPath{&path, {}, i});
  };
  if constexpr (std::is_arithmetic_v<Type> || std::is_enum_v<Type> || std::same_as<Type, std::string>) {
    visit(path, value);
  } else if constexpr (std::same_as<Type, Pose>) {
    each(value.matrix());
  } else if constexpr (requires { value.has_value(); }) {
    if (value) for_each_leaf(*value, visit, path);
  } else if constexpr (requires { value.data(); }) {
    each(value);
  } else {
    for_each_member(value, [&](std::string_view name, auto& member) {
      for_each_leaf(member, visit, MemberPath{&path, name});
    });
  }
}

}  // namespace crossgait
