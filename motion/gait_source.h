// Gaits as controllers of a walk.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gait/scale.h"
#include "motion/foot_target_tracker.h"
#include "motion/heading_hold.h"
#include "physics/engine/world_spec.h"

namespace crossgait {

/// The names that stand for "the gait for the speed": with `default_speed_bands`, with `guide_speed_bands`.
inline constexpr std::string_view kAutomaticGait = "auto", kGuidesAutomaticGait = "auto:guide";

constexpr bool is_automatic(std::string_view gait) {
  return gait == kAutomaticGait || gait == kGuidesAutomaticGait;
}

/// Says what to walk: a gait, or whichever suits the commanded speed.
struct GaitChoice {
  std::optional<Gait> gait;                ///< empty: by speed (MultiGaitController)
  std::vector<SpeedBand> bands;            ///< then of these, each with its own preferred parameters
  std::string automatic{kAutomaticGait};   ///< and this is what that choice is called
  GaitParameters parameters;               ///< of the gait; of the slowest one, where it is chosen by speed
  std::optional<VelocityCommand> command;  ///< empty: steps of step_length

  std::string name() const { return gait ? std::string(gait->name) : automatic; }
};

/// Returns a gait by name with its preferred parameters, changed by assignments "name=value" (see
/// gait/parameters.h). Where the gait is chosen by speed they change every one of them.
/// @param gait  a name of `gaits()`, or an automatic one, which needs a command
/// @param scale  of the robot that is to walk (`gait_scale`): preferred parameters are those of its size;
///               settings are absolute
/// @throws ConfigError for an unknown gait, parameter or value, or a command that is not finite
GaitChoice choose_gait(const std::string& gait, const std::vector<std::string>& settings,
                       const std::optional<VelocityCommand>& command = {}, const GaitScale& scale = {});

/// Returns the options of a gait that is chosen by speed, at the robot's size.
MultiGaitOptions multi_gait_options(const GaitChoice& choice, const GaitScale& scale);

/// Returns the positions alone, as FootTargetTracker takes them.
LegArray<Vector3> target_positions(const LegArray<FootTarget>& targets) noexcept;

/// Sends a gait's targets for the next `dt` (s) to legs that make up for its share of their load, and says
/// what it means by them: swing, velocity, parameters.
/// @param command  empty: the velocity is that of steps of step_length
void drive_legs(FootTargetTracker& legs, const GaitGenerator& generator, const LegArray<FootTarget>& feet,
                const std::optional<VelocityCommand>& command, double dt, ControlTargets& out) noexcept;

/// Returns the body's velocity by steps of step_length: one step per stance.
VelocityCommand nominal_velocity(const GaitGenerator& generator) noexcept;

/// Says what stands between a gait and the servos besides kinematics. Each can be switched off.
struct GaitLayers {
  ServoCompensation compensation;
  HeadingHold heading_hold;
};

/// Walks `choice` from standing, with the robot and under the gravity of `world`. Every call makes an
/// independent controller. @throws ConfigError if the robot has no legs
ControllerPtr make_gait_controller(const GaitChoice& choice, const WorldSpec& world,
                                   const GaitLayers& layers = {});

/// Foot targets in the leg frames, m, after `dt` more seconds. Asked with dt = 0 before the first step, it
/// says where the feet stand.
using FootTargets = std::function<LegArray<Vector3>(double dt)>;

/// Takes feet from anywhere else: recorded, computed, commanded. Nothing is known of what they mean, so that
/// statistics of swing and progress stay empty. @throws ConfigError if the robot has no legs
ControllerPtr make_feet_controller(FootTargets feet, const WorldSpec& world,
                                   const ServoCompensation& compensation = {});

}  // namespace crossgait
