// crossgait view: the robot live in a browser.
#include <algorithm>
#include <chrono>
#include <thread>

#include <fmt/format.h>

#include "apps/command.h"
#include "apps/contact_option.h"
#include "apps/interruption.h"
#include "apps/open_address.h"
#include "backends/registry.h"
#include "env/env_config.h"
#include "physics/core/error.h"
#include "physics/core/progress.h"
#include "physics/robot_files/data_path.h"
#include "physics/robot_files/installed_robots.h"
#include "policy/bundled_policies.h"
#include "report/page.h"
#include "study/loaded_walk.h"
#include "view/request_check.h"
#include "view/server.h"

namespace crossgait::apps {
namespace {

struct ViewOptions {
  std::string file, policy, robot, terrain, gait;
  std::optional<std::uint64_t> seed;
  ContactOptions contact;
  std::vector<std::string> engines;
  int port = 0;
  bool open = false;
};

EnvConfig config_of(const ViewOptions& options, const ViewSubject& subject) {
  const std::string file = environment_file(subject.environment, subject.policy);
  EnvConfig config = file.empty() ? EnvConfig() : load_env_config(file);
  if (!subject.robot.empty()) config.robot = subject.robot;
  if (!options.gait.empty()) config.gait = options.gait;
  config.contact.add(options.contact.make());
  return config;
}

/// @param config  of the subject, on its ground
ViewSetup setup_of(const EnvConfig& config, const ViewSubject& subject) {
  const auto robot = std::make_shared<const RobotDescription>(load_robot_with_warnings(config.robot));
  ViewSetup setup;
  setup.subject = subject;
  setup.subject.robot = config.robot;
  setup.gait = config.gait;
  setup.terrain_seed = config.terrain_seed;
  if (subject.policy.empty()) {
    WalkConfig walk;
    walk.robot = config.robot;
    walk.terrain = config.terrain;
    walk.terrain_seed = config.terrain_seed;
    walk.contact = config.contact;
    setup.world = LoadedWalk(walk, robot).world;
  } else {
    setup.control_dt = config.control_dt;
    setup.policy = {LoadedEnv(config, robot), subject.policy};
  }
  return setup;
}

std::vector<std::string> engines_of(const ViewOptions& options, const EnvConfig& config,
                                    const std::vector<std::string>& available) {
  if (!options.engines.empty()) return options.engines;
  if (!options.file.empty()) return {config.engine};
  if (available.empty())
    throw ConfigError("view", "--engines", "an engine (see `crossgait engines`)", "none that is available");
  return {available.front()};
}

/// Robots by name, those of installed packages among them.
std::vector<std::string> known_robots() {
  std::vector<std::string> names = robot_names();
  for (const InstalledRobot& robot : installed_robots()) names.push_back(robot.name);
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

std::unique_ptr<ViewSession> make_session(const ViewOptions& options) {
  const ViewSubject first{options.robot, options.policy, options.file, {}};
  EnvConfig config = config_of(options, first);
  if (!options.terrain.empty()) config.terrain = options.terrain;
  config.terrain_seed = options.seed.value_or(config.terrain_seed);
  const EngineProvider provider{available_engines(),
                                [](const std::string& name) { return find_engine(name); }};
  ViewSetup setup = setup_of(config, first);
  setup.engines = engines_of(options, config, provider.names);
  const auto make = [options](const ViewSubject& subject, const TerrainChoice& ground) {
    EnvConfig chosen = config_of(options, subject);
    chosen.terrain = ground.terrain;
    chosen.terrain_seed = ground.seed;
    return setup_of(chosen, subject);
  };
  return std::make_unique<ViewSession>(setup, provider,
                                       SubjectProvider{known_robots(), policy_names(), make});
}

void run(const ViewOptions& options) {
  require_view_server();
  require_page();
  LiveView view(make_session(options));
  ViewServer server(view, {.port = options.port, .page = live_page(), .token = random_token()});
  listen_for_interruption();
  print(fmt::format("{}\nWhoever has this address may drive. Ctrl-C ends it.\n", server.address()));
  flush_standard_output();
  std::unique_ptr<OpenedAddress> opened;
  if (options.open) opened = std::make_unique<OpenedAddress>(server.address());
  try {
    while (view.failure().empty()) {
      check_interruption();
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  } catch (const Interrupted&) {
    return;  // how it is meant to end
  }
  throw std::runtime_error("the simulation ended: " + view.failure());
}

}  // namespace

void add_view_command(CLI::App& program, Invocation& /*invocation*/) {
  CLI::App* command = program.add_subcommand("view", "Drive a robot live, in the browser");
  command->footer(
      "\nSimulates at real time and serves a page on the loopback interface, at an address with a random "
      "token that\nis printed. Keys, gamepad or sliders drive; the engine can be changed while it walks.\n"
      "\nExamples:\n"
      "  crossgait view --open\n"
      "  crossgait view --engines mujoco,bullet --terrain rough --port 8000\n"
      "  crossgait view --policy policy.safetensors --config env.yaml\n"
      "  ssh -L 8000:127.0.0.1:8000 HOST crossgait view --port 8000   # the same port at both ends");
  auto options = std::make_shared<ViewOptions>();
  command
      ->add_option("--engines,--engine", options->engines,
                   "Engine and mode to begin with (see `crossgait engines`), or up to three, "
                   "comma-separated, side by side; by default the first that is available")
      ->delimiter(',');
  add_robot_option(*command, options->robot);
  command->add_option("--terrain", options->terrain, "The ground (see `crossgait terrain --list`)")
      ->type_name("NAME[:k=v,...]|FILE.png|FILE.csv");
  add_seed_option(*command, "--seed", options->seed, "Seed of a random terrain");
  command->add_option("--gait", options->gait, "The gait to begin with (see `crossgait gait --list`)");
  options->contact.add_to(*command);
  CLI::Option* policy =
      command
          ->add_option("--policy", options->policy,
                       "What adapts the gait or commands the joints, while speed and turn are told by hand: "
                       "zero, random or a file (docs/policies.md)")
          ->type_name("NAME|FILE");
  command
      ->add_option("--config", options->file, "The environment that the policy is for (docs/environment.md)")
      ->type_name("FILE.yaml")
      ->needs(policy);
  command->add_option("--port", options->port, "Port on 127.0.0.1; 0 takes any that is free")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  command->add_flag("--open", options->open, "Open the address with xdg-open");
  on_run(*command, [options] { run(*options); });
}

}  // namespace crossgait::apps
