// What urdfdom lets pass, and what it does not: it ignores misspelt elements without a word, takes the last
// of two parents, names no line, and refuses much that real files hold and nobody needs.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "physics/robot/robot.h"
#include "physics/robot_files/parsed_robot.h"
#include "physics/robot_files/reader_warnings.h"
#include "physics/robot_files/urdf/urdf_extensions.h"

namespace crossgait {

struct CheckedUrdf {
  std::string text;                                         ///< a URDF of what is left, which urdfdom takes
  std::map<std::string, std::vector<VisualShape>> visuals;  ///< see `read_urdf_visuals`
  std::vector<NamedCoupling> couplings;                     ///< of joints with `<mimic>`
  UrdfExtensions extensions;                                ///< what stands beside links and joints
};

/// Checks that `text` is well-formed XML holding a URDF whose links and joints have finite numbers, joint
/// types that are simulated and unique names, and form one tree.
///  - Unknown elements and attributes inside links and joints, looks included, and second ones of a kind, are
///    counted as warnings. Elements of `robot` other than `link` and `joint` are urdf_extensions.h's.
///  - A massless root on which nothing but a floating joint hangs is taken away: its child is the free base.
///  - A `<mimic>` has to name another joint that moves, and counts on a joint that does.
/// @throws ConfigError naming `source`, the line and the link or joint
CheckedUrdf check_urdf(const std::string& text, const std::string& source, ReaderWarnings& warnings);

}  // namespace crossgait
