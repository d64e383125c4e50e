#include "crossgait/apps/env_options.h"

#include <filesystem>
#include <thread>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "crossgait/backends/registry.h"

namespace crossgait::apps {
namespace {

nlohmann::ordered_json terms_to_json(const RewardTerms& terms) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < terms.size(); ++i) {
    if (terms[i] != 0) json[std::string(reward_terms()[i].name)] = terms[i];
  }
  return json;
}

nlohmann::ordered_json to_json(const Evaluation::Spread& spread) {
  return {{"mean", spread.mean}, {"deviation", spread.deviation}};
}

}  // namespace

void EnvOptions::add_to(CLI::App& command, bool world) {
  command
      .add_option("--config", config,
                  "Environment as YAML (`crossgait env --yaml` writes one); options come on top")
      ->type_name("FILE.yaml");
  if (world) {
    command.add_option("--engine,--backend", backend, "Engine and mode (see `crossgait backends`)");
    command.add_option("--terrain", terrain, "The ground (see `crossgait terrain --list`)")
        ->type_name("NAME[:k=v,...]|FILE.png|FILE.csv");
    command.add_option("--terrain-seed", terrain_seed, "Seed of a random terrain");
  }
  command.add_option("--robot", robot, "A bundled robot's name (see `crossgait robots`) or a file");
  command.add_option("--friction", friction, "Coefficient of friction between feet and ground");
  command.add_option("--gait", gait, "The gait, with its preferred parameters (see `crossgait gait --list`)");
  command.add_option("--set", settings, "Change a gait parameter at the start; may be repeated")
      ->type_name("NAME=VALUE");
  command.add_option("--adapt", adapt, "Parameters that the action changes, comma-separated")->delimiter(',');
  command
      .add_option("--observe", observe,
                  "Observation blocks beside the configured ones, comma-separated (`crossgait env --list`)")
      ->delimiter(',');
  command
      .add_option("--command", velocity,
                  "Velocity to walk at: forward and left in m/s, turning left in rad/s")
      ->type_name("VX,VY,YAWRATE");
  command.add_option("--residual-scale", residual_scale,
                     "Largest residual of a foot target per coordinate, m");
  command.add_option("--policy-dt", policy_dt, "Time between two actions, s");
  command.add_option("--episode-seconds", episode_seconds, "Simulated length of an episode, s");
}

EnvConfig EnvOptions::make() const {
  EnvConfig c;
  if (!config.empty()) {
    c = load_env_config(config);
  } else if (!available_engines().empty()) {
    c.backend = available_engines().front();
  }
  if (backend) c.backend = *backend;
  if (robot) c.robot = *robot;
  if (terrain) c.terrain = *terrain;
  if (terrain_seed) c.terrain_seed = *terrain_seed;
  if (friction) c.friction = *friction;
  if (gait) {
    c.gait = *gait;
    c.parameters = find_gait(*gait).preferred;
  }
  for (const std::string& setting : settings) assign(c.parameters, setting);
  if (!adapt.empty()) c.adapt = adapt;
  c.observation.insert(c.observation.end(), observe.begin(), observe.end());
  if (!velocity.empty()) {
    const auto v = parse_numbers(velocity, 3, "--command", "VX,VY,YAWRATE in m/s, m/s, rad/s");
    c.command = VelocityCommand{v[0], v[1], v[2]};
  }
  if (residual_scale) c.residual_scale = *residual_scale;
  if (policy_dt) c.policy_dt = *policy_dt;
  if (episode_seconds) c.episode_seconds = *episode_seconds;
  c.validate("command line");
  return c;
}

void add_workers_option(CLI::App& command, std::size_t& workers) {
  command.add_option("--workers", workers, "Threads; results do not depend on them")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
}

void EpisodeOptions::add_to(CLI::App& command) {
  command.add_option("--episodes", episodes, "Episodes of each policy, on the same worlds")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  command.add_option("--seed", seed, "Seed of the episodes")->capture_default_str();
  add_workers_option(command, workers);
}

EnvFactory env_factory(const EnvConfig& config) {
  return [config] { return std::make_unique<AdaptiveGaitEnv>(config, find_engine(config.backend)); };
}

PolicyFactory policy_factory(const std::string& policy) {
  return [policy](const PolicyInterface& interface) { return make_policy(policy, interface); };
}

std::string short_name(const std::string& policy) { return std::filesystem::path(policy).filename(); }

std::size_t default_workers() { return std::max(1U, std::thread::hardware_concurrency()); }

nlohmann::ordered_json to_json(const Evaluation& e) {
  return {{"episodes", e.episodes},
          {"total_reward", to_json(e.total_reward)},
          {"reward_terms", terms_to_json(e.reward_terms)},
          {"mean_speed_mps", to_json(e.speed)},
          {"distance_m", to_json(e.distance)},
          {"rms_roll_deg", e.rms_roll_deg},
          {"rms_pitch_deg", e.rms_pitch_deg},
          {"slip_m", e.slip_m},
          {"cost_of_transport", e.cost_of_transport},
          {"simulated_seconds", e.simulated_seconds},
          {"steps", e.steps},
          {"ik_clamped", e.ik_clamped},
          {"invalid_actions", e.invalid_actions},
          {"falls", e.falls},
          {"left_terrain", e.left_terrain},
          {"diverged", e.diverged}};
}

nlohmann::ordered_json to_json(const EpisodeSummary& e) {
  nlohmann::ordered_json parameters;
  for (const ParameterRow& row : gait_parameters())
    parameters[std::string(row.name)] = e.parameters.*row.member;
  return {{"seed", e.seed},
          {"total_reward", e.total_reward},
          {"reward_terms", terms_to_json(e.reward_terms)},
          {"simulated_seconds", e.simulated_seconds},
          {"distance_m", e.distance_m},
          {"lateral_m", e.lateral_m},
          {"mean_speed_mps", e.mean_speed_mps},
          {"fell", e.fell},
          {"left_terrain", e.left_terrain},
          {"diverged", e.diverged},
          {"parameters", parameters}};
}

std::string outcome(const Evaluation& e) {
  std::vector<std::string> words;
  if (e.falls > 0) words.push_back(fmt::format("{} fell", e.falls));
  if (e.left_terrain > 0) words.push_back(fmt::format("{} left the ground", e.left_terrain));
  if (e.diverged > 0) words.push_back(fmt::format("{} diverged", e.diverged));
  return words.empty() ? "all walked" : fmt::format("{}", fmt::join(words, ", "));
}

}  // namespace crossgait::apps
