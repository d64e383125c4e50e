// What joints' names say of legs. Private to inference.
#pragma once

#include <optional>
#include <string_view>

#include "physics/robot/leg.h"

namespace crossgait {

/// Returns the leg that a name says: FL, LF, front_left, HL, LH, rear_left, leg_front_l, LeftFront,
/// hindRight... Nothing for a name that says none, or several.
std::optional<Leg> leg_in_name(std::string_view name);

}  // namespace crossgait
