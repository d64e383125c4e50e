#include "diagnosis/candidate_fields.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "backends/registry.h"
#include "motion/time_steps.h"

namespace crossgait {
namespace {

using Context = FieldContext;
using Fields = std::vector<CandidateField>;
using Apply = std::function<void(EnvConfig&)>;

std::string number(double value) { return fmt::format("{:.4g}", value); }

// "20", or "10 to 20" of numbers that are not the same.
std::string numbers_in_words(const std::vector<double>& numbers) {
  const auto [least, most] = std::minmax_element(numbers.begin(), numbers.end());
  if (numbers.empty()) return "none";
  return *least == *most ? number(*least) : fmt::format("{} to {}", number(*least), number(*most));
}

// ---- joints ----

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
  const auto add = [&](const std::string& words, std::vector<std::string> order) {
    if (!seen.insert(order).second) return;
    if (!same_home) field.changes.push_back(order_with_lists(words, order));
    field.changes.push_back(order_change(words, std::move(order)));
  };
  for (const JointOrder& order : joint_orders())
    add(std::string(order.name), joints_in_order(order, context.servos));
  std::array<Leg, 4> legs{Leg::FL, Leg::FR, Leg::RL, Leg::RR};
  do {
    for (const auto by : {JointOrder::By::kLeg, JointOrder::By::kDepth}) {
      const JointOrder order{"", by, legs, false, ""};
      add(fmt::format("{}, {}", legs_in_words(legs),
                      by == JointOrder::By::kLeg ? "leg after leg" : "all hips first"),
          joints_in_order(order, context.servos));
    }
  } while (std::next_permutation(legs.begin(), legs.end()));
  return {std::move(field)};
}

// A scale for each number of a term.
std::vector<double> each_scale(const ObservationTerm& term, std::size_t size) {
  if (term.scale.size() == size) return term.scale;
  return std::vector<double>(size, term.scale.empty() ? 1 : term.scale.front());
}

bool by_joint(std::string_view block) {
  return block == "joint_offsets" || block == "joint_positions" || block == "joint_velocities";
}

// Joints whose axis points the other way where the policy was trained.
void turn_around(EnvConfig& c, const std::set<std::string>& joints) {
  for (ObservationTerm& term : c.observation) {
    if (!by_joint(term.block)) continue;
    term.scale = each_scale(term, c.joints.order.size());
    for (std::size_t i = 0; i < c.joints.order.size(); ++i) {
      if (joints.contains(c.joints.order[i])) term.scale[i] = -term.scale[i];
    }
  }
  for (const std::string& joint : joints) c.joints.scale.by_name[joint] = -c.joints.scale.by_name.at(joint);
}

constexpr std::array<std::string_view, 3> kDepths{"first", "second", "third"};

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

std::vector<double> in_order(const ServoNumbers& numbers, const Context& context) {
  std::vector<double> all;
  for (const std::string& joint : context.config.joints.order) all.push_back(numbers.find(joint).value_or(0));
  return all;
}

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

using Scale = std::function<void(EnvConfig&, double factor)>;

// @param now  the value that is multiplied, for words
FieldChange by_factor(const Scale& scale, const std::vector<double>& now, double factor,
                      const std::string& of = "") {
  std::vector<double> then = now;
  for (double& value : then) value *= factor;
  return {of + numbers_in_words(then), [=](EnvConfig& c) { scale(c, factor); },
          [=](double strength) { return by_factor(scale, now, std::pow(factor, strength), of); }};
}

void add_factors(CandidateField& field, const Scale& scale, const std::vector<double>& now,
                 const std::vector<double>& factors, const std::string& of = "") {
  for (const double factor : factors) field.changes.push_back(by_factor(scale, now, factor, of));
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

// ---- servos ----

// A number of every servo set to `value`, or to the robot's own.
Apply set_servos(std::size_t row, std::optional<double> value) {
  return [row, value](EnvConfig& c) { c.servos.numbers[row] = {value, {}}; };
}

CandidateField servo_field(const Context& context, std::size_t row) {
  const JointNumber& known = kJointNumbers[row];
  const RobotDescription& robot = *context.model.world.robot;
  std::map<std::string, double> by_name;
  std::vector<double> now, own;
  for (const int i : robot.actuated_joints()) {
    by_name[robot.joint(i).name] = robot.joint(i).*known.member;
    now.push_back(robot.joint(i).*known.member);
    own.push_back(context.model.robot->joint(i).*known.member);
  }
  CandidateField field{fmt::format("servos.{}", known.name), numbers_in_words(now), {}};
  if (own != now)
    field.changes.push_back(
        {fmt::format("the robot's own, {}", numbers_in_words(own)), set_servos(row, std::nullopt)});
  const auto scale = [row, by_name](EnvConfig& c, double factor) {
    c.servos.numbers[row] = {std::nullopt, by_name};
    for (auto& [joint, value] : c.servos.numbers[row].by_name) value *= factor;
  };
  if (now != std::vector<double>(now.size(), 0))
    add_factors(field, scale, now,
                known.of == JointNumberOf::kServo ? std::vector{0.25, 0.5, 0.7, 1.4, 2.0, 4.0}
                                                  : std::vector{0.25, 4.0});
  return field;
}

std::size_t servo_row(std::string_view name) {
  return static_cast<std::size_t>(std::find_if(kJointNumbers.begin(), kJointNumbers.end(),
                                               [&](const auto& n) { return n.name == name; }) -
                                  kJointNumbers.begin());
}

Fields servo_gains(const Context& context) {
  return {servo_field(context, servo_row("kp")), servo_field(context, servo_row("kd"))};
}

Fields servo_effort(const Context& context) { return {servo_field(context, servo_row("effort"))}; }

// Values that files have where they say any.
Fields joint_losses(const Context& context) {
  Fields fields;
  for (const auto& [name, values] : {std::pair{"armature", std::vector{0.0, 0.01, 0.03, 0.1}},
                                     {"damping", std::vector{0.0, 0.1, 0.5}},
                                     {"friction", std::vector{0.0, 0.2, 1.0}}}) {
    const std::size_t row = servo_row(name);
    CandidateField field = servo_field(context, row);
    for (const double value : values) {
      if (field.from != number(value)) field.changes.push_back({number(value), set_servos(row, value)});
    }
    fields.push_back(std::move(field));
  }
  return fields;
}

Fields drives(const Context& context) {
  Fields fields;
  for (const char* name : {"corner_speed", "no_load_speed", "backlash", "lag", "sensor_noise"}) {
    const std::size_t row = servo_row(name);
    if (context.config.servos.numbers[row].empty()) continue;
    CandidateField field = servo_field(context, row);
    field.changes.push_back({"none", set_servos(row, 0)});
    fields.push_back(std::move(field));
  }
  const std::size_t row = servo_row("delay");
  CandidateField delay = servo_field(context, row);
  for (const double value : {0.0, 0.01, 0.02}) {
    if (delay.from != number(value)) delay.changes.push_back({number(value), set_servos(row, value)});
  }
  fields.push_back(std::move(delay));
  return fields;
}

// ---- observation ----

std::size_t size_of(const Context& context, const ObservationTerm& term) {
  const ObservationContext blocks{
      context.config.joints.order, context.model.joints.home, {}, context.model.interface.action, {},
      context.config.observing};
  Layout layout;
  find_observation_block(term.block).describe(blocks, layout);
  return layout.size();
}

Scale scale_of_numbers(std::size_t index, std::size_t size, std::size_t begin, std::size_t end) {
  return [=](EnvConfig& c, double factor) {
    ObservationTerm& term = c.observation[index];
    term.scale = each_scale(term, size);
    for (std::size_t i = begin; i < end; ++i) term.scale[i] *= factor;
  };
}

Fields observation_scales(const Context& context) {
  Fields fields;
  for (std::size_t k = 0; k < context.config.observation.size(); ++k) {
    const ObservationTerm& term = context.config.observation[k];
    const std::size_t size = size_of(context, term);
    const std::vector<double> now = each_scale(term, size);
    CandidateField field{fmt::format("observation.{}.scale", term.block), numbers_in_words(now), {}};
    add_factors(field, scale_of_numbers(k, size, 0, size), now, {0.05, 0.25, 0.5, 2, 4, 20});
    if (term.block == "command") {
      field.from = fmt::format("{}", fmt::join(now, " "));
      add_factors(field, scale_of_numbers(k, size, 0, 2), {now[0]}, {0.5, 2}, "speeds ");
      add_factors(field, scale_of_numbers(k, size, 2, 3), {now[2]}, {0.25, 0.5, 2, 4}, "yaw rate ");
      field.changes.push_back({"1", [k](EnvConfig& c) { c.observation[k].scale = {}; }});
      field.changes.push_back({"2, 2, 0.25", [k](EnvConfig& c) { c.observation[k].scale = {2, 2, 0.25}; }});
    }
    fields.push_back(std::move(field));
  }
  return fields;
}

Fields observation_signs(const Context& context) {
  Fields fields;
  for (std::size_t k = 0; k < context.config.observation.size(); ++k) {
    const ObservationTerm& term = context.config.observation[k];
    const std::size_t size = size_of(context, term);
    CandidateField field{fmt::format("observation.{}.sign", term.block), "as it is", {}};
    const auto turn = [=](std::size_t begin, std::size_t end) {
      return [=](EnvConfig& c) { scale_of_numbers(k, size, begin, end)(c, -1); };
    };
    field.changes.push_back({"the other", turn(0, size)});
    if (term.block == "command") {
      field.changes.push_back({"the other, of the yaw rate", turn(2, 3)});
      field.changes.push_back({"the other, of the speed to the left", turn(1, 2)});
    }
    fields.push_back(std::move(field));
  }
  return fields;
}

// Blocks that are taken for one another.
constexpr std::array kTwins{
    std::pair{"base_angular_velocity_local", "base_angular_velocity"},
    std::pair{"base_linear_velocity_local", "base_linear_velocity"},
    std::pair{"joint_offsets", "joint_positions"},
    std::pair{"last_action", "joint_targets"},
    std::pair{"base_orientation", "base_orientation_xyzw"},
};

Fields observation_blocks_taken(const Context& context) {
  Fields fields;
  for (std::size_t k = 0; k < context.config.observation.size(); ++k) {
    const std::string& block = context.config.observation[k].block;
    for (const auto& [a, b] : kTwins) {
      if (block != a && block != b) continue;
      const std::string other = block == a ? b : a;
      fields.push_back({fmt::format("observation.{}", block), block, {{other, [k, other](EnvConfig& c) {
                                                                         c.observation[k].block = other;
                                                                       }}}});
    }
  }
  return fields;
}

// Terms in another order: two of one size changed with each other, and the command at every place.
Fields observation_order(const Context& context) {
  const std::vector<ObservationTerm>& terms = context.config.observation;
  std::vector<std::string> names;
  std::vector<std::size_t> sizes;
  for (const ObservationTerm& term : terms) {
    names.push_back(term.block);
    sizes.push_back(size_of(context, term));
  }
  CandidateField field{"observation", fmt::format("{}", fmt::join(names, ", ")), {}};
  for (std::size_t i = 0; i < terms.size(); ++i) {
    for (std::size_t j = i + 1; j < terms.size(); ++j) {
      if (sizes[i] == sizes[j])
        field.changes.push_back({fmt::format("{} and {} in each other's place", names[i], names[j]),
                                 [i, j](EnvConfig& c) { std::swap(c.observation[i], c.observation[j]); }});
    }
  }
  const auto at = std::find(names.begin(), names.end(), "command") - names.begin();
  for (std::ptrdiff_t to = 0; to < static_cast<std::ptrdiff_t>(terms.size()); ++to) {
    if (at == static_cast<std::ptrdiff_t>(terms.size()) || to == at) continue;
    field.changes.push_back({fmt::format("command at place {}", to + 1), [at, to](EnvConfig& c) {
                               const ObservationTerm command = c.observation[static_cast<std::size_t>(at)];
                               c.observation.erase(c.observation.begin() + at);
                               c.observation.insert(c.observation.begin() + to, command);
                             }});
  }
  return {std::move(field)};
}

Fields observation_limits(const Context& context) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  Fields fields;
  for (std::size_t k = 0; k < context.config.observation.size(); ++k) {
    const ObservationTerm& term = context.config.observation[k];
    const double least = std::min(term.clip, term.clip_unscaled);
    if (least < kNone)
      fields.push_back({fmt::format("observation.{}.clip", term.block),
                        number(least),
                        {{"none", [k](EnvConfig& c) {
                            c.observation[k].clip = c.observation[k].clip_unscaled = kNone;
                          }}}});
    if (term.noise > 0)
      fields.push_back({fmt::format("observation.{}.noise", term.block),
                        number(term.noise),
                        {{"0", [k](EnvConfig& c) { c.observation[k].noise = 0; }}}});
  }
  return fields;
}

Fields observation_delay(const Context& context) {
  double most = 0;
  for (const ObservationTerm& term : context.config.observation) most = std::max(most, term.delay);
  CandidateField field{"observation.delay", number(most), {}};
  for (const double value : {0.0, context.config.policy_dt}) {
    if (std::abs(value - most) > 1e-9)
      field.changes.push_back({number(value), [value](EnvConfig& c) {
                                 for (ObservationTerm& term : c.observation) term.delay = value;
                               }});
  }
  return {std::move(field)};
}

Fields history(const Context& context) {
  const auto& terms = context.config.observation;
  if (std::none_of(terms.begin(), terms.end(), [](const ObservationTerm& t) { return t.history > 1; }))
    return {};
  using History = HistorySettings;
  const History& now = context.config.observing.history;
  const auto in_words = [](const History& h) { return fmt::format("by {}, {}", name(h.by), name(h.order)); };
  CandidateField layout{"history", in_words(now), {}};
  for (const auto by : {History::By::kTerm, History::By::kFrame}) {
    for (const auto order : {History::Order::kNewestFirst, History::Order::kOldestFirst}) {
      History other = now;
      other.by = by;
      other.order = order;
      if (other != now)
        layout.changes.push_back({in_words(other), [other](EnvConfig& c) { c.observing.history = other; }});
    }
  }
  const auto before =
      now.before == History::Before::kFirst ? History::Before::kZeros : History::Before::kFirst;
  CandidateField fill{
      "history.before",
      std::string(name(now.before)),
      {{std::string(name(before)), [before](EnvConfig& c) { c.observing.history.before = before; }}}};
  return {std::move(layout), std::move(fill)};
}

// ---- rates and world ----

Fields rates(const Context& context) {
  CandidateField policy{"policy_dt", number(context.config.policy_dt), {}};
  for (const double value : {0.005, 0.01, 0.015, 0.02, 0.025, 0.03, 0.04, 0.05}) {
    if (std::abs(value - context.config.policy_dt) > 1e-9)
      policy.changes.push_back({number(value), [value](EnvConfig& c) { c.policy_dt = value; }});
  }
  CandidateField physics{"physics_dt", number(context.config.physics_dt), {}};
  for (const double value : {0.001, 0.002, 0.004, 0.005}) {
    if (std::abs(value - context.config.physics_dt) > 1e-9)
      physics.changes.push_back({number(value), [value](EnvConfig& c) {
                                   c.physics_dt = value;
                                   if (!is_whole_multiple(c.control_dt, value)) c.control_dt = value;
                                 }});
  }
  return {std::move(policy), std::move(physics)};
}

// A setting of contact.
FieldChange contact_change(const std::string& name, const std::string& value) {
  return {fmt::format("{} {}", name, value),
          [=](EnvConfig& c) { c.contact.set(name, value, "diagnosis", name); }};
}

Fields ground_friction(const Context& context) {
  const double now = context.model.world.contact.friction;
  CandidateField field{"friction", number(now), {}};
  for (const double value : {0.4, 0.6, 0.8, 1.0, 1.2}) {
    if (std::abs(value - now) > 1e-9)
      field.changes.push_back({number(value), [value](EnvConfig& c) { c.contact.add(friction_of(value)); }});
  }
  return {std::move(field)};
}

Fields contact_law(const Context&) {
  CandidateField field{"contact", "as stated", {}};
  field.changes = {contact_change("solref", "0.005:1"), contact_change("solref", "0.02:1"),
                   contact_change("impratio", "1"),     contact_change("impratio", "100"),
                   contact_change("cone", "pyramidal"), contact_change("cone", "elliptic")};
  return {std::move(field)};
}

// Engines of another law of contact; those of the same one walk alike.
Fields engine(const Context& context) {
  CandidateField field{"engine", context.config.engine, {}};
  std::set<std::string> laws{std::string(find_engine(context.config.engine).info.laws.contact_law())};
  for (const std::string& other : available_engines()) {
    if (laws.insert(std::string(find_engine(other).info.laws.contact_law())).second)
      field.changes.push_back({other, [other](EnvConfig& c) { c.engine = other; }});
  }
  return {std::move(field)};
}

constexpr bool kPhysics = true, kContract = false;

constexpr std::array kRows{
    FieldRow{"joints.order", "which joint each number of action and observation is", kContract, 10,
             joint_order},
    FieldRow{"joints.signs", "which way joints turn", kContract, 2, joint_signs},
    FieldRow{"joints.home", "default pose", kContract, 4, joint_home},
    FieldRow{"joints.offset", "targets of the zero action", kContract, 4, joint_offset},
    FieldRow{"joints.scale", "of actions", kContract, 4, joint_scale},
    FieldRow{"joints.command", "what an action says", kContract, 4, joint_command},
    FieldRow{"joints.limit", "clips of actions and targets", kContract, 2, joint_limits},
    FieldRow{"joints.filter", "low pass of targets", kContract, 3, joint_filter},
    FieldRow{"joints.delay", "from action to targets", kContract, 3, joint_delay},
    FieldRow{"observation", "order of the terms", kContract, 4, observation_order},
    FieldRow{"observation.BLOCK", "frame, zero, order of a quaternion, raw or processed", kContract, 8,
             observation_blocks_taken},
    FieldRow{"observation.BLOCK.scale", "of a term", kContract, 4, observation_scales},
    FieldRow{"observation.BLOCK.sign", "of a term", kContract, 2, observation_signs},
    FieldRow{"observation.BLOCK.clip", "clip and noise of a term", kContract, 2, observation_limits},
    FieldRow{"observation.delay", "age of what is seen", kContract, 3, observation_delay},
    FieldRow{"history", "layout, and what was before the episode", kContract, 4, history},
    FieldRow{"policy_dt", "rates of policy and physics", kContract, 6, rates},
    FieldRow{"servos.kp", "gains", kContract, 7, servo_gains},
    FieldRow{"servos.effort", "torque limit", kContract, 2, servo_effort},
    FieldRow{"servos.armature", "armature, damping, dry friction", kContract, 5, joint_losses},
    FieldRow{"servos.delay", "what drives fall short of", kContract, 3, drives},
    FieldRow{"friction", "of the ground", kContract, 6, ground_friction},
    FieldRow{"contact", "softness, cone, impratio", kPhysics, 6, contact_law},
    FieldRow{"engine", "another engine or contact law", kPhysics, 6, engine},
};

}  // namespace

std::span<const FieldRow> field_rows() { return kRows; }

EnvConfig with_joints_stated(const EnvModel& model) {
  EnvConfig config = model.config;
  const EnvConfig stated = model.stated();
  config.joints.order = stated.joints.order;
  config.joints.home = stated.joints.home;
  config.joints.scale = stated.joints.scale;
  return config;
}

}  // namespace crossgait
