// What a viewer may ask of a session, and how it says so: one small JSON object.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "gait/velocity_command.h"
#include "physics/core/math.h"
#include "view/subject.h"

namespace crossgait {

/// Holds {"do": "drive", "vx": m/s, "vy": m/s, "yaw_rate": rad/s}.
struct DriveCommand {
  VelocityCommand velocity;
};
/// Holds {"do": "gait", "gait": NAME}, `auto` among them.
struct GaitCommand {
  std::string gait;
};
/// Holds {"do": "set", "name": PARAMETER, "value": NUMBER}.
struct ParameterCommand {
  std::string name;
  double value = 0;
};
/// Holds {"do": "curve", "curve": NAME}: of SwingCurve.
struct CurveCommand {
  std::string curve;
};
/// Holds {"do": "push", "impulse": [x, y, z]}, N s, in the axes of W.
struct PushCommand {
  Vector3 impulse = Vector3::Zero();
};
/// Holds {"do": "terrain", "terrain": "NAME[:k=v,...]", "seed": NUMBER}: a generator, never a file.
struct TerrainCommand {
  std::string terrain;
  std::uint64_t seed = 0;
};
/// Holds {"do": "engines", "engines": [NAME, ...]}: one, or several side by side.
struct EnginesCommand {
  std::vector<std::string> engines;
};
/// Holds {"do": "robot", "robot": NAME}: another one, which a hand drives.
struct RobotCommand {
  std::string robot;
};
/// Holds {"do": "policy", "policy": NAME}: in the environment and with the robot that it was made for; ""
/// leaves the robot to the hand.
struct PolicyCommand {
  std::string policy;
};
/// Holds what was dropped on a page: no command in JSON (ViewServer's `/drop`).
struct SubjectCommand {
  ViewSubject subject;
};
/// Holds {"do": "pause", "on": BOOL}.
struct PauseCommand {
  bool on = false;
};
/// Holds {"do": "step", "steps": NUMBER}: control steps while paused.
struct StepCommand {
  std::uint64_t steps = 1;
};
/// Holds {"do": "pace", "pace": NUMBER}: simulated time over time on the clock, 1 or less.
struct PaceCommand {
  double pace = 1;
};
/// Holds {"do": "back", "seconds": NUMBER}: to where all was then.
struct BackCommand {
  double seconds = 0;
};
/// Holds {"do": "change", "changes": ["friction=0.4", "mass=x1.2", ...]}: of the world as it was at first
/// (world_quantities.h), in place of all changes before.
struct ChangeCommand {
  std::vector<std::string> changes;
};
/// Holds {"do": "pull", "to": [x, y, z]}: a spring from the base's origin to a point in W, m, until
/// "release".
struct PullCommand {
  Vector3 to = Vector3::Zero();
};
/// Holds {"do": "release"}.
struct ReleaseCommand {};
/// Holds {"do": "keep"}: the last minute becomes the recording.
struct KeepCommand {};
/// Holds {"do": "stand"}: up again, at the origin.
struct StandCommand {};
/// Holds {"do": "record", "on": BOOL}.
struct RecordCommand {
  bool on = false;
};

using ViewCommand = std::variant<DriveCommand, GaitCommand, ParameterCommand, CurveCommand, PushCommand,
                                 TerrainCommand, EnginesCommand, PauseCommand, StandCommand, RecordCommand,
                                 StepCommand, PaceCommand, BackCommand, ChangeCommand, PullCommand,
                                 ReleaseCommand, KeepCommand, RobotCommand, PolicyCommand, SubjectCommand>;

/// Longest text of a command, bytes.
inline constexpr std::size_t kMaxCommandBytes = 4096;

/// Reads what `text` says. Ranges are the session's to check. @throws ConfigError for text that is no JSON
/// object, an unknown command, and keys that are missing, unknown or of another type
ViewCommand parse_view_command(std::string_view text);

}  // namespace crossgait
