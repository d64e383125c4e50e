#include "study/notes.h"

#include <limits>
#include <utility>

#include "gait/scale.h"
#include "motion/gait_source.h"
#include "study/robot_quantities.h"

namespace crossgait {

std::vector<std::string> notes_on(const LoadedEnv& environment) {
  const EnvConfig& config = environment.config;
  RobotDescription robot = *environment.robot;
  config.servos.apply(robot, config.source);
  for (Body& body : robot.bodies) {  // whose torques are computed in every step: no gains that could swing
    if (config.action == ActionKind::kJoints && config.joints.computes_torque(body.joint.name))
      body.joint.kp = body.joint.kd = 0;
  }
  std::vector<std::string> notes =
      step_warnings(robot, resolve_contact(robot.contact, config.contact, config.source), config.physics_dt);
  if (config.action == ActionKind::kJoints) return notes;
  const GaitScale scale = gait_scale(*environment.robot);
  GaitParameters usual = scaled(find_gait(config.gait), scale).preferred;
  const GaitParameters initial = config.parameters.over(usual);
  // Like nothing: of what adapts there is a note also where it is the gait's own.
  for (const std::string& name : config.adapt)
    usual.*find_parameter(name).member = std::numeric_limits<double>::quiet_NaN();
  for (std::string& note : parameter_notes(initial, usual, scaled(config.adaptation, scale)))
    notes.push_back(std::move(note));
  return notes;
}

std::vector<std::string> notes_on(const LoadedWalk& walk, const std::string& gait) {
  const WalkConfig& config = walk.config;
  const RobotDescription& robot = *walk.world.robot;
  const GaitScale scale = gait_scale(robot);
  const GaitParameters usual = choose_gait(gait, {}, config.gait.command, scale).parameters;
  std::vector<std::string> notes =
      step_warnings(robot, resolve_contact(robot.contact, config.contact, "walk"), config.physics_dt);
  for (std::string& note : parameter_notes(config.gait.parameters, usual, scaled(AdaptationRanges(), scale)))
    notes.push_back(std::move(note));
  return notes;
}

}  // namespace crossgait
