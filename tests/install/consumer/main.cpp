// What a user of the installed library writes: the robot that came with it, a step in every engine that is
// found.
#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>

#include "crossgait/backends/registry.h"
#include "crossgait/physics/robot_files/data_path.h"

namespace {

/// Height of the base after `seconds` with the servos holding the home pose, m.
double stand(const std::string& engine, const crossgait::WorldSpec& spec, double seconds) {
  const auto world = crossgait::make_world(engine, spec);
  world->reset();
  crossgait::JointTargets targets;
  const auto actuated = spec.robot->actuated_joints();
  targets.q.resize(static_cast<Eigen::Index>(actuated.size()));
  for (std::size_t i = 0; i < actuated.size(); ++i) {
    targets.q[static_cast<Eigen::Index>(i)] = spec.robot->home[actuated[i]];
  }
  const auto status = world->step(targets, static_cast<int>(std::lround(seconds / spec.physics_dt)));
  return status == crossgait::StepStatus::kOk ? world->state().p_WB.z() : std::nan("");
}

}  // namespace

int main() {
  try {
    crossgait::WorldSpec spec;
    const std::string file = crossgait::find_robot("scara_quadruped");
    std::printf("robot: %s\n", file.c_str());
    spec.robot = std::make_shared<const crossgait::RobotDescription>(crossgait::load_robot(file));
    const auto backends = crossgait::available_engines();
    for (const crossgait::EngineListing& engine : crossgait::known_engines()) {
      std::printf("%s: %s\n", engine.name.c_str(), engine.file.c_str());
    }
    for (const std::string& engine : backends) {
      const double height = stand(engine, spec, 0.5);
      std::printf("%s: base at %.4f m\n", engine.c_str(), height);
      // The legs are soft and sag, but a standing robot's base is above the ground and not above where it
      // started.
      if (!(height > 0.5 * spec.robot->home_height && height < 1.1 * spec.robot->home_height)) return 1;
    }
    return backends.empty() ? 1 : 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
