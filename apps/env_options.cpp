#include "apps/env_options.h"

#include <algorithm>

#include <fmt/format.h>

#include "backends/registry.h"
#include "policy/bundled_policies.h"
#include "study/notes.h"
#include "study/run_spec.h"

namespace crossgait::apps {
namespace {

// Options of gaits say nothing where actions command joints.
void require_gait_of(const EnvConfig& config, const char* option) {
  if (config.action == ActionKind::kGait) return;
  throw ConfigError("command line", option, "an environment whose actions adapt a gait",
                    "action: joints in " + config.source);
}

bool is_of_gait(std::string_view setting) {
  const std::string_view name = setting.substr(0, setting.find('='));
  const auto& rows = gait_parameters();
  return name == "swing" ||
         std::any_of(rows.begin(), rows.end(), [name](const ParameterRow& row) { return row.name == name; });
}

}  // namespace

void EnvOptions::add_to(CLI::App& command, EnvScope scope) {
  command
      .add_option(
          "--config", config,
          "Environment as YAML (`crossgait env --yaml` writes one), or that of a policy that comes with "
          "Crossgait; options come on top")
      ->type_name("FILE.yaml");
  if (scope == EnvScope::kAll) {
    command.add_option("--engine", engine, "Engine and mode (see `crossgait engines`)");
    command.add_option("--terrain", terrain, "The ground (see `crossgait terrain --list`)")
        ->type_name("NAME[:k=v,...]|FILE.png|FILE.csv");
    add_seed_option(command, "--terrain-seed", terrain_seed, "Seed of a random terrain");
  }
  command.add_option("--robot", robot, "A bundled robot's name (see `crossgait robots`) or a file");
  add_robot_file_options(command);
  command.add_option("--gait", gait, "The gait, with its preferred parameters (see `crossgait gait --list`)");
  command
      .add_option("--set", settings,
                  "Change a gait parameter at the start, or any key of the environment (physics_dt=.001, "
                  "\"randomisation={friction: [.5, 1]}\"); may be repeated")
      ->type_name("NAME=VALUE");
  command.add_option("--adapt", adapt, "Parameters that the action changes, comma-separated")->delimiter(',');
  command
      .add_option("--observe", observe,
                  "Observation blocks beside the configured ones, comma-separated (`crossgait env --list`)")
      ->delimiter(',');
  command.add_option("--residual-scale", residual_scale,
                     "Largest residual of a foot target per coordinate, m");
  command.add_option("--policy-dt", policy_dt, "Time between two actions, s");
  if (scope == EnvScope::kMethodAlone) return;
  contact.add_to(command);
  command
      .add_option("--command", velocity,
                  "Velocity to walk at: forward and left in m/s, turning left in rad/s")
      ->type_name("VX,VY,YAWRATE");
  command.add_option("--episode-seconds", episode_seconds, "Simulated length of an episode, s");
}

LoadedEnv EnvOptions::make(const std::string& policy) const {
  EnvConfig c;
  if (const std::string file = environment_file(config, policy); !file.empty()) {
    c = load_env_config(file);
  } else if (!available_engines().empty()) {
    c.engine = available_engines().front();
  }
  if (engine) c.engine = *engine;
  if (robot) c.robot = *robot;
  if (terrain) c.terrain = *terrain;
  if (terrain_seed) c.terrain_seed = *terrain_seed;
  c.contact.add(contact.make());
  require_gait(c);
  if (gait) {
    c.gait = *gait;
    static_cast<void>(find_gait(*gait));
    c.parameters = {};
  }
  apply_settings(settings, c);
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
  LoadedEnv environment = load_with_warnings(c);
  print_notes(notes_on(environment));
  return environment;
}

void apply_settings(const std::vector<std::string>& settings, EnvConfig& config) {
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    if (is_of_gait(setting) || equals == std::string::npos) {
      require_gait_of(config, "--set");
      assign(config.parameters, setting);
    } else {
      const std::string yaml =
          fmt::format("{{{}: {}}}", setting.substr(0, equals), setting.substr(equals + 1));
      config = override_env_config(config, yaml, "--set " + setting);
    }
  }
}

LoadedEnv load_with_warnings(const EnvConfig& config) {
  return {config, config.at_its_place(config.robot, [&config] {
            return std::make_shared<const RobotDescription>(load_robot_with_warnings(config.robot));
          })};
}

void EnvOptions::require_gait(const EnvConfig& c) const {
  for (const auto& [given, option] : {std::pair{gait.has_value(), "--gait"},
                                      {!adapt.empty(), "--adapt"},
                                      {residual_scale.has_value(), "--residual-scale"}}) {
    if (given) require_gait_of(c, option);
  }
}

EnvConfig environment_of(const std::string& env, const std::string& policy) {
  const std::string file = environment_file(env, policy);
  if (file.empty())
    throw ConfigError("command line", "--env", "the environment of a policy that is no folder", "none");
  return load_env_config(file);
}

nlohmann::json policy_subject(const LoadedEnv& environment, const std::vector<std::string>& policies,
                              std::uint64_t seed) {
  nlohmann::json subject{{"seed", seed}, {"policies", nlohmann::json::array()}};
  for (const std::string& policy : policies) {
    nlohmann::json behaviour = LoadedBehaviour(environment, policy, {}, 0).described.at("behaviour");
    subject["policies"].push_back(behaviour.at("policy"));
    behaviour.erase("policy");
    subject["behaviour"] = std::move(behaviour);
  }
  return subject;
}

void add_workers_option(CLI::App& command, std::size_t& workers) {
  command.add_option("--workers", workers, "Threads; results do not depend on them")
      ->check(CLI::Range(1, 1024))
      ->group(kExecution)
      ->default_str("the cores that it may use");  // in words: a manual may be read on another machine
}

void add_episode_options(CLI::App& command, EpisodeOptions& options) {
  command.add_option("--episodes", options.episodes, "Episodes of each policy, on the same worlds")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  add_seed_option(command, "--seed", options.seed, "Seed of the episodes")->capture_default_str();
  add_workers_option(command, options.workers);
}

}  // namespace crossgait::apps
