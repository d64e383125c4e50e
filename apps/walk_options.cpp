#include "crossgait/apps/walk_options.h"

#include "crossgait/env/gait_source.h"

namespace crossgait::apps {

void WalkOptions::add_to(CLI::App& command) {
  command.add_option("--gait", gait, "The gait (see `crossgait gait --list`)")->capture_default_str();
  command
      .add_option("--set", settings,
                  "Change a gait parameter (see `crossgait gait --parameters`); may be repeated")
      ->type_name("NAME=VALUE");
  command.add_option("--seconds", timing.seconds, "Simulated time to walk, s")->capture_default_str();
  command.add_option("--control-dt", timing.control_dt, "Time step of gait, kinematics and servo targets, s")
      ->capture_default_str();
  command.add_option("--settle", timing.settle_seconds, "Simulated time to stand before the first step, s")
      ->capture_default_str();
  command.add_flag("--no-compensation", plain_servos,
                   "Send the wanted joint angles as they are, without leading them by the servos' lag");
}

WalkSetup WalkOptions::make(const RobotDescription& robot) const {
  WalkSetup setup;
  setup.gait = gait;
  setup.timing = timing;
  setup.compensation = plain_servos ? ServoCompensation::none() : ServoCompensation{};
  const GaitChoice choice = choose_gait(gait, settings);
  setup.make_gait = [choice, &robot] { return make_gait_source(choice, robot); };
  return setup;
}

}  // namespace crossgait::apps
