#include "policy/hierarchical_policy.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/error.h"
#include "physics/core/random.h"
#include "physics/core/yaml_reader.h"
#include "policy/bundled_policies.h"

namespace crossgait {
namespace {

constexpr double kTimeRounding = 1e-9;  // relative, of times written as decimals

std::vector<std::size_t> places(const std::string& source, std::string_view element, const Layout& whole,
                                const Layout& part) {
  std::vector<std::size_t> indices;
  for (const LayoutEntry& entry : part.entries) {
    const auto index = whole.find(entry.name);
    if (!index) {
      throw ConfigError(source, fmt::format("{} {}", element, entry.name),
                        fmt::format("one of {}", fmt::join(whole.names(), ", ")), "an unknown entry");
    }
    indices.push_back(*index);
  }
  return indices;
}

std::int64_t whole_steps(const std::string& source, double planner_dt, double policy_dt) {
  const double steps = planner_dt / policy_dt;
  constexpr double kMost = 1e9;  // policy steps between plans
  if (!(steps >= 1 - kTimeRounding && steps <= kMost &&
        std::abs(steps - std::round(steps)) <= kTimeRounding * steps)) {
    throw ConfigError(source, "planner.dt", fmt::format("a multiple of the policy step, {:g} s", policy_dt),
                      fmt::format("{:g} s", planner_dt));
  }
  return std::llround(steps);
}

bool is_hierarchical(const std::string& file) {
  return file.ends_with(".yaml") && YamlValue::load(file).at("kind").text() == "hierarchical";
}

PolicyFactory load_member(const YamlValue& yaml) {
  const YamlValue value = yaml.at("policy");
  const std::string policy = value.text();
  if (policy == "zero" || policy == "random") return load_policy(policy);
  try {
    const std::string file = find_policy_file(std::filesystem::path(yaml.source()).parent_path() / policy);
    // A member's action has one of the two parts that a hierarchy needs; it could also be its own member.
    if (is_hierarchical(file)) value.fail("a policy of one part of the action", "a hierarchy of two");
    return load_policy(file);
  } catch (const ConfigError& error) {
    value.fail(error);
  }
}

std::unique_ptr<Policy> make_member(const YamlValue& yaml, const PolicyFactory& make,
                                    const PolicyInterface& whole, std::string_view part, double policy_dt) {
  std::vector<std::string> observation;
  if (const auto list = yaml.find("observation")) {
    for (const YamlValue& item : list->items()) observation.push_back(item.text());
    if (observation.empty()) list->fail("at least one name", "none");
  }
  const std::string source = fmt::format("{}: {}", yaml.source(), yaml.element());
  const PolicyInterface interface = member_interface(whole, observation, part, policy_dt, source);
  try {
    return make(interface);
  } catch (const ConfigError& error) {
    yaml.at("policy").fail(error);
  }
}

}  // namespace

HierarchicalPolicy::Member::Member(const std::string& source, const PolicyInterface& whole,
                                   std::unique_ptr<Policy> member)
    : policy(std::move(member)),
      observation_at(places(source, "observation", whole.observation, policy->interface().observation)),
      action_at(places(source, "action", whole.action, policy->interface().action)),
      observation(observation_at.size()),
      action(action_at.size()) {}

void HierarchicalPolicy::Member::act(std::span<const double> whole_observation) noexcept {
  for (std::size_t i = 0; i < observation.size(); ++i) observation[i] = whole_observation[observation_at[i]];
  policy->act(observation, action);
}

void HierarchicalPolicy::Member::write(std::span<double> whole_action) const noexcept {
  for (std::size_t i = 0; i < action.size(); ++i) whole_action[action_at[i]] = action[i];
}

HierarchicalPolicy::HierarchicalPolicy(std::string name, const PolicyInterface& interface,
                                       std::unique_ptr<Policy> planner, std::unique_ptr<Policy> residual,
                                       const HierarchicalOptions& options)
    : Policy(std::move(name), interface),
      planner_(this->name(), interface, std::move(planner)),
      residual_(this->name(), interface, std::move(residual)),
      options_(options),
      period_(whole_steps(this->name(), planner_.policy->interface().policy_dt, interface.policy_dt)) {
  if (whole_steps(this->name(), residual_.policy->interface().policy_dt, interface.policy_dt) != 1) {
    throw ConfigError(this->name(), "residual", fmt::format("a policy of {:g} s", interface.policy_dt),
                      fmt::format("{:g} s", residual_.policy->interface().policy_dt));
  }
  for (std::size_t i = 0; i < interface.action.size(); ++i) {
    const auto writes = [i](const Member& member) {
      return std::count(member.action_at.begin(), member.action_at.end(), i);
    };
    const std::string& entry = interface.action.entries[i].name;
    const std::int64_t planned = entry.starts_with(kDeltaPrefix) ? 1 : 0,
                       fast = entry.starts_with(kResidualPrefix) ? 1 : 0;
    if (planned + fast != 1 || writes(planner_) != planned || writes(residual_) != fast) {
      throw ConfigError(
          this->name(), fmt::format("action {}", entry),
          "delta.* from the planner, residual.* from the residual policy",
          fmt::format("{} of the planner, {} of the residual policy", writes(planner_), writes(residual_)));
    }
  }
}

void HierarchicalPolicy::do_reset(std::uint64_t seed) noexcept {
  planner_.policy->reset(derived_seed(seed, 0));
  residual_.policy->reset(derived_seed(seed, 1));
  acts_ = 0;
}

void HierarchicalPolicy::do_act(std::span<const double> observation, std::span<double> action) noexcept {
  if (acts_++ % period_ == 0) {
    planner_.act(observation);
  } else if (!options_.hold_deltas) {
    std::fill(planner_.action.begin(), planner_.action.end(), 0.0);
  }
  residual_.act(observation);
  planner_.write(action);
  residual_.write(action);
}

PolicyInterface member_interface(const PolicyInterface& whole, const std::vector<std::string>& observation,
                                 std::string_view part, double policy_dt, const std::string& source) {
  PolicyInterface interface {
    .observation = {}, .action = {}, .policy_dt = policy_dt, .adaptation = whole.adaptation
  };
  if (observation.empty()) interface.observation = whole.observation;
  for (const std::string& name : observation) {
    bool found = false;
    for (const LayoutEntry& entry : whole.observation.entries) {
      if (name.ends_with('.') ? !entry.name.starts_with(name) : entry.name != name) continue;
      found = true;
      if (interface.observation.find(entry.name)) {
        throw ConfigError(source, "observation", "each entry once", fmt::format("{} twice", entry.name));
      }
      interface.observation.entries.push_back(entry);
    }
    if (!found) {
      throw ConfigError(source, fmt::format("observation {}", name),
                        fmt::format("one of {}, or a beginning that ends in '.'",
                                    fmt::join(whole.observation.names(), ", ")),
                        "an unknown entry");
    }
  }
  std::copy_if(whole.action.entries.begin(), whole.action.entries.end(),
               std::back_inserter(interface.action.entries),
               [part](const LayoutEntry& entry) { return entry.name.starts_with(part); });
  if (interface.action.entries.empty()) {
    throw ConfigError(source, "action", fmt::format("entries {}*", part), "none");
  }
  return interface;
}

PolicyFactory load_hierarchical_policy(const YamlValue& root) {
  root.allow_keys({"kind", "layout_version", "planner", "residual", "hold_deltas"});
  const YamlValue planner = root.at("planner"), residual = root.at("residual");
  planner.allow_keys({"policy", "observation", "dt"});
  residual.allow_keys({"policy", "observation"});
  constexpr double kPlannerDt = 0.1;  // s, the guide's 10 Hz
  const auto dt_value = planner.find("dt");
  const double planner_dt = dt_value ? dt_value->number() : kPlannerDt;
  HierarchicalOptions options;
  if (const auto hold = root.find("hold_deltas")) options.hold_deltas = hold->boolean();
  return [planner, residual, planner_dt, options, make_planner = load_member(planner),
          make_residual = load_member(residual)](const PolicyInterface& interface) {
    const std::string& source = planner.source();
    (void)whole_steps(source, planner_dt, interface.policy_dt);  // here, where the file's path is known
    return std::make_unique<HierarchicalPolicy>(
        std::filesystem::path(source).filename(), interface,
        make_member(planner, make_planner, interface, kDeltaPrefix, planner_dt),
        make_member(residual, make_residual, interface, kResidualPrefix, interface.policy_dt), options);
  };
}

}  // namespace crossgait
