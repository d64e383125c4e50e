// Joints of an MJCF that do not move by themselves.
#pragma once

#include <map>
#include <string>

#include "physics/robot_files/mjcf/mjcf_defaults.h"
#include "physics/robot_files/mjcf/mjcf_document.h"

namespace crossgait {

/// Finds the joints that something else moves, and says what ("follows 'knee' (equality joint (line 7))"):
/// the first joint of a `<joint>` in `<equality>`, and those of fixed tendons that are driven, or are equal
/// to another, without an actuator of their own. Of a tendon of one joint its actuators become that joint's,
/// with its coefficient in their gear. What is not active is none. @throws ConfigError naming the element
std::map<std::string, std::string> find_couplings(MjcfDocument& document, const MjcfDefaults& defaults);

}  // namespace crossgait
