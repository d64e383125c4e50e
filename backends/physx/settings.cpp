#include "backends/physx/settings.h"

namespace crossgait::physx {

std::optional<Settings> find_settings(std::string_view name) {
  // What stands only in what trains (step, decimation, gains, restitution, limits of speed) is the world's or
  // the robot's here, or off.
  for (Settings settings :
       {Settings{.name = "physx"}, Settings{.name = "physx:pgs", .temporal = false},
        Settings{
            .name = "physx+isaacgym", .velocity_iterations = 0, .contact_offset = 0.01, .depenetration = 1},
        Settings{.name = "physx+isaaclab", .velocity_iterations = 0, .depenetration = 1}}) {
    if (settings.name == name) return settings;
  }
  return std::nullopt;
}

}  // namespace crossgait::physx
