// How actions and joints are counted, scaled and commanded.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <tuple>

#include "diagnosis/fields/changes.h"
#include "diagnosis/fields/fields.h"
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace crossgait::fields {
namespace {

FieldChange order_change(std::string name, std::vector<std::string> order) {
  return {std::move(name), [order = std::move(order)](EnvConfig& c) { c.joints.order = order; }};
}

// What a list of numbers in the old order means in the new one.
ServoNumbers reordered(const ServoNumbers& numbers, const std::vector<std::string>& from,
                       const std::vector<std::string>& to) {
  ServoNumbers moved = numbers;
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (const auto it = numbers.by_name.find(from[i]); it != numbers.by_name.end())
      moved.by_name[to[i]] = it->second;
  }
  return moved;
}

FieldChange order_with_lists(const std::string& name, std::vector<std::string> order) {
  return {name + ", with the lists that go by it", [order = std::move(order)](EnvConfig& c) {
            const std::vector<std::string> from = c.joints.order;
            for (ServoNumbers* numbers :
                 {&c.joints.home, &c.joints.offset, &c.joints.scale, &c.joints.lower, &c.joints.upper})
              *numbers = reordered(*numbers, from, order);
            c.joints.order = order;
          }};
}

std::string legs_in_words(const std::array<Leg, 4>& legs) {
  return fmt::format("{} {} {} {}", name(legs[0]), name(legs[1]), name(legs[2]), name(legs[3]));
}

bool by_joint(std::string_view block) {
  return block == "joint_offsets" || block == "joint_positions" || block == "joint_velocities";
}

// Joints whose axis points the other way where the policy was trained.
void turn_around(EnvConfig& c, const std::set<std::string>& joints) {
  for (ObservationTerm& term : c.observation) {
    if (!by_joint(term.block)) continue;
    const std::vector<std::string>& seen = c.joints.observed.empty() ? c.joints.order : c.joints.observed;
    term.scale = each_scale(term, seen.size());
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (joints.contains(seen[i])) term.scale[i] = -term.scale[i];
    }
  }
  for (const std::string& joint : joints) c.joints.scale.by_name[joint] = -c.joints.scale.by_name.at(joint);
}

// The conventions, then every order of legs.
template <typename Visit>
void for_each_order(const Context& context, const Visit& visit) {
  for (const JointOrder& order : joint_orders())
    visit(std::string(order.name), joints_in_order(order, context.servos), true);
  std::array<Leg, 4> legs{Leg::FL, Leg::FR, Leg::RL, Leg::RR};
  do {
    for (const auto by : {JointOrder::By::kLeg, JointOrder::By::kDepth}) {
      const JointOrder order{"", by, legs, false, ""};
      visit(fmt::format("{}, {}", legs_in_words(legs),
                        by == JointOrder::By::kLeg ? "leg after leg" : "all hips first"),
            joints_in_order(order, context.servos), false);
    }
  } while (std::next_permutation(legs.begin(), legs.end()));
}

constexpr std::array<std::string_view, 3> kDepths{"first", "second", "third"};

// Angles of some joints moved by `by`, with the offsets of targets where these are stated.
FieldChange home_shift(const std::string& words, const std::map<std::string, double>& direction, double by) {
  return {fmt::format("{} {:+.3g} rad", words, by),
          [=](EnvConfig& c) {
            for (const auto& [joint, sign] : direction) {
              c.joints.home.by_name[joint] += sign * by;
              if (!c.joints.offset.empty())
                c.joints.offset.by_name[joint] = c.joints.offset.find(joint).value_or(0) + sign * by;
            }
          },
          [=](double strength) { return home_shift(words, direction, strength * by); }};
}

struct JointGroup {
  std::string words;
  std::map<std::string, double> direction;
};

// Joints that files set alike: by depth, of front, rear or all legs; those on the right the other way round
// where they are hips.
std::vector<JointGroup> joint_groups(const Context& context) {
  std::vector<JointGroup> groups;
  for (int depth = 0; depth < 3; ++depth) {
    for (const auto& [words, front, rear] :
         {std::tuple{"all legs", true, true}, {"front legs", true, false}, {"rear legs", false, true}}) {
      JointGroup group{fmt::format("{} joints of {}", kDepths[static_cast<std::size_t>(depth)], words), {}};
      for (const ServoPlace& servo : context.servos) {
        if (servo.depth != depth || !(is_front(servo.leg) ? front : rear)) continue;
        group.direction[servo.joint] = depth == 0 && !is_left(servo.leg) ? -1 : 1;
      }
      if (!group.direction.empty()) groups.push_back(std::move(group));
    }
  }
  return groups;
}

}  // namespace

Fields joint_order(const Context& context) {
  const std::vector<std::string>& present = context.config.joints.order;
  CandidateField field{"joints.order", fmt::format("{}", fmt::join(present, " ")), {}};
  std::set<std::vector<std::string>> seen{present};
  const bool same_home = [&] {
    std::set<double> values;
    for (const ServoPlace& servo : context.servos)
      values.insert(*context.config.joints.home.find(servo.joint));
    return values.size() == 1;
  }();
  const auto add = [&](FieldChange change, bool usual) {
    change.usual = usual;
    field.changes.push_back(std::move(change));
  };
  for_each_order(context, [&](const std::string& words, std::vector<std::string> order, bool usual) {
    if (!seen.insert(order).second) return;
    if (!same_home) add(order_with_lists(words, order), usual);
    add(order_change(words, std::move(order)), usual);
  });
  return {std::move(field)};
}

Fields joints_observed(const Context& context) {
  const JointActionSettings& joints = context.config.joints;
  const bool seen_in_action_order = joints.observed.empty();
  const std::vector<std::string>& present = seen_in_action_order ? joints.order : joints.observed;
  if (std::set(present.begin(), present.end()) != std::set(joints.order.begin(), joints.order.end()))
    return {};
  CandidateField field{"joints.observed",
                       seen_in_action_order ? "as the action" : fmt::format("{}", fmt::join(present, " ")),
                       {}};
  std::set<std::vector<std::string>> seen{present};
  const auto add = [&](const std::string& words, const std::vector<std::string>& order, bool usual) {
    if (seen.insert(order).second)
      field.changes.push_back({words, [order](EnvConfig& c) { c.joints.observed = order; }, {}, usual});
  };
  add("as the action", joints.order, true);
  for_each_order(context, add);
  return {std::move(field)};
}

Fields joint_signs(const Context& context) {
  CandidateField field{"joints.signs", "as the robot's", {}};
  const auto add = [&](const std::string& words, const auto& takes) {
    std::set<std::string> joints;
    for (const ServoPlace& servo : context.servos)
      if (takes(servo)) joints.insert(servo.joint);
    if (joints.empty()) return;
    field.changes.push_back({words + " turned around", [joints](EnvConfig& c) { turn_around(c, joints); }});
  };
  for (int depth = 0; depth < 3; ++depth) {
    const std::string which = fmt::format("{} joints of ", kDepths[static_cast<std::size_t>(depth)]);
    add(which + "all legs", [depth](const ServoPlace& s) { return s.depth == depth; });
    add(which + "left legs", [depth](const ServoPlace& s) { return s.depth == depth && is_left(s.leg); });
    add(which + "right legs", [depth](const ServoPlace& s) { return s.depth == depth && !is_left(s.leg); });
  }
  add("second and third joints", [](const ServoPlace& s) { return s.depth > 0; });
  add("all joints", [](const ServoPlace&) { return true; });
  return {std::move(field)};
}

Fields joint_home(const Context& context) {
  CandidateField field{"joints.home", numbers_in_words(in_order(context.config.joints.home, context)), {}};
  const RobotDescription& robot = *context.model.world.robot;
  std::map<std::string, double> own;
  for (const int i : robot.actuated_joints()) own[robot.joint(i).name] = robot.home[i];
  field.changes.push_back({"the robot's own", [own](EnvConfig& c) { c.joints.home.by_name = own; }});
  field.changes.push_back({"first joints at 0", [servos = context.servos](EnvConfig& c) {
                             for (const ServoPlace& s : servos)
                               if (s.depth == 0) c.joints.home.by_name[s.joint] = 0;
                           }});
  for (const JointGroup& group : joint_groups(context)) {
    for (const double by : {-0.25, -0.1, 0.1, 0.25})
      field.changes.push_back(home_shift(group.words, group.direction, by));
  }
  return {std::move(field)};
}

Fields joint_offset(const Context& context) {
  const ServoNumbers& offset = context.config.joints.offset;
  CandidateField field{
      "joints.offset", offset.empty() ? "home" : numbers_in_words(in_order(offset, context)), {}};
  if (!offset.empty()) field.changes.push_back({"home", [](EnvConfig& c) { c.joints.offset = {}; }});
  if (offset.empty() || numbers_in_words(in_order(offset, context)) != "0")
    field.changes.push_back({"0", [](EnvConfig& c) { c.joints.offset = {0, {}}; }});
  return {std::move(field)};
}

Fields joint_scale(const Context& context) {
  const std::vector<double> now = in_order(context.config.joints.scale, context);
  CandidateField field{"joints.scale", numbers_in_words(now), {}};
  add_factors(field,
              [](EnvConfig& c, double factor) {
                for (auto& [joint, value] : c.joints.scale.by_name) value *= factor;
              },
              now, {0.25, 0.5, 0.7, 1.4, 2, 4});
  std::vector<std::string> hips;
  std::vector<double> of_hips;
  for (const ServoPlace& servo : context.servos) {
    if (servo.depth > 0) continue;
    hips.push_back(servo.joint);
    of_hips.push_back(*context.config.joints.scale.find(servo.joint));
  }
  add_factors(
      field,
      [hips](EnvConfig& c, double factor) {
        for (const std::string& joint : hips) c.joints.scale.by_name[joint] *= factor;
      },
      of_hips, {0.5, 2}, "first joints ");
  return {std::move(field)};
}

Fields joint_command(const Context& context) {
  CandidateField field{"joints.command", std::string(name(context.config.joints.command)), {}};
  for (const JointCommand command : {JointCommand::kPosition, JointCommand::kRelative}) {
    if (command == context.config.joints.command) continue;
    field.changes.push_back(
        {std::string(name(command)), [command](EnvConfig& c) { c.joints.command = command; }});
  }
  return {std::move(field)};
}

Fields joint_limits(const Context& context) {
  const JointActionSettings& joints = context.config.joints;
  CandidateField limit{"joints.limit", number(joints.limit), {}};
  for (const double value : {1.0, 100.0}) {
    if (value != joints.limit)
      limit.changes.push_back({number(value), [value](EnvConfig& c) { c.joints.limit = value; }});
  }
  Fields fields{std::move(limit)};
  if (!joints.lower.empty() || !joints.upper.empty())
    fields.push_back({"joints.lower, joints.upper", "stated", {{"none", [](EnvConfig& c) {
                                                                  c.joints.lower = c.joints.upper = {};
                                                                }}}});
  return fields;
}

Fields joint_filter(const Context& context) {
  CandidateField field{"joints.filter", number(context.config.joints.filter), {}};
  for (const double value : {1.0, 0.8, 0.5, 0.2}) {
    if (value != context.config.joints.filter)
      field.changes.push_back({number(value), [value](EnvConfig& c) { c.joints.filter = value; }});
  }
  return {std::move(field)};
}

Fields joint_delay(const Context& context) {
  const double now = context.config.joints.delay, dt = context.config.policy_dt;
  CandidateField field{"joints.delay", number(now), {}};
  for (const double value : {0.0, 0.005, 0.01, dt, 2 * dt}) {
    if (std::abs(value - now) > 1e-9)
      field.changes.push_back({number(value), [value](EnvConfig& c) { c.joints.delay = value; }});
  }
  return {std::move(field)};
}

}  // namespace crossgait::fields
