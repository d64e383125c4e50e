#include "env/loaded_env.h"

#include <utility>

#include "physics/robot/robot.h"
#include "physics/robot_files/data_path.h"

namespace crossgait {
namespace {

std::shared_ptr<const RobotDescription> read_robot(const EnvConfig& config) {
  config.validate(config.source);
  return config.at_its_place(config.robot, [&] {
    return std::make_shared<const RobotDescription>(load_robot(find_robot(config.robot)));
  });
}

}  // namespace

LoadedEnv::LoadedEnv(const EnvConfig& environment) : LoadedEnv(environment, read_robot(environment)) {}

LoadedEnv::LoadedEnv(EnvConfig environment, std::shared_ptr<const RobotDescription> read,
                     std::shared_ptr<const ActuatorNetwork> network)
    : config(std::move(environment)),
      robot(std::move(read)),
      ground(config.terrain),
      actuator(std::move(network)) {
  if (actuator == nullptr && !config.joints.actuator.empty())
    actuator = ActuatorNetwork::read(config.joints.actuator);
}

LoadedEnv LoadedEnv::with(EnvConfig changed) const {
  LoadedEnv other(changed, changed.robot == config.robot ? robot : read_robot(changed),
                  changed.joints.actuator == config.joints.actuator ? actuator : nullptr);
  if (changed.terrain == config.terrain) other.ground = ground;
  return other;
}

}  // namespace crossgait
