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
  const bool same_ground = changed.terrain == config.terrain;
  auto its_robot = changed.robot == config.robot ? robot : read_robot(changed);
  auto its_actuator = changed.joints.actuator == config.joints.actuator ? actuator : nullptr;
  LoadedEnv other(std::move(changed), std::move(its_robot), std::move(its_actuator));
  if (same_ground) other.ground = ground;
  return other;
}

}  // namespace crossgait
