// Which of a file's joint limits are meant.
#pragma once

#include <string_view>

#include "physics/robot/robot.h"
#include "physics/robot_files/reader_warnings.h"

namespace crossgait {

/// Limits beyond +-2 pi rad, missing ones and those with lower >= upper are placeholders: each becomes +-pi,
/// and is counted. @param element  of the joint, for the warning
void set_limits(double lower, double upper, std::string_view element, Joint& joint, ReaderWarnings& warnings);

}  // namespace crossgait
