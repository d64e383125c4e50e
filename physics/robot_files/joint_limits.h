// Which of a file's joint limits are meant.
#pragma once

#include <string_view>

#include "physics/robot/robot.h"
#include "physics/robot_files/reader_warnings.h"

namespace crossgait {

/// Limits the joint. Limits beyond +-2 pi rad are placeholders: each becomes +-pi, and is counted. Where both
/// are, where they are missing, or lower >= upper, commanded targets alone are kept within +-pi.
/// @param element  of the joint, for the warning
void set_limits(double lower, double upper, std::string_view element, Joint& joint, ReaderWarnings& warnings);

}  // namespace crossgait
