#include "policy/scripted_policy.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "gait/parameters.h"
#include "physics/core/yaml_reader.h"

namespace crossgait {
namespace {

std::size_t find_entry(const Layout& layout, const std::string& name, const YamlValue& value) {
  if (const auto index = layout.find(name)) return *index;
  value.fail(fmt::format("one of {}", fmt::join(layout.names(), ", ")), "an unknown action entry");
}

ScriptedEntry read_constant(const PolicyInterface& interface, const std::string& name,
                            const YamlValue& value) {
  const double constant = value.number();
  const std::size_t index = find_entry(interface.action, name, value);
  const LayoutEntry& entry = interface.action.entries[index];
  if (constant < entry.min || constant > entry.max)
    value.fail(fmt::format("{:g} to {:g}", entry.min, entry.max), fmt::format("{:g}", constant));
  return {.action = index, .constant = constant, .gain = 0, .observation = 0};
}

ParameterRow find_adapted(const PolicyInterface& interface, const std::string& name, const YamlValue& value) {
  std::vector<std::string_view> adapted;
  for (const ParameterRow& row : gait_parameters()) {
    if (!interface.action.find(fmt::format("{}{}", kDeltaPrefix, row.name))) continue;
    if (row.name == name) return interface.adaptation.row(name);
    adapted.push_back(row.name);
  }
  value.fail(fmt::format("one of the parameters that adapt: {}",
                         adapted.empty() ? "none" : fmt::format("{}", fmt::join(adapted, ", "))),
             "another name");
}

/// The delta that moves a parameter towards its target: (target - current) / delta_scale, limited by the clip
/// of every action. The current value is observed normalised: min + (value + 1) / 2 (max - min).
ScriptedEntry read_target(const PolicyInterface& interface, const std::string& name, const YamlValue& value) {
  const ParameterRow row = find_adapted(interface, name, value);
  const std::string observed = fmt::format("param.{}", name);
  const auto observation = interface.observation.find(observed);
  if (!observation) value.fail(fmt::format("an observation with {}", observed), "one without");
  const double target = value.number();
  if (target < row.min || target > row.max) {
    value.fail(fmt::format("{:g} to {:g} {}", row.min, row.max, row.unit), fmt::format("{:g}", target));
  }
  const double half_range = (row.max - row.min) / 2;
  return {.action = *interface.action.find(fmt::format("{}{}", kDeltaPrefix, name)),
          .constant = (target - row.min - half_range) / row.delta_scale,
          .gain = -half_range / row.delta_scale,
          .observation = *observation};
}

ScriptedStep read_step(const YamlValue& yaml, const PolicyInterface& interface) {
  yaml.allow_keys({"time", "action", "parameters"});
  const YamlValue time = yaml.at("time");
  ScriptedStep step;
  // The first policy step at or after the time; less than a rounding error late counts as at.
  constexpr double kRounding = 1e-9;
  const double acts = std::ceil(time.number() / interface.policy_dt - kRounding);
  constexpr double kMost = 1e15;  // policy steps; counts up to here are exact
  if (!(time.number() >= 0 && acts <= kMost))
    time.fail("a time of 0 s or more", fmt::format("{:g}", time.number()));
  step.first_act = static_cast<std::int64_t>(acts);
  const auto add = [&](const ScriptedEntry& entry, const YamlValue& value) {
    const auto same = [&](const ScriptedEntry& other) { return other.action == entry.action; };
    if (std::any_of(step.entries.begin(), step.entries.end(), same)) {
      value.fail("each action entry once", "a second one in the same step");
    }
    step.entries.push_back(entry);
  };
  if (const auto action = yaml.find("action")) {
    for (const auto& [name, value] : action->entries()) add(read_constant(interface, name, value), value);
  }
  if (const auto parameters = yaml.find("parameters")) {
    for (const auto& [name, value] : parameters->entries()) add(read_target(interface, name, value), value);
  }
  return step;
}

}  // namespace

ScriptedPolicy::ScriptedPolicy(std::string name, PolicyInterface interface, std::vector<ScriptedStep> steps)
    : Policy(std::move(name), std::move(interface)), steps_(std::move(steps)) {}

void ScriptedPolicy::do_reset(std::uint64_t /*seed*/) noexcept {
  acts_ = 0;
  begun_ = 0;
}

void ScriptedPolicy::do_act(std::span<const double> observation, std::span<double> action) noexcept {
  std::fill(action.begin(), action.end(), 0.0);
  while (begun_ < steps_.size() && steps_[begun_].first_act <= acts_) ++begun_;
  ++acts_;
  if (begun_ == 0) return;
  for (const ScriptedEntry& entry : steps_[begun_ - 1].entries) {
    action[entry.action] = entry.constant;
    if (entry.gain != 0) action[entry.action] += entry.gain * observation[entry.observation];
  }
}

namespace {

std::unique_ptr<Policy> make(const YamlValue& root, const PolicyInterface& interface) {
  root.allow_keys({"kind", "layout_version", "steps"});
  const YamlValue list = root.at("steps");
  std::vector<ScriptedStep> steps;
  for (const YamlValue& item : list.items()) {
    ScriptedStep step = read_step(item, interface);
    if (!steps.empty() && step.first_act <= steps.back().first_act) {
      item.at("time").fail(
          fmt::format("at least one policy step ({:g} s) after the step before", interface.policy_dt),
          fmt::format("{:g}", item.at("time").number()));
    }
    steps.push_back(std::move(step));
  }
  if (steps.empty()) list.fail("at least one step", "none");
  return std::make_unique<ScriptedPolicy>(std::filesystem::path(root.source()).filename(), interface,
                                          std::move(steps));
}

}  // namespace

PolicyFactory load_scripted_policy(const YamlValue& root) { return std::bind_front(&make, root); }

}  // namespace crossgait
