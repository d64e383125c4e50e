#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "env/env_config.h"
#include "physics/core/yaml_reader.h"
#include "physics/robot_files/data_path.h"

namespace crossgait {
namespace {

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

void add(std::string& out, std::string_view key, const ServoNumbers& numbers) {
  if (numbers.empty()) return;
  if (numbers.by_name.empty()) {
    out += fmt::format("  {}: {}\n", key, *numbers.all);
    return;
  }
  out += fmt::format("  {}:\n", key);
  if (numbers.all) out += fmt::format("    {}: {}\n", kAllServos, *numbers.all);
  for (const auto& [joint, value] : numbers.by_name)
    out += fmt::format("    {}: {}\n", plain_or_quoted(joint), value);
}

std::string servos_yaml(const ServoSettings& servos) {
  std::string out;
  for (std::size_t i = 0; i < kJointNumbers.size(); ++i) add(out, kJointNumbers[i].name, servos.numbers[i]);
  return out.empty() ? out : "servos:\n" + out;
}

std::string joints_yaml(const JointActionSettings& joints) {
  std::vector<std::string> order;
  for (const std::string& joint : joints.order) order.push_back(plain_or_quoted(joint));
  std::string out = "joints:\n";
  if (!order.empty()) out += fmt::format("  order: [{}]\n", fmt::join(order, ", "));
  add(out, "home", joints.home);
  add(out, "scale", joints.scale);
  return out + fmt::format("  limit: {}\n  delay: {}\n", joints.limit, joints.delay);
}

std::string gait_yaml(const EnvConfig& c) {
  std::string out = fmt::format("gait: {}\n", c.gait);
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
  return out + fmt::format("heading_hold: {}\n", c.heading_hold);
}

std::string observation_yaml(const ObservationTerm& term) {
  if (term.plain()) return term.block;
  std::string out = fmt::format("{{block: {}", term.block);
  if (!term.scale.empty()) out += fmt::format(", scale: [{}]", fmt::join(term.scale, ", "));
  if (std::isfinite(term.clip)) out += fmt::format(", clip: {}", term.clip);
  if (term.noise > 0) out += fmt::format(", noise: {}", term.noise);
  if (term.delay > 0) out += fmt::format(", delay: {}", term.delay);
  if (term.history > 1) out += fmt::format(", history: {}", term.history);
  return out + "}";
}

std::string reward_yaml(const RewardTerms& reward) {
  std::string weights;
  for (std::size_t i = 0; i < reward.size(); ++i) {
    if (reward[i] != 0) weights += fmt::format("  {}: {}\n", reward_terms()[i].name, reward[i]);
  }
  return weights.empty() ? "reward: {}\n" : "reward:\n" + weights;
}

std::string randomisation_yaml(const Randomisation& randomisation) {
  std::string ranges;
  for (const RandomisationRow& row : randomisation_rows()) {
    const Range& range = randomisation[row.what];
    if (randomisation.is_on(row.what))
      ranges += fmt::format("  {}: [{}, {}]\n", row.name, range.min, range.max);
  }
  return ranges.empty() ? ranges : "randomisation:\n" + ranges;
}

}  // namespace

std::string to_yaml(const EnvConfig& c) {
  std::string out =
      fmt::format("engine: {}\nrobot: {}\nterrain: {}\nterrain_seed: {}\nfriction: {}\n",
                  plain_or_quoted(c.engine), yaml_quoted(whole_path(c.robot, is_robot_file(c.robot))),
                  yaml_quoted(whole_path(c.terrain, is_terrain_file(c.terrain))), c.terrain_seed, c.friction);
  out += servos_yaml(c.servos);
  out += fmt::format("action: {}\n", name(c.action));
  out += c.action == ActionKind::kJoints ? joints_yaml(c.joints) : gait_yaml(c);
  if (c.command) {
    out += fmt::format("command: {{vx: {}, vy: {}, yaw_rate: {}}}\n", c.command->vx, c.command->vy,
                       c.command->yaw_rate);
  }
  std::vector<std::string> terms;
  for (const ObservationTerm& term : c.observation) terms.push_back(observation_yaml(term));
  out += fmt::format("observation: [{}]\n", fmt::join(terms, ", "));
  out += reward_yaml(c.reward);
  out += fmt::format(
      "physics_dt: {}\ncontrol_dt: {}\npolicy_dt: {}\nepisode_seconds: {}\nsettle_seconds: "
      "{}\ntilt_limit_deg: {}\n",
      c.physics_dt, c.control_dt, c.policy_dt, c.episode_seconds, c.settle_seconds, c.tilt_limit_deg);
  out += fmt::format("ends: [{}]\n", fmt::join(outcome_names(c.ends), ", "));
  return out + randomisation_yaml(c.randomisation);
}

}  // namespace crossgait
