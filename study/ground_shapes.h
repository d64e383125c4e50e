// The shapes that a ground is made of, and their heights as a field.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "physics/core/math.h"
#include "physics/robot_files/reader_warnings.h"
#include "physics/terrain/height_field.h"
#include "study/scene_terrain.h"

namespace crossgait {

/// Holds a height field around its own origin; `base` is how thick it is below its lowest.
struct GroundField {
  HeightField field;
  double base;
};

/// Holds the heights between which a vertical line is inside a solid, m.
struct HeightRange {
  double bottom = -std::numeric_limits<double>::infinity(), top = std::numeric_limits<double>::infinity();
};

/// Describes a face of a hull, or a plane: what is inside has n . p <= d.
struct HalfSpace {
  Vector3 n;
  double d;
};

/// Collects shapes that stand in a world's frame, and samples them from above.
class GroundShapes {
 public:
  /// @param path  of the scene, for messages
  explicit GroundShapes(const std::string& path) : path_(path) {}

  /// Adds what is below a plane. @param X_WG  pose of the plane, z its normal @returns false, adding nothing,
  /// if it does not face upwards
  bool add_plane(const Pose& X_WG);
  void add_sphere(const Pose& X_WG, double radius);
  /// Adds a cylinder along z; @param half_length m
  void add_cylinder(const Pose& X_WG, double radius, double half_length);
  /// Adds a capsule along z. @param half_length  between the centres of its ends, m
  void add_capsule(const Pose& X_WG, double radius, double half_length);
  void add_box(const Pose& X_WG, const Vector3& half);
  /// Adds the convex hull of vertices in the world's frame, of at most kMeshCorners corners.
  /// @returns whether all of them are within a millimetre of it
  bool add_hull(const std::vector<Vector3>& vertices);
  /// Adds a height field. @returns false, adding nothing, if it does not lie level
  bool add_field(GroundField field, const Pose& X_WG);

  /// Samples as read_scene_terrain says. @param warnings  of the shapes that were read
  SceneTerrain sample(double cell, std::vector<std::string> warnings);

 private:
  /// Describes one shape: its extent in x and y, and the line through it over a point.
  struct Solid {
    double x_min, x_max, y_min, y_max;
    std::function<std::optional<HeightRange>(double x, double y)> over;
  };
  void add(const Pose& X_WG, const Vector3& half,
           std::function<std::optional<HeightRange>(double, double)> over);
  void sample_row(double y, double cell, int columns, std::vector<float>& heights);
  float height_of(std::vector<HeightRange>& here);
  SceneTerrain finish(int columns, int rows, double cell, std::vector<float> heights,
                      std::vector<std::string> warnings) const;

  const std::string path_;
  std::vector<HalfSpace> planes_;
  std::vector<Solid> solids_;
  std::size_t overhangs_ = 0;
};

}  // namespace crossgait
