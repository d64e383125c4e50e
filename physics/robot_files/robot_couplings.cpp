// Joints that follow others: of the robot's file or its robot.yaml, and what becomes of them where joints are
// held.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/error.h"
#include "physics/robot/robot_check.h"
#include "physics/robot/robot_members.h"
#include "physics/robot_files/robot_builder.h"

namespace crossgait {

void RobotBuilder::read_couplings() {
  const auto couplings = find("couplings");
  if (!couplings) {
    // Of joints of bodies that were left out there is nothing to be coupled.
    std::erase_if(parsed_.couplings, [this](const NamedCoupling& coupling) {
      const bool has_follower = moved_body(coupling.follower) >= 0,
                 has_leader = moved_body(coupling.leader) >= 0;
      if (has_follower != has_leader)
        throw ConfigError(
            report_.file, fmt::format("joint '{}', {}", coupling.follower, coupling.place),
            "two joints of the robot",
            fmt::format("'{}', which is none", has_follower ? coupling.leader : coupling.follower));
      return !has_follower;
    });
    return;
  }
  parsed_.couplings.clear();
  for (const YamlValue& value : couplings->items()) {
    value.allow_keys({"follower", "leader", "coefficients", "servo", "softness"});
    NamedCoupling coupling;
    for (const auto& [key, name] :
         {std::pair("follower", &coupling.follower), {"leader", &coupling.leader}}) {
      const YamlValue joint = value.at(key);
      *name = joint.text();
      static_cast<void>(moved_body(joint, *name));  // throws
    }
    const YamlValue coefficients = value.at("coefficients");
    const std::vector<YamlValue> numbers = coefficients.items();
    if (numbers.empty() || numbers.size() > coupling.coefficients.size())
      coefficients.fail("1 to 5 numbers: offset (rad), multiplier, and of higher powers",
                        fmt::format("{}", numbers.size()));
    coupling.coefficients = {};
    for (std::size_t i = 0; i < numbers.size(); ++i) coupling.coefficients[i] = numbers[i].number();
    if (const auto servo = value.find("servo")) coupling.is_driven = servo->boolean();
    if (const auto softness = value.find("softness")) read_softness(*softness, coupling.softness);
    coupling.says_softness = value.find("softness").has_value();
    coupling.place = value.element();
    parsed_.couplings.push_back(std::move(coupling));
  }
}

void RobotBuilder::settle_held(const std::map<std::string, double>& held) {
  constexpr double kRounding = 1e-3;  // rad, of angles that were written by hand
  const auto fail = [this](const NamedCoupling& coupling, const std::string& expected,
                           const std::string& found) {
    throw ConfigError(report_.file, fmt::format("joint '{}', {}", coupling.follower, coupling.place),
                      expected, found);
  };
  std::erase_if(parsed_.couplings, [&](const NamedCoupling& coupling) {
    const auto follower = held.find(coupling.follower), leader = held.find(coupling.leader);
    if (follower == held.end() && leader == held.end()) return false;
    if (leader == held.end())
      fail(coupling, fmt::format("a joint that moves with '{}'", coupling.leader), "one that is held");
    if (follower == held.end())
      fail(coupling, fmt::format("a leader that moves as '{}' does", coupling.follower),
           fmt::format("'{}', which is held", coupling.leader));
    const double angle = JointCoupling{.coefficients = coupling.coefficients}.follower_at(leader->second);
    if (std::abs(angle - follower->second) > kRounding)
      fail(coupling, fmt::format("held at {:.4g} rad, where '{}' has it", angle, coupling.leader),
           fmt::format("{:.4g} rad", follower->second));
    return true;
  });
}

void RobotBuilder::free_followers() {
  // In a chain of n the last one is right after n rounds, in whichever order they are.
  for (std::size_t round = 0; round < robot_.couplings.size(); ++round) {
    for (const JointCoupling& coupling : robot_.couplings) {
      Joint& follower = joint(coupling.follower);
      if (follower.limited) continue;
      const Joint& leader = joint(coupling.leader);
      const double most = std::max(std::abs(leader.lower), std::abs(leader.upper));
      double reach = 0, power = 1;
      for (const double coefficient : coupling.coefficients) {
        reach += std::abs(coefficient) * power;
        power *= most;
      }
      reach = std::min(reach, kLargestAngle);
      follower.lower = std::min(follower.lower, -reach);
      follower.upper = std::max(follower.upper, reach);
    }
  }
}

void RobotBuilder::take_couplings() {
  std::vector<std::string> driven;
  for (const NamedCoupling& coupling : parsed_.couplings) {
    const auto joint_of = [&](const std::string& name) {
      return body_index_[static_cast<std::size_t>(moved_body(name))] - 1;
    };
    robot_.couplings.push_back(
        {joint_of(coupling.follower), joint_of(coupling.leader), coupling.coefficients, coupling.softness});
    report_.couplings[coupling.follower] = coupling;
    if (coupling.is_driven) driven.push_back(fmt::format("'{}'", coupling.follower));
  }
  free_followers();
  if (driven.empty()) return;
  report_.warnings.push_back(fmt::format(
      "joints that follow another and have a servo of their own, which pulls against the coupling "
      "where it wants another angle: {}",
      fmt::join(driven, ", ")));
}

}  // namespace crossgait
