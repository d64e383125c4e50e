// Servo laws by their names in files.
#pragma once

#include "physics/core/find_row.h"
#include "physics/core/yaml_reader.h"
#include "physics/robot/joint_numbers.h"

namespace crossgait {

/// Reads the law `name` of a mapping of servos' numbers. @throws ConfigError if the mapping holds the law's
/// numbers as well, or there is no such law
inline const ServoLaw& read_servo_law(const YamlValue& servos, const YamlValue& name) {
  for (const char* number : {"implicit_stiffness", "implicit_damping"}) {
    if (const auto value = servos.find(number)) value->fail("either a law or its numbers", "both");
  }
  return find_row(kServoLaws, name.text(), servos.source(), "servo law");
}

}  // namespace crossgait
