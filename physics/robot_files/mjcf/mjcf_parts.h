// What of an MJCF is a robot's, made ready for a compiler.
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>

#include "physics/core/math.h"
#include "physics/robot_files/mjcf/mjcf_document.h"
#include "physics/robot_files/reader_warnings.h"

namespace crossgait {

/// Describes a mesh of the file's assets: p = scale * R_ref^T (vertex - p_ref).
struct MjcfMesh {
  std::string written;  ///< the path as the file has it; empty: its vertices stand in the MJCF
  std::string file;     ///< that it is; empty: there is none
  Vector3 scale = Vector3::Ones(), p_ref = Vector3::Zero();
  Matrix3 R_ref = Matrix3::Identity();
  MjcfElement original;
  MjcfElement* element = nullptr;  ///< in the document, see `give_mesh`

  bool is_moved() const { return !p_ref.isZero(0) || !R_ref.isIdentity(0); }
};

struct MjcfParts {
  std::map<std::string, MjcfMesh> meshes;                                  ///< by name
  std::map<std::pair<std::string, std::string>, MjcfElement*> with_names;  ///< by tag and name
  std::set<std::string> with_inertial;  ///< bodies whose mass does not follow from their geoms

  /// Returns a body, joint or geom. Freejoints are joints.
  const MjcfElement& element(const std::string& tag, const std::string& name) const;
};

/// Leaves in the document what makes a robot: compiler settings, defaults, meshes, materials' colours, bodies
/// with their joints and geoms, connect constraints and keyframes. What else could
/// change how it moves is counted as a warning; what is the world's business (options, sizes, visual
/// settings) is not.
///  - Bodies, joints and geoms without a name get one.
///  - Every mesh of a file becomes a box about its own origin and axes: its file is not needed for where it
///  is.
///  - Limits are meant where ranges are given (autolimits), unless the file says otherwise.
/// @throws ConfigError for what multiplies (composite, replicate), too many bodies, and paths of meshes that
/// are not relative to the file
MjcfParts take_parts(MjcfDocument& document, ReaderWarnings& warnings);

/// Puts a mesh's own vertices back in place of the box, in a file of this name.
void give_mesh(MjcfMesh& mesh, const std::string& name);

}  // namespace crossgait
