#include "study/walk_config.h"

#include "physics/core/error.h"

namespace crossgait {

WalkSetup WalkConfig::setup() const {
  const GaitLayers layers{compensation ? ServoCompensation{} : ServoCompensation::none(),
                          heading_hold ? HeadingHold{} : HeadingHold::none()};
  return {
      gait.name(),
      [choice = gait, layers](const WorldSpec& world) { return make_gait_controller(choice, world, layers); },
      timing, terminations};
}

EnvConfig WalkConfig::environment() const {
  if (!gait.gait) throw ConfigError("environment", "gait", "one gait", std::string(kAutomaticGait));
  if (!compensation) throw ConfigError("environment", "compensation", "compensated servos", "none");
  EnvConfig c;
  c.robot = robot;
  c.terrain = terrain;
  c.terrain_seed = terrain_seed;
  c.contact = contact;
  c.physics_dt = physics_dt;
  c.control_dt = timing.control_dt;
  c.policy_dt = timing.control_dt;
  c.settle_seconds = timing.settle_seconds;
  c.episode_seconds = timing.seconds;
  c.gait = gait.name();
  c.parameters = GaitSettings::all(gait.parameters);
  c.command = gait.command;
  c.heading_hold = heading_hold;
  c.terminations = terminations;
  c.validate("walk");
  return c;
}

}  // namespace crossgait
