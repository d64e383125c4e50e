// Which of a file's joint limits are meant.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "physics/robot/robot.h"
#include "physics/robot_files/reader_warnings.h"

namespace crossgait {

/// Limits the joint. Limits beyond +-2 pi rad are placeholders: each becomes +-pi, and is counted. Where both
/// are, where they are missing, or lower >= upper, commanded targets alone are kept within +-pi. One that is
/// infinite, as a format has it that need not give both, is +-pi, too.
/// @param follows  another joint, by gears perhaps: limits of many turns are meant
/// @param element  of the joint, for the warning
void set_limits(double lower, double upper, bool follows, std::string_view element, Joint& joint,
                ReaderWarnings& warnings);

/// Keeps the speed that a file lets a joint have, rad/s; of 0 or less, and from 1e9 rad/s on (placeholders),
/// there is none.
void keep_velocity_limit(double limit, const std::string& joint, std::map<std::string, double>& limits);

}  // namespace crossgait
