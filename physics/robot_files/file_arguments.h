// What robots' files are told before they are read.
#pragma once

#include <map>
#include <string>

namespace crossgait {

/// Values by name, of a format that takes them (`RobotFormat::has_arguments`): arguments of a xacro.
using FileArguments = std::map<std::string, std::string>;

/// Returns what every robot's file is told, over what its robot.yaml says: nothing until set, once, by a
/// program before it reads any (`--xacro-arg`).
const FileArguments& given_file_arguments() noexcept;
void set_given_file_arguments(FileArguments arguments);

}  // namespace crossgait
