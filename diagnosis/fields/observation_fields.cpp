// What a policy sees, and how much of the past.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <string_view>

#include "diagnosis/fields/changes.h"
#include "diagnosis/fields/fields.h"
#include <fmt/format.h>

namespace crossgait::fields {
namespace {

std::size_t size_of(const Context& context, const ObservationTerm& term) {
  std::vector<std::string> joints;
  for (const int i : context.model.joints.observed)
    joints.push_back(context.model.world.robot->joint(i).name);
  const ObservationContext blocks{joints, context.model.joints.observed_home,
                                  {},     context.model.interface.action,
                                  {},     context.config.observing};
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

const std::map<std::string_view, double> kUsualScales{
    {"base_linear_velocity_local", 2}, {"base_angular_velocity_local", 0.25}, {"joint_velocities", 0.05}};

// Blocks that are taken for one another.
constexpr std::array kTwins{
    std::pair{"base_angular_velocity_local", "base_angular_velocity"},
    std::pair{"base_linear_velocity_local", "base_linear_velocity"},
    std::pair{"joint_offsets", "joint_positions"},
    std::pair{"last_action", "joint_targets"},
    std::pair{"base_orientation", "base_orientation_xyzw"},
};

}  // namespace

Fields observation_scales(const Context& context) {
  Fields fields;
  for (std::size_t k = 0; k < context.config.observation.size(); ++k) {
    const ObservationTerm& term = context.config.observation[k];
    const std::size_t size = size_of(context, term);
    const std::vector<double> now = each_scale(term, size);
    CandidateField field{fmt::format("observation.{}.scale", term.block), numbers_in_words(now), {}};
    add_factors(field, scale_of_numbers(k, size, 0, size), now, {0.05, 0.11, 0.22, 0.5, 2, 4.5, 9, 20});
    if (term.block == "command") {
      field.from = fmt::format("{}", fmt::join(now, " "));
      add_factors(field, scale_of_numbers(k, size, 0, 2), {now[0]}, {0.5, 2}, "speeds ");
      add_factors(field, scale_of_numbers(k, size, 2, 3), {now[2]}, {0.25, 0.5, 2, 4}, "yaw rate ");
      field.changes.push_back({"1", [k](EnvConfig& c) { c.observation[k].scale = {}; }});
      field.changes.push_back({"2, 2, 0.25", [k](EnvConfig& c) { c.observation[k].scale = {2, 2, 0.25}; }});
    } else {
      // What is not scaled, and obs_scales of legged_gym.
      std::vector<double> usual{1};
      if (const auto scale = kUsualScales.find(term.block); scale != kUsualScales.end())
        usual.push_back(scale->second);
      for (const double scale : usual) {
        std::vector<double> with = now;
        for (double& number : with) number = std::copysign(scale, number);  // signs are another field
        if (with == now) continue;
        field.changes.push_back(
            {fmt::format("{:g}", scale), [k, with](EnvConfig& c) { c.observation[k].scale = with; }});
      }
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

}  // namespace crossgait::fields
