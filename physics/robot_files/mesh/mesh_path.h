// Where the mesh files of a URDF are.
#pragma once

#include <optional>
#include <string>

namespace crossgait {

/// The file that a URDF means by `filename`, the first that exists of
///  - an absolute path, also as file://PATH, as it is;
///  - package://PACKAGE/REST and model://PACKAGE/REST: PACKAGE/REST and then REST in the URDF's folder and in
///  every
///    folder above it, and in the folders that the environment variables CROSSGAIT_PACKAGE_PATH and
///    ROS_PACKAGE_PATH list, apart by colons;
///  - any other path: in the same folders.
/// @returns empty if there is no such regular file
std::optional<std::string> find_mesh(const std::string& filename, const std::string& urdf_path);

}  // namespace crossgait
