// How an episode begins where not standing: in the air, on the move, with its joints elsewhere.
#pragma once

#include <optional>
#include <string_view>

#include "env/joint_settings.h"
#include "env/randomisation.h"
#include "motion/controller.h"

namespace crossgait {

/// Describes the first instant of an episode; what is empty or zero changes nothing of standing.
struct StartSettings {
  std::optional<double> height;                ///< of the base's origin over the ground below it, m; empty:
                                               ///< as high as the lowest foot just touches
  Vector3 velocity = Vector3::Zero();          ///< of the base's origin, ahead, left and up, m/s
  Vector3 angular_velocity = Vector3::Zero();  ///< about ahead, left and up, rad/s
  ServoNumbers joint_offsets;                  ///< from home, rad
  ServoNumbers joint_velocities;               ///< rad/s

  /// @throws ConfigError naming `source` for what no start can be
  void validate(std::string_view source) const;

  bool operator==(const StartSettings&) const = default;
};

/// Returns the state in which an episode begins: what the settings say of `standing`, and on top of it what
/// is drawn. Joints of legs that no servo drives, and their velocities, follow the servos.
/// @param placement  that `standing` is at
/// @throws ConfigError naming the settings for a name that is no servo's, an angle beyond the joint's limits,
/// chains that do not meet, or a height at which a foot is below the ground
RobotState start_state(const StartSettings& settings, const Randomisation& randomisation,
                       const RandomDraw& draw, const RobotDescription& robot, const Terrain& terrain,
                       const Placement& placement, RobotState standing);

}  // namespace crossgait
