#include "crossgait/apps/walk_options.h"

#include "crossgait/env/gait_source.h"

namespace crossgait::apps {

void WalkOptions::add_to(CLI::App& command) {
  command
      .add_option("--gait", gait, "The gait (see `crossgait gait --list`), or auto: the one for the speed")
      ->capture_default_str();
  command
      .add_option("--set", settings,
                  "Change a gait parameter (see `crossgait gait --parameters`); may be repeated")
      ->type_name("NAME=VALUE");
  CLI::Option* forward =
      command.add_option("--speed", speed, "Walk forward at this speed, m/s (negative reverses)");
  command
      .add_option("--command", velocity, "Walk at a velocity: forward and left in m/s, turning left in rad/s")
      ->type_name("VX,VY,YAWRATE")
      ->excludes(forward);
  command.add_option("--seconds", timing.seconds, "Simulated time to walk, s")->capture_default_str();
  command.add_option("--control-dt", timing.control_dt, "Time step of gait, kinematics and servo targets, s")
      ->capture_default_str();
  command.add_option("--settle", timing.settle_seconds, "Simulated time to stand before the first step, s")
      ->capture_default_str();
  command.add_flag(
      "--no-compensation", plain_servos,
      "Send the wanted joint angles as they are, without making up for the servos' lag and give");
}

std::optional<VelocityCommand> WalkOptions::make_command() const {
  if (!velocity.empty()) {
    const auto v = parse_numbers(velocity, 3, "--command", "VX,VY,YAWRATE in m/s, m/s, rad/s");
    return VelocityCommand{v[0], v[1], v[2]};
  }
  return speed ? std::optional(VelocityCommand{*speed, 0, 0}) : std::nullopt;
}

WalkSetup WalkOptions::make(const RobotDescription& robot) const {
  WalkSetup setup;
  setup.gait = gait;
  setup.timing = timing;
  setup.compensation = plain_servos ? ServoCompensation::none() : ServoCompensation{};
  const GaitChoice choice = choose_gait(gait, settings, make_command());
  setup.make_gait = [choice, &robot] { return make_gait_source(choice, robot); };
  return setup;
}

}  // namespace crossgait::apps
