#include "study/loaded_walk.h"

#include <utility>

#include "physics/robot_files/data_path.h"

namespace crossgait {

LoadedWalk::LoadedWalk(const WalkConfig& walk)
    : LoadedWalk(walk, std::make_shared<const RobotDescription>(load_robot(find_robot(walk.robot)))) {}

LoadedWalk::LoadedWalk(WalkConfig walk, std::shared_ptr<const RobotDescription> read)
    : config(std::move(walk)), ground(config.terrain) {
  world.robot = std::move(read);
  world.terrain = ground.make(config.terrain_seed);
  world.physics_dt = config.physics_dt;
  world.contact = resolve_contact(world.robot->contact, config.contact, "walk");
  double& time_constant = world.contact.softness.time_constant;
  time_constant = time_constant_in_steps(time_constant, world.physics_dt);
  world.validate();
}

}  // namespace crossgait
