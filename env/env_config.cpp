#include "crossgait/env/env_config.h"

#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "crossgait/env/time_steps.h"
#include "crossgait/physics/error.h"
#include "crossgait/physics/yaml_reader.h"

namespace crossgait {
namespace {

void require(bool ok, std::string_view source, std::string_view element, std::string_view expected,
             double found) {
  if (!ok) throw ConfigError(source, element, expected, fmt::format("{:g}", found));
}

void require_multiple(std::string_view source, std::string_view element, double longer, double shorter) {
  require(is_whole_multiple(longer, shorter), source, element,
          fmt::format("a whole multiple of {:g} s", shorter), longer);
}

// Reports a bad name or value of a table at the line of the file where it stands.
template <typename Function>
auto at_line(const YamlValue& value, Function&& function) {
  try {
    return function();
  } catch (const ConfigError& error) {
    value.fail(error.expected(), error.found());
  }
}

// The same for a value that is itself a name of a table.
template <typename Function>
auto named(const YamlValue& value, Function&& find) {
  try {
    return find(value.text());
  } catch (const ConfigError& error) {
    value.fail(error.expected(), value.text());
  }
}

void read(const YamlValue& root, std::string_view key, double& value) {
  if (const auto found = root.find(key)) value = found->number();
}
void read(const YamlValue& root, std::string_view key, std::string& value) {
  if (const auto found = root.find(key)) value = found->text();
}

std::vector<std::string> read_names(const YamlValue& list) {
  std::vector<std::string> names;
  for (const YamlValue& item : list.items()) names.push_back(item.text());
  return names;
}

void read_gait(const YamlValue& root, EnvConfig& config) {
  if (const auto gait = root.find("gait")) {
    config.gait = gait->text();
    config.parameters = named(*gait, [](const std::string& name) { return find_gait(name).preferred; });
  }
  if (const auto parameters = root.find("parameters")) {
    for (const auto& [name, value] : parameters->entries()) {
      at_line(value, [&, &name = name, &value = value] {
        if (name == "swing") {
          assign(config.parameters, "swing=" + value.text());
        } else {
          set(config.parameters, name, value.number());
        }
      });
    }
  }
  if (const auto adapt = root.find("adapt")) {
    config.adapt = read_names(*adapt);
    for (const YamlValue& item : adapt->items())
      named(item, [](const std::string& name) { static_cast<void>(find_parameter(name)); });
  }
  read(root, "residual_scale", config.residual_scale);
  if (const auto command = root.find("command")) {
    command->allow_keys({"vx", "vy", "yaw_rate"});
    config.command.emplace();
    read(*command, "vx", config.command->vx);
    read(*command, "vy", config.command->vy);
    read(*command, "yaw_rate", config.command->yaw_rate);
  }
}

void read_tables(const YamlValue& root, EnvConfig& config) {
  if (const auto blocks = root.find("observation")) {
    config.observation = read_names(*blocks);
    for (const YamlValue& item : blocks->items())
      named(item, [](const std::string& name) { static_cast<void>(find_observation_block(name)); });
  }
  if (const auto reward = root.find("reward")) {
    config.reward.fill(0);
    for (const auto& [name, weight] : reward->entries()) {
      config.reward[at_line(weight, [&name = name] { return find_reward_term(name); })] = weight.number();
    }
  }
  if (const auto randomisation = root.find("randomisation")) {
    for (const auto& [name, range] : randomisation->entries()) {
      const RandomisationRow& row =
          at_line(range, [&name = name]() -> const RandomisationRow& { return find_randomisation(name); });
      const std::vector<YamlValue> ends = range.items();
      if (ends.size() != 2) range.fail("[min, max]", fmt::format("{} values", ends.size()));
      config.randomisation[row.what] = {ends[0].number(), ends[1].number()};
    }
  }
}

void read_ends(const YamlValue& root, EnvConfig& config) {
  const auto ends = root.find("ends");
  if (!ends) return;
  config.ends = OutcomeSet::that_end({});
  for (const YamlValue& item : ends->items())
    config.ends.add(named(item, [](const std::string& name) { return find_ending_outcome(name); }));
}

EnvConfig read_config(const YamlValue& root) {
  root.allow_keys(
      {"engine",         "backend",    "robot",        "terrain",        "terrain_seed",    "friction",
       "gait",           "parameters", "adapt",        "residual_scale", "command",         "observation",
       "reward",         "physics_dt", "control_dt",   "policy_dt",      "episode_seconds", "settle_seconds",
       "tilt_limit_deg", "ends",       "randomisation"});
  EnvConfig config;
  read(root, "backend", config.engine);  // its name before plug-ins
  read(root, "engine", config.engine);
  read(root, "robot", config.robot);
  read(root, "terrain", config.terrain);
  if (const auto seed = root.find("terrain_seed")) {
    if (seed->integer() < 0) seed->fail("a whole number of 0 or more", fmt::format("{}", seed->integer()));
    config.terrain_seed = static_cast<std::uint64_t>(seed->integer());
  }
  read(root, "friction", config.friction);
  read_gait(root, config);
  read_tables(root, config);
  read(root, "physics_dt", config.physics_dt);
  read(root, "control_dt", config.control_dt);
  read(root, "policy_dt", config.policy_dt);
  read(root, "episode_seconds", config.episode_seconds);
  read(root, "settle_seconds", config.settle_seconds);
  read(root, "tilt_limit_deg", config.tilt_limit_deg);
  read_ends(root, config);
  config.validate(root.source());
  return config;
}

template <typename Rows, typename Value>
void write_map(std::string& out, std::string_view key, const Rows& rows, const Value& value) {
  out += fmt::format("{}:\n", key);
  for (const auto& row : rows) {
    const std::string text = value(row);
    if (!text.empty()) out += fmt::format("  {}: {}\n", row.name, text);
  }
}

}  // namespace

void EnvConfig::validate(std::string_view source) const {
  require(physics_dt > 0 && physics_dt <= 0.1, source, "physics_dt", "a time step in (0, .1] s", physics_dt);
  require_multiple(source, "control_dt", control_dt, physics_dt);
  require_multiple(source, "policy_dt", policy_dt, control_dt);
  require(episode_seconds >= policy_dt && episode_seconds <= 1e6, source, "episode_seconds",
          "at least one policy step and at most 1e6 s", episode_seconds);
  require(episode_seconds / physics_dt < std::numeric_limits<int>::max(), source, "physics_dt",
          "a time step of which fewer than 2^31 make an episode", physics_dt);
  require(settle_seconds >= 0 && settle_seconds <= 1e3, source, "settle_seconds", "0 to 1e3 s",
          settle_seconds);
  require(tilt_limit_deg > 0 && tilt_limit_deg <= 180, source, "tilt_limit_deg",
          "an angle in (0, 180] degrees", tilt_limit_deg);
  require(std::isfinite(friction) && friction >= 0, source, "friction", "a coefficient of 0 or more",
          friction);
  crossgait::validate(parameters, source);
  static_cast<void>(find_gait(gait));
  if (command && !command->is_finite())
    throw ConfigError(source, "command", "finite velocities", "values that are not");
  if (observation.empty()) throw ConfigError(source, "observation", "at least one block", "none");
  for (std::size_t i = 0; i < observation.size(); ++i) {
    static_cast<void>(find_observation_block(observation[i]));
    for (std::size_t j = 0; j < i; ++j) {
      if (observation[i] == observation[j])
        throw ConfigError(source, "observation", "every block once", fmt::format("{} twice", observation[i]));
    }
  }
  for (std::size_t i = 0; i < reward.size(); ++i)
    require(std::isfinite(reward[i]), source, reward_terms()[i].name, "a finite weight", reward[i]);
  randomisation.validate();
}

EnvConfig load_env_config(const std::string& path) { return read_config(YamlValue::load(path)); }

EnvConfig parse_env_config(const std::string& text, const std::string& source) {
  return read_config(YamlValue::parse(text, source));
}

std::string to_yaml(const EnvConfig& c) {
  std::string out =
      fmt::format("engine: {}\nrobot: '{}'\nterrain: '{}'\nterrain_seed: {}\nfriction: {}\ngait: {}\n",
                  c.engine, c.robot, c.terrain, c.terrain_seed, c.friction, c.gait);
  write_map(out, "parameters", gait_parameters(),
            [&](const ParameterRow& row) { return fmt::format("{}", c.parameters.*row.member); });
  out += fmt::format("  swing: {}\n", name(c.parameters.swing));
  out += fmt::format("adapt: [{}]\nresidual_scale: {}\n", fmt::join(c.adapt, ", "), c.residual_scale);
  if (c.command) {
    out += fmt::format("command: {{vx: {}, vy: {}, yaw_rate: {}}}\n", c.command->vx, c.command->vy,
                       c.command->yaw_rate);
  }
  out += fmt::format("observation: [{}]\n", fmt::join(c.observation, ", "));
  std::string weights;
  for (std::size_t i = 0; i < c.reward.size(); ++i) {
    if (c.reward[i] != 0) weights += fmt::format("  {}: {}\n", reward_terms()[i].name, c.reward[i]);
  }
  out += weights.empty() ? "reward: {}\n" : "reward:\n" + weights;
  out += fmt::format(
      "physics_dt: {}\ncontrol_dt: {}\npolicy_dt: {}\nepisode_seconds: {}\nsettle_seconds: "
      "{}\ntilt_limit_deg: {}\n",
      c.physics_dt, c.control_dt, c.policy_dt, c.episode_seconds, c.settle_seconds, c.tilt_limit_deg);
  out += fmt::format("ends: [{}]\n", fmt::join(outcome_names(c.ends), ", "));
  std::string ranges;
  for (const RandomisationRow& row : randomisation_rows()) {
    const Range& range = c.randomisation[row.what];
    if (c.randomisation.is_on(row.what))
      ranges += fmt::format("  {}: [{}, {}]\n", row.name, range.min, range.max);
  }
  if (!ranges.empty()) out += "randomisation:\n" + ranges;
  return out;
}

}  // namespace crossgait
