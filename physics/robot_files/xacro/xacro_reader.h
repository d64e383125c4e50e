// A xacro file, which the program xacro expands to a URDF.
#pragma once

#include <string>
#include <string_view>

#include "physics/robot_files/file_arguments.h"
#include "physics/robot_files/parsed_robot.h"

namespace crossgait {

/// Follows a file's path where results name what it was expanded to, which is in no file.
inline constexpr std::string_view kExpanded = " (expanded)";

/// Expands the file and reads what comes out as a URDF in its place (`read_urdf_text`). Done by the module
/// `xacro` of the Python that `python_program` says, else by the program `xacro` on the path, within
/// kXacroSeconds. `$(find PACKAGE)` is, where Python has no ament_index_python to ask, the folder of that
/// name where `find_named_file` looks, or one whose package.xml says that name.
/// xacro evaluates Python: `require_consent` is asked first.
/// @param arguments  `xacro:arg`s, by name
/// @throws ConfigError naming the file: without consent or xacro, with what xacro says, beyond the budget, or
/// for an argument that no file declares (as far as Python's module ran)
ParsedRobot read_xacro(const std::string& path, const FileArguments& arguments);

}  // namespace crossgait
