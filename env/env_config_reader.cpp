// An environment's configuration as YAML.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "env/env_config_yaml.h"
#include "physics/core/error.h"
#include "physics/core/yaml_reader.h"
#include "physics/robot_files/data_path.h"
#include "physics/robot_files/robot_contact.h"

namespace crossgait {
namespace {

using env_yaml::read;
using env_yaml::read_choice;
using env_yaml::read_joints;
using env_yaml::read_names;
using env_yaml::read_numbers;
using env_yaml::read_servos;
using env_yaml::resolved;

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

void read_history(const YamlValue& root, HistorySettings& history) {
  const auto found = root.find("history");
  if (!found) return;
  found->allow_keys({"by", "order", "before"});
  read_choice(*found, "by", history.by, {HistorySettings::By::kTerm, HistorySettings::By::kFrame});
  read_choice(*found, "order", history.order,
              {HistorySettings::Order::kNewestFirst, HistorySettings::Order::kOldestFirst});
  read_choice(*found, "before", history.before,
              {HistorySettings::Before::kFirst, HistorySettings::Before::kZeros});
}

void read_observing(const YamlValue& root, ObservationSettings& settings) {
  read_history(root, settings.history);
  if (const auto clock = root.find("clock")) {
    clock->allow_keys({"frequency", "phases"});
    settings.clock.frequency = clock->at("frequency").number();
    settings.clock.phases = read_numbers(clock->at("phases"));
  }
  if (const auto scan = root.find("height_scan")) {
    scan->allow_keys({"x", "y", "offset", "x_first"});
    settings.height_scan.x = read_numbers(scan->at("x"));
    settings.height_scan.y = read_numbers(scan->at("y"));
    read(*scan, "offset", settings.height_scan.offset);
    read(*scan, "x_first", settings.height_scan.x_first);
  }
  if (const auto constants = root.find("constants")) settings.constants = read_numbers(*constants);
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
  read(root, "heading_hold", config.heading_hold);
}

void read_command(const YamlValue& root, EnvConfig& config) {
  if (const auto command = root.find("command")) {
    command->allow_keys({"vx", "vy", "yaw_rate"});
    config.command.emplace();
    read(*command, "vx", config.command->vx);
    read(*command, "vy", config.command->vy);
    read(*command, "yaw_rate", config.command->yaw_rate);
  }
}

// The name of a block, or a mapping of what is seen of it.
ObservationTerm read_observation_term(const YamlValue& value) {
  const auto block_of = [](const YamlValue& text) {
    named(text, [](const std::string& name) { static_cast<void>(find_observation_block(name)); });
    return text.text();
  };
  if (!value.is_mapping()) return block_of(value);
  value.allow_keys({"block", "scale", "clip", "clip_unscaled", "noise", "delay", "history"});
  ObservationTerm term = block_of(value.at("block"));
  if (const auto scale = value.find("scale")) {
    if (scale->is_sequence()) {
      for (const YamlValue& one : scale->items()) term.scale.push_back(one.number());
    } else {
      term.scale = {scale->number()};
    }
  }
  read(value, "clip", term.clip);
  read(value, "clip_unscaled", term.clip_unscaled);
  read(value, "noise", term.noise);
  read(value, "delay", term.delay);
  if (const auto history = value.find("history")) term.history = history->integer();
  return term;
}

void read_tables(const YamlValue& root, EnvConfig& config) {
  if (const auto blocks = root.find("observation")) {
    config.observation.clear();
    for (const YamlValue& item : blocks->items()) config.observation.push_back(read_observation_term(item));
  }
  read_observing(root, config.observing);
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

void read_start(const YamlValue& root, StartSettings& start) {
  const auto found = root.find("start");
  if (!found) return;
  found->allow_keys({"height", "velocity", "angular_velocity", "joint_offsets", "joint_velocities"});
  if (const auto height = found->find("height")) start.height = height->number();
  read(*found, "velocity", start.velocity);
  read(*found, "angular_velocity", start.angular_velocity);
  read(*found, "joint_offsets", start.joint_offsets);
  read(*found, "joint_velocities", start.joint_velocities);
}

// `friction` alone, or among the other settings.
void read_contact(const YamlValue& root, EnvConfig& config) {
  const auto contact = root.find("contact");
  if (contact) config.contact.add(read_contact_settings(*contact));
  const auto friction = root.find("friction");
  if (!friction) return;
  if (contact && contact->find("friction")) friction->fail("one friction", "another one in contact");
  config.contact.set("friction", std::vector{friction->number()}, friction->source(), friction->element());
}

void read_world(const YamlValue& root, EnvConfig& config) {
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
  read_contact(root, config);
}

void read_ends(const YamlValue& root, EnvConfig& config) {
  const auto ends = root.find("terminations");
  if (!ends) return;
  config.terminations = OutcomeSet::of_names({});
  for (const YamlValue& item : ends->items())
    config.terminations.add(named(item, [](const std::string& name) { return find_termination(name); }));
}

// What the rest of the file comes on top of.
EnvConfig read_beginning(const YamlValue& root) {
  const auto preset = root.find("preset"), action = root.find("action");
  const bool joints = action && action->text() == name(ActionKind::kJoints);
  if (action && !joints && action->text() != name(ActionKind::kGait))
    action->fail("gait or joints", fmt::format("'{}'", action->text()));
  if (!preset) return joints ? joint_environment() : EnvConfig();
  if (preset->text() != "guide") preset->fail("guide", fmt::format("'{}'", preset->text()));
  if (joints) action->fail("gait, which the guide's actions adapt", "joints");
  return guide_environment();
}

// What the file says, on top of `config`.
EnvConfig read_onto(EnvConfig config, const YamlValue& root) {
  if (const auto terms = root.find("terms"))
    terms->fail(
        "no terms: they are functions of the program that made this configuration, and no file, command or "
        "other process has them",
        "some");
  root.allow_keys({"preset",         "engine",       "robot",         "terrain",         "terrain_seed",
                   "friction",       "contact",      "servos",        "action",          "joints",
                   "gait",           "parameters",   "adapt",         "ranges",          "delta_scales",
                   "residual_scale", "command",      "heading_hold",  "observation",     "reward",
                   "physics_dt",     "control_dt",   "policy_dt",     "episode_seconds", "settle_seconds",
                   "tilt_limit_deg", "terminations", "randomisation", "history",         "clock",
                   "height_scan",    "constants",    "start"});
  config.source = root.source();
  read_world(root, config);
  read_servos(root, config);
  read_joints(root, config);
  read_gait(root, config);
  read_command(root, config);
  read_tables(root, config);
  read_start(root, config.start);
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

}  // namespace

EnvConfig load_env_config(const std::string& path) {
  const YamlValue root = YamlValue::load(path);
  return read_onto(read_beginning(root), root);
}

EnvConfig parse_env_config(const std::string& text, const std::string& source) {
  const YamlValue root = YamlValue::parse(text, source);
  return read_onto(read_beginning(root), root);
}

EnvConfig override_env_config(const EnvConfig& base, const std::string& text, const std::string& source) {
  const YamlValue root = YamlValue::parse(text, source);
  for (const char* key : {"action", "preset"}) {
    if (const auto value = root.find(key))
      value->fail("no such key on top of another configuration", value->text());
  }
  return read_onto(base, root);
}

}  // namespace crossgait
