// The visual shapes of a URDF's links.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "physics/robot/robot.h"
#include "physics/robot_files/reader_warnings.h"

class TiXmlElement;

namespace crossgait {

/// Reads shapes by link, in the link's frame. Looks make no file unfit: a `visual` without a shape, or with
/// numbers that are none, is dropped and counted, as is a mesh whose file is not there. Colours are those of
/// the `material`, which may stand in another visual, or in the robot, under the same name; textures are not
/// read.
/// @param path  of the URDF
std::map<std::string, std::vector<VisualShape>> read_urdf_visuals(const TiXmlElement& robot,
                                                                  const std::string& path,
                                                                  ReaderWarnings& warnings);

}  // namespace crossgait
