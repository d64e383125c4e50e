#include "apps/walk_options.h"

#include <fmt/format.h>

#include "physics/core/error.h"
#include "study/notes.h"
#include "study/run_spec.h"

namespace crossgait::apps {
namespace {

void add_world(CLI::App& command, WalkConfig& config) {
  add_robot_option(command, config.robot);
  command
      .add_option("--terrain", config.terrain,
                  "The ground (see `crossgait terrain --list`), e.g. rough or stairs:rise=.01,run=.1")
      ->type_name("NAME[:k=v,...]|FILE.png|FILE.csv")
      ->capture_default_str();
  add_seed_option(command, "--seed", config.terrain_seed, "Seed of a random terrain")->capture_default_str();
  command.add_option("--physics-dt", config.physics_dt, "Physics time step, s")->capture_default_str();
}

}  // namespace

void WalkOptions::add_to(CLI::App& command) {
  add_world(command, config);
  contact.add_to(command);
  command
      .add_option("--gait", gait, "The gait (see `crossgait gait --list`), or auto: the one for the speed")
      ->capture_default_str();
  command
      .add_option("--set", settings,
                  "Change a gait parameter (see `crossgait gait --parameters`); may be repeated. Outside the "
                  "range for "
                  "adaptation there is a note")
      ->type_name("NAME=VALUE");
  CLI::Option* forward =
      command.add_option("--speed", speed, "Walk forward at this speed, m/s (negative reverses)");
  command
      .add_option("--command", velocity, "Walk at a velocity: forward and left in m/s, turning left in rad/s")
      ->type_name("VX,VY,YAWRATE")
      ->excludes(forward);
  command.add_option("--seconds", config.timing.seconds, "Simulated time to walk, s, at most 1e6")
      ->capture_default_str();
  command
      .add_option("--control-dt", config.timing.control_dt,
                  "Time step of gait, kinematics and servo targets, s")
      ->capture_default_str();
  command
      .add_option("--settle", config.timing.settle_seconds,
                  "Simulated time to stand before the first step, s, at most 1e3")
      ->capture_default_str();
  command
      .add_option(
          "--terminations", terminations,
          "Outcomes that end the walk before its time, comma-separated: loop_violated, fell, collapsed, "
          "left_terrain, diverged (which always does)")
      ->delimiter(',')
      ->capture_default_str();
  command.add_flag(
      "--no-compensation", plain_servos,
      "Send the wanted joint angles as they are, without making up for the servos' lag and give");
  command.add_flag("--no-heading-hold", open_loop,
                   "Do not steer: walk in open loop, and turn wherever the feet happened to slip");
}

std::optional<VelocityCommand> WalkOptions::velocity_command() const {
  if (!velocity.empty()) {
    const auto v = parse_numbers(velocity, 3, "--command", "VX,VY,YAWRATE in m/s, m/s, rad/s");
    return VelocityCommand{v[0], v[1], v[2]};
  }
  return speed ? std::optional(VelocityCommand{*speed, 0, 0}) : std::nullopt;
}

LoadedWalk WalkOptions::make() const {
  WalkConfig made = config;
  made.contact = contact.make();
  try {
    if (!is_automatic(gait)) static_cast<void>(find_gait(gait));
  } catch (const ConfigError& error) {
    throw ConfigError(error.source(), error.element(),
                      fmt::format("{}, {}, {}", error.expected(), kAutomaticGait, kGuidesAutomaticGait),
                      error.found());
  }
  const auto robot = std::make_shared<const RobotDescription>(load_robot_with_warnings(config.robot));
  made.gait = choose_gait(gait, settings, velocity_command(), gait_scale(*robot));
  made.compensation = !plain_servos;
  made.heading_hold = !open_loop;
  made.terminations = OutcomeSet::of_names(terminations);
  LoadedWalk loaded(made, robot);
  print_notes(notes_on(loaded, gait));
  return loaded;
}

nlohmann::json WalkOptions::subject(const LoadedWalk& walk) {
  return {{"behaviour", LoadedBehaviour(walk, {}, 0).described.at("behaviour")}};
}

std::string how_far(double walked, double asked) {
  return fmt::format("{:.1f} of {:g} s are walked; what was asked for is written up to there", walked, asked);
}

}  // namespace crossgait::apps
