#include "conformance/topics.h"

#include <stdexcept>

#include <fmt/format.h>

#include "physics/robot/multibody.h"

namespace crossgait::conformance {

void advance(PhysicsBackend& world, const JointTargets& targets, int steps) {
  if (world.step(targets, steps) == StepStatus::kOk) return;
  throw std::runtime_error(fmt::format("{} diverged after {:.4g} s", world.robot().name, world.state().time));
}

WorldSpec world_on(const char* terrain, const scenes::RobotPtr& robot) {
  WorldSpec spec = scenes::world_of(robot);
  spec.terrain = make_terrain(terrain);
  return spec;
}

bool is_soft(const Subject& subject) { return subject.engine.info.capabilities.soft_contact; }

double loop_gap(const PhysicsBackend& world) {
  std::vector<Pose> poses;
  forward_kinematics(world.robot(), world.state(), poses);
  return max_loop_gap(world.robot(), poses);
}

}  // namespace crossgait::conformance
