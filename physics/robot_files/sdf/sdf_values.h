// Numbers, words and poses of an SDF's elements.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "physics/core/math.h"
#include "physics/robot_files/sdf/sdf_document.h"

namespace crossgait {

/// All throw ConfigError naming the element whose text is something else. The text of a child that is not
/// there is `otherwise`.

/// Returns the child, which has to be there.
const SdfElement& sdf_needed(const SdfElement& parent, std::string_view child);
/// Reads as many finite numbers as `count`.
std::vector<double> sdf_numbers(const SdfElement& element, std::size_t count);
Vector3 sdf_vector(const SdfElement& parent, std::string_view child, const Vector3& otherwise);
double sdf_number(const SdfElement& parent, std::string_view child, double otherwise);
/// Reads a number from 0 on.
double sdf_size(const SdfElement& parent, std::string_view child, double otherwise);
/// Reads a bound: "inf", "-inf" and numbers from 1e16 on, SDF's own words for none, are infinite.
double sdf_bound(const SdfElement& parent, std::string_view child, double otherwise);
bool sdf_flag(const SdfElement& parent, std::string_view child, bool otherwise);
/// Reads a `<pose>`, wherever it is relative to: Euler angles, also in degrees, or a quaternion. Null and
/// empty ones are the identity.
Pose sdf_pose(const SdfElement* pose);

/// Reads the `<scale>` of a `<mesh>`, in which no number is 0.
Vector3 sdf_mesh_scale(const SdfElement& mesh);
/// Holds what a `<submesh>` says: the name of the part of a mesh file that is meant; empty for all of it.
struct SdfSubmesh {
  std::string name;
  bool is_centred = false;  ///< the middle of the box around the part is the origin

  /// Puts vertices of the part, in the units of the file, where they are meant to be.
  void place(std::vector<Vector3>& vertices) const;
};
/// Reads the `<submesh>` of a `<mesh>`, if there is one.
SdfSubmesh sdf_submesh(const SdfElement& mesh);

}  // namespace crossgait
