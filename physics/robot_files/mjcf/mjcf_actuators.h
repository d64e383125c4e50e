// Actuators of an MJCF. No compiler is asked: what newer ones know of them means the same here with an old
// one.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "physics/robot_files/mjcf/mjcf_defaults.h"
#include "physics/robot_files/mjcf/mjcf_document.h"
#include "physics/robot_files/reader_warnings.h"

namespace crossgait {

enum class MjcfActuatorKind {
  kMotor,  ///< force = gain control
  kServo,  ///< force = gain control + bias[0] + bias[1] length + bias[2] speed
  kOther,
};

using MjcfRange = std::array<double, 2>;

/// Describes what moves a joint, in units of its own: through a gear g, an angle q of the joint is a length g
/// q, and a force f a torque g f (MuJoCo manual, "Actuation model").
struct MjcfActuator {
  std::string name, joint;
  std::string tag, place, numbers;  ///< for messages: "position", "position 'p' (line 7)", what it says
  MjcfActuatorKind kind = MjcfActuatorKind::kMotor;
  double gear = 1, gain = 1;
  std::array<double, 3> bias{};      ///< bias[2] > 0 where gain = -bias[1]: a damping ratio
  double lag = 0;                    ///< of a filter of the control, s
  double delay = 0;                  ///< s
  double armature = 0, damping = 0;  ///< of its own, behind the gear
  std::optional<MjcfRange> control, force, activation;  ///< where they are limited
  double inherit = 0;           ///< share of the joint's range that the control has; 0: it says its own
  bool control_limited = true;  ///< false: an inherited range bounds nothing

  /// Tells whether it holds its joint at an angle.
  bool is_position() const { return kind == MjcfActuatorKind::kServo && bias[1] < 0; }
};

/// Reads the actuators of joints in the order of the file, and takes all actuators out of the document and
/// out of its classes. Those of anything else are counted by their kinds.
/// @throws ConfigError naming the element
std::vector<MjcfActuator> take_actuators(MjcfDocument& document, const MjcfDefaults& defaults,
                                         ReaderWarnings& warnings);

}  // namespace crossgait
