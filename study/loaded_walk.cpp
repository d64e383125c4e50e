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
  world.contact = simulated_contact(world.robot->contact, config.contact, world.physics_dt, "walk");
  world.validate();
}

}  // namespace crossgait
