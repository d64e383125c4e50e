#include "crossgait/env/env_config.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "crossgait/env/time_steps.h"
#include "crossgait/physics/data_path.h"
#include "crossgait/physics/error.h"
#include "crossgait/physics/world_spec.h"
#include "crossgait/physics/yaml_reader.h"

namespace crossgait {
namespace {

void require(bool ok, std::string_view source, std::string_view element, std::string_view expected,
             double found) {
  if (!ok) throw ConfigError(source, element, expected, fmt::format("{:g}", found));
}

constexpr double kMostSteps = 1e9;  // of one kind inside another: counts are int

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

// The same for an error that names one of a mapping's keys.
template <typename Function>
void at_key(const YamlValue& mapping, Function&& function) {
  try {
    function();
  } catch (const ConfigError& error) {
    if (const auto value = mapping.find(error.element())) value->fail(error.expected(), error.found());
    throw ConfigError(mapping.source(), error.element(), error.expected(), error.found());
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
void read(const YamlValue& root, std::string_view key, bool& value) {
  if (const auto found = root.find(key)) value = found->boolean();
}
void read(const YamlValue& root, std::string_view key, std::string& value) {
  if (const auto found = root.find(key)) value = found->text();
}

std::vector<std::string> read_names(const YamlValue& list) {
  std::vector<std::string> names;
  for (const YamlValue& item : list.items()) names.push_back(item.text());
  return names;
}

Range read_range(const YamlValue& value) {
  const std::vector<YamlValue> ends = value.items();
  if (ends.size() != 2) value.fail("[min, max]", fmt::format("{} values", ends.size()));
  return {ends[0].number(), ends[1].number()};
}

void read_ranges(const YamlValue& root, EnvConfig& config) {
  // One by one, so that what is wrong is found where it stands.
  const auto check = [](const YamlValue& value, const AdaptationRanges& one) {
    at_line(value, [&] { one.validate(value.source()); });
  };
  if (const auto ranges = root.find("ranges")) {
    for (const auto& [name, value] : ranges->entries()) {
      const Range range = read_range(value);
      config.adaptation.ranges[name] = {range.min, range.max};
      check(value, {{{name, {range.min, range.max}}}, {}});
    }
  }
  if (const auto scales = root.find("delta_scales")) {
    for (const auto& [name, value] : scales->entries()) {
      config.adaptation.delta_scales[name] = value.number();
      check(value, {config.adaptation.ranges, {{name, value.number()}}});
    }
  }
}

void read_gait(const YamlValue& root, EnvConfig& config) {
  if (const auto gait = root.find("gait")) {
    config.gait = gait->text();
    named(*gait, [](const std::string& name) { static_cast<void>(find_gait(name)); });
    config.parameters = {};
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
  read_ranges(root, config);
  if (const auto scale = root.find("residual_scale")) config.residual_scale = scale->number();
  if (const auto command = root.find("command")) {
    command->allow_keys({"vx", "vy", "yaw_rate"});
    config.command.emplace();
    read(*command, "vx", config.command->vx);
    read(*command, "vy", config.command->vy);
    read(*command, "yaw_rate", config.command->yaw_rate);
  }
  read(root, "heading_hold", config.heading_hold);
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
      config.randomisation[row.what] = read_range(range);
    }
    at_key(*randomisation, [&] { config.randomisation.validate(); });
  }
}

// A file from the folder of the file that names it; anything else as it is.
std::string resolved(const std::string& text, const std::string& from, bool is_file) {
  const std::filesystem::path path(text);
  if (!is_file || path.is_absolute()) return text;
  return (std::filesystem::path(from).parent_path() / path).lexically_normal().string();
}

void read_world(const YamlValue& root, EnvConfig& config) {
  read(root, "backend", config.engine);  // its name before plug-ins
  read(root, "engine", config.engine);
  if (const auto robot = root.find("robot")) {
    config.robot = resolved(robot->text(), root.source(), is_robot_file(robot->text()));
    config.places.push_back({config.robot, root.source(), robot->element()});
  }
  if (const auto terrain = root.find("terrain")) {
    config.terrain = resolved(terrain->text(), root.source(), is_terrain_file(terrain->text()));
    config.places.push_back({config.terrain, root.source(), terrain->element()});
  }
  if (const auto seed = root.find("terrain_seed")) config.terrain_seed = seed->seed();
  read(root, "friction", config.friction);
}

void read_ends(const YamlValue& root, EnvConfig& config) {
  const auto ends = root.find("ends");
  if (!ends) return;
  config.ends = OutcomeSet::that_end({});
  for (const YamlValue& item : ends->items())
    config.ends.add(named(item, [](const std::string& name) { return find_ending_outcome(name); }));
}

EnvConfig read_config(const YamlValue& root) {
  root.allow_keys({"preset",          "engine",         "backend",        "robot",      "terrain",
                   "terrain_seed",    "friction",       "gait",           "parameters", "adapt",
                   "ranges",          "delta_scales",   "residual_scale", "command",    "heading_hold",
                   "observation",     "reward",         "physics_dt",     "control_dt", "policy_dt",
                   "episode_seconds", "settle_seconds", "tilt_limit_deg", "ends",       "randomisation"});
  EnvConfig config;
  if (const auto preset = root.find("preset")) {
    if (preset->text() != "guide") preset->fail("guide", fmt::format("'{}'", preset->text()));
    config = guide_environment();
  }
  read_world(root, config);
  read_gait(root, config);
  read_tables(root, config);
  read(root, "physics_dt", config.physics_dt);
  read(root, "control_dt", config.control_dt);
  read(root, "policy_dt", config.policy_dt);
  read(root, "episode_seconds", config.episode_seconds);
  read(root, "settle_seconds", config.settle_seconds);
  read(root, "tilt_limit_deg", config.tilt_limit_deg);
  read_ends(root, config);
  at_key(root, [&] { config.validate(root.source()); });
  return config;
}

// Names of engines need no quotes, and stored runs are found by this text.
std::string plain_or_quoted(const std::string& text) {
  const auto is_plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == ':' || c == '+' || c == '-' || c == '.';
  };
  const bool plain =
      std::all_of(text.begin(), text.end(), is_plain) && !text.starts_with('-') && !text.ends_with(':');
  return plain ? text : yaml_quoted(text);
}

std::string whole_path(const std::string& text, bool is_file) {
  return is_file ? std::filesystem::absolute(text).lexically_normal().string() : text;
}

}  // namespace

void EnvConfig::validate(std::string_view source) const {
  require(physics_dt >= kShortestPhysicsStep && physics_dt <= kLongestPhysicsStep, source, "physics_dt",
          fmt::format("a time step in [{:g}, {:g}] s", kShortestPhysicsStep, kLongestPhysicsStep),
          physics_dt);
  require_multiple(source, "control_dt", control_dt, physics_dt);
  require(policy_dt / physics_dt <= kMostSteps, source, "policy_dt",
          fmt::format("at most {:g} physics steps", kMostSteps), policy_dt);
  require_multiple(source, "policy_dt", policy_dt, control_dt);
  require(episode_seconds >= policy_dt && episode_seconds <= 1e6, source, "episode_seconds",
          "at least one policy step and at most 1e6 s", episode_seconds);
  require(settle_seconds >= 0 && settle_seconds <= 1e3, source, "settle_seconds", "0 to 1e3 s",
          settle_seconds);
  require(tilt_limit_deg > 0 && tilt_limit_deg <= 180, source, "tilt_limit_deg",
          "an angle in (0, 180] degrees", tilt_limit_deg);
  require(friction >= 0 && friction <= 10, source, "friction", "a coefficient in [0, 10]", friction);
  if (residual_scale)
    require(*residual_scale >= 0 && *residual_scale <= 1, source, "residual_scale", "a length in [0, 1] m",
            *residual_scale);
  require(episode_seconds / policy_dt <= kMostSteps, source, "episode_seconds",
          fmt::format("at most {:g} policy steps", kMostSteps), episode_seconds);
  require(episode_seconds / physics_dt < std::numeric_limits<int>::max(), source, "physics_dt",
          "a time step of which fewer than 2^31 make an episode", physics_dt);
  crossgait::validate(parameters, source);
  adaptation.validate(source);
  for (std::size_t i = 0; i < adapt.size(); ++i) {
    static_cast<void>(adaptation.row(adapt[i]));
    if (std::find(adapt.begin(), adapt.begin() + static_cast<std::ptrdiff_t>(i), adapt[i]) !=
        adapt.begin() + static_cast<std::ptrdiff_t>(i))
      throw ConfigError(source, "adapt", "every parameter once", fmt::format("{} twice", adapt[i]));
  }
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

EnvConfig guide_environment() {
  EnvConfig config;
  config.gait = "trot:guide";
  config.adaptation = guide_ranges();
  return config;
}

EnvConfig load_env_config(const std::string& path) { return read_config(YamlValue::load(path)); }

EnvConfig parse_env_config(const std::string& text, const std::string& source) {
  return read_config(YamlValue::parse(text, source));
}

void EnvConfig::fail_at_its_place(const std::string& value, const ConfigError& error) const {
  for (const Place& place : places) {
    if (place.value != value) continue;
    throw ConfigError(place.source, fmt::format("{}: {}: {}", place.element, error.source(), error.element()),
                      error.expected(), error.found());
  }
  throw error;
}

std::string to_yaml(const EnvConfig& c) {
  std::string out = fmt::format(
      "engine: {}\nrobot: {}\nterrain: {}\nterrain_seed: {}\nfriction: {}\ngait: {}\n",
      plain_or_quoted(c.engine), yaml_quoted(whole_path(c.robot, is_robot_file(c.robot))),
      yaml_quoted(whole_path(c.terrain, is_terrain_file(c.terrain))), c.terrain_seed, c.friction, c.gait);
  const GaitSettings& settings = c.parameters;
  if (!settings.values.empty() || settings.swing) out += "parameters:\n";
  for (const ParameterRow& row : gait_parameters()) {
    if (const auto value = settings.find(row.name)) out += fmt::format("  {}: {}\n", row.name, *value);
  }
  if (settings.swing) out += fmt::format("  swing: {}\n", name(*settings.swing));
  out += fmt::format("adapt: [{}]\n", fmt::join(c.adapt, ", "));
  if (!c.adaptation.ranges.empty()) out += "ranges:\n";
  for (const auto& [name, range] : c.adaptation.ranges)
    out += fmt::format("  {}: [{}, {}]\n", name, range.min, range.max);
  if (!c.adaptation.delta_scales.empty()) out += "delta_scales:\n";
  for (const auto& [name, scale] : c.adaptation.delta_scales) out += fmt::format("  {}: {}\n", name, scale);
  if (c.residual_scale) out += fmt::format("residual_scale: {}\n", *c.residual_scale);
  if (c.command) {
    out += fmt::format("command: {{vx: {}, vy: {}, yaw_rate: {}}}\n", c.command->vx, c.command->vy,
                       c.command->yaw_rate);
  }
  out += fmt::format("heading_hold: {}\n", c.heading_hold);
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
