// Where the files are that a robot's file names.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace crossgait {

/// Finds the file that a URDF or an SDF means by `filename`, a mesh or an include: the first that exists of
///  - an absolute path, also as file://PATH or file:PATH, as it is;
///  - package://PACKAGE/REST and model://PACKAGE/REST: PACKAGE/REST and then REST in the folder of `named_in`
///  and
///    in every folder above it (PACKAGE/../REST is REST, whether PACKAGE is there or not), and in the folders
///    that the environment variables CROSSGAIT_PACKAGE_PATH, ROS_PACKAGE_PATH, GZ_SIM_RESOURCE_PATH and
///    GAZEBO_MODEL_PATH list, apart by colons, and in `share` of those of AMENT_PREFIX_PATH;
///  - any other path: in the same folders.
/// What has a scheme is a URI: escapes as %20 are undone where no file has them in its name.
/// @param named_in  the file that names it @returns empty if there is no such regular file
std::optional<std::string> find_named_file(const std::string& filename, const std::string& named_in);

/// Lists the folders in which those are looked for, the first first.
std::vector<std::string> named_file_folders(const std::string& named_in);

}  // namespace crossgait
