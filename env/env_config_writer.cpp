// An environment's configuration written down: one list of keys, as JSON, and that as YAML.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "env/env_config_json.h"
#include "physics/core/folder.h"
#include "physics/core/yaml_reader.h"
#include "physics/robot/contact_json.h"
#include "physics/robot_files/data_path.h"

namespace crossgait {
namespace {

using Json = nlohmann::ordered_json;

std::string whole_path(const std::string& text, bool is_file) {
  return is_file ? absolute_path(text).lexically_normal().string() : text;
}

void add(Json& out, std::string_view key, const ServoNumbers& numbers) {
  if (numbers.empty()) return;
  Json& value = out[std::string(key)];
  if (numbers.by_name.empty()) {
    value = *numbers.all;
    return;
  }
  if (numbers.all) value[std::string(kAllServos)] = *numbers.all;
  for (const auto& [joint, number] : numbers.by_name) value[joint] = number;
}

// With `mapping` in the place of a key that has something to say.
void add(Json& out, const char* key, Json mapping) {
  if (!mapping.empty()) out[key] = std::move(mapping);
}

Json servos_json(const ServoSettings& servos) {
  Json out;
  for (std::size_t i = 0; i < kJointNumbers.size(); ++i) add(out, kJointNumbers[i].name, servos.numbers[i]);
  return out;
}

Json joints_json(const JointActionSettings& joints) {
  Json out;
  if (!joints.order.empty()) out["order"] = joints.order;
  // Stored runs are found by this text: what was added later is only written where it says something.
  const JointActionSettings plain;
  if (!joints.observed.empty()) out["observed"] = joints.observed;
  if (!joints.commands.empty()) {
    Json& commands = out["command"] = {{std::string(kAllServos), name(joints.command)}};
    for (const auto& [joint, command] : joints.commands) commands[joint] = name(command);
  } else if (joints.command != plain.command) {
    out["command"] = name(joints.command);
  }
  if (!joints.actuator.empty()) out["actuator"] = whole_path(joints.actuator, true);
  add(out, "home", joints.home);
  add(out, "offset", joints.offset);
  add(out, "scale", joints.scale);
  add(out, "lower", joints.lower);
  add(out, "upper", joints.upper);
  out["limit"] = joints.limit;
  out["delay"] = joints.delay;
  if (joints.filter != plain.filter) out["filter"] = joints.filter;
  return out;
}

void add_observing(Json& out, const ObservationSettings& s) {
  const HistorySettings plain;
  Json history;
  if (s.history.by != plain.by) history["by"] = name(s.history.by);
  if (s.history.order != plain.order) history["order"] = name(s.history.order);
  if (s.history.before != plain.before) history["before"] = name(s.history.before);
  add(out, "history", std::move(history));
  if (!s.clock.phases.empty()) out["clock"] = {{"frequency", s.clock.frequency}, {"phases", s.clock.phases}};
  if (!s.height_scan.x.empty())
    out["height_scan"] = {{"x", s.height_scan.x},
                          {"y", s.height_scan.y},
                          {"offset", s.height_scan.offset},
                          {"x_first", s.height_scan.x_first}};
  if (!s.constants.empty()) out["constants"] = s.constants;
}

Json vector_json(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

Json start_json(const StartSettings& start) {
  Json out;
  if (start.height) out["height"] = *start.height;
  if (!start.velocity.isZero(0)) out["velocity"] = vector_json(start.velocity);
  if (!start.angular_velocity.isZero(0)) out["angular_velocity"] = vector_json(start.angular_velocity);
  add(out, "joint_offsets", start.joint_offsets);
  add(out, "joint_velocities", start.joint_velocities);
  return out;
}

Json parameters_json(const GaitSettings& settings) {
  Json out;
  for (const ParameterRow& row : gait_parameters()) {
    if (const auto value = settings.find(row.name)) out[std::string(row.name)] = *value;
  }
  if (settings.swing) out["swing"] = name(*settings.swing);
  return out;
}

void add_gait(Json& out, const EnvConfig& c) {
  out["gait"] = c.gait;
  add(out, "parameters", parameters_json(c.parameters));
  out["adapt"] = c.adapt;
  Json ranges, scales;
  for (const auto& [name, range] : c.adaptation.ranges) ranges[name] = {range.min, range.max};
  for (const auto& [name, scale] : c.adaptation.delta_scales) scales[name] = scale;
  add(out, "ranges", std::move(ranges));
  add(out, "delta_scales", std::move(scales));
  if (c.residual_scale) out["residual_scale"] = *c.residual_scale;
  out["heading_hold"] = c.heading_hold;
}

Json observation_json(const ObservationTerm& term) {
  if (term.plain()) return term.block;
  Json out{{"block", term.block}};
  if (!term.scale.empty()) out["scale"] = term.scale;
  if (std::isfinite(term.clip)) out["clip"] = term.clip;
  if (std::isfinite(term.clip_unscaled)) out["clip_unscaled"] = term.clip_unscaled;
  if (term.noise > 0) out["noise"] = term.noise;
  if (term.delay > 0) out["delay"] = term.delay;
  if (term.history > 1) out["history"] = term.history;
  return out;
}

Json reward_json(const RewardTerms& reward) {
  Json out = Json::object();
  for (std::size_t i = 0; i < reward.size(); ++i) {
    if (reward[i] != 0) out[std::string(reward_terms()[i].name)] = reward[i];
  }
  return out;
}

Json randomisation_json(const Randomisation& randomisation) {
  Json out;
  for (const RandomisationRow& row : randomisation_rows()) {
    const Range& range = randomisation[row.what];
    if (randomisation.is_on(row.what)) out[std::string(row.name)] = {range.min, range.max};
  }
  return out;
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

// A value in one line.
std::string flow(const Json& value) {
  if (value.is_string()) return plain_or_quoted(value.get<std::string>());
  if (value.is_number_float()) return fmt::format("{}", value.get<double>());
  if (!value.is_structured()) return value.dump();
  std::vector<std::string> parts;
  for (const auto& [key, part] : value.items())
    parts.push_back(value.is_object() ? plain_or_quoted(key) + ": " + flow(part) : flow(part));
  const std::string inside = fmt::format("{}", fmt::join(parts, ", "));
  return value.is_object() ? "{" + inside + "}" : "[" + inside + "]";
}

// Keys below each other, mappings among them indented.
std::string block(const Json& mapping, int indent) {
  std::string out;
  for (const auto& [key, value] : mapping.items()) {
    out += fmt::format("{:{}}{}:", "", indent, plain_or_quoted(key));
    // Always in quotes or in one line: stored runs are found by this text.
    if (indent == 0 && (key == "robot" || key == "terrain")) {
      out += " " + yaml_quoted(value.get<std::string>()) + "\n";
    } else if (value.is_object() && !value.empty() && key != "command") {
      out += "\n" + block(value, indent + 2);
    } else {
      out += " " + flow(value) + "\n";
    }
  }
  return out;
}

// Friction, which everybody sets, stands alone.
void add_contact(Json& out, const ContactSettings& contact) {
  Json others = Json::object();
  for (const ContactSetting& setting : contact_settings()) {
    const std::vector<double>* numbers = contact.find(setting.name);
    if (numbers == nullptr) continue;
    (setting.name == "friction" ? out : others)[std::string(setting.name)] = to_json(setting, *numbers);
  }
  add(out, "contact", others);
}

}  // namespace

Json to_json(const EnvConfig& c) {
  Json out{{"engine", c.engine},
           {"robot", whole_path(c.robot, is_robot_file(c.robot))},
           {"terrain", whole_path(c.terrain, is_terrain_file(c.terrain))},
           {"terrain_seed", c.terrain_seed}};
  add_contact(out, c.contact);
  add(out, "servos", servos_json(c.servos));
  out["action"] = name(c.action);
  if (c.action == ActionKind::kJoints) {
    out["joints"] = joints_json(c.joints);
  } else {
    add_gait(out, c);
  }
  if (c.command)
    out["command"] = {{"vx", c.command->vx}, {"vy", c.command->vy}, {"yaw_rate", c.command->yaw_rate}};
  out["observation"] = Json::array();
  for (const ObservationTerm& term : c.observation) out["observation"].push_back(observation_json(term));
  add_observing(out, c.observing);
  out["reward"] = reward_json(c.reward);
  out["physics_dt"] = c.physics_dt;
  out["control_dt"] = c.control_dt;
  out["policy_dt"] = c.policy_dt;
  out["episode_seconds"] = c.episode_seconds;
  out["settle_seconds"] = c.settle_seconds;
  out["tilt_limit_deg"] = c.tilt_limit_deg;
  out["terminations"] = outcome_names(c.terminations);
  add(out, "start", start_json(c.start));
  add(out, "randomisation", randomisation_json(c.randomisation));
  if (c.extension != nullptr) out["terms"] = c.extension->terms;
  return out;
}

std::string to_yaml(const EnvConfig& config) { return block(to_json(config), 0); }

}  // namespace crossgait
