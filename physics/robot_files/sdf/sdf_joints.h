// Which joints of an SDF make its tree, and which close loops of it.
#pragma once

#include <string>
#include <vector>

#include "physics/robot_files/reader_warnings.h"
#include "physics/robot_files/sdf/sdf_model.h"

namespace crossgait {

struct SdfJoints {
  std::string root;  ///< the link on which the robot hangs: its base
  std::vector<const SdfJoint*> of_tree, of_loops;
};

/// Sorts joints. A link's first joint holds it, unless it is a ball joint or said to close a loop
/// (`must_be_loop_joint`) and there is another one; the further ones close loops. A joint that fixes a link
/// to the world is left out, with a warning. @throws ConfigError naming the joint or the links: for types
/// that are not simulated, loops closed by a fixed joint, no moving joint or several trees with any, and
/// joints in a cycle
SdfJoints sort_joints(const SdfModel& model, const std::string& main_file, ReaderWarnings& warnings);

}  // namespace crossgait
