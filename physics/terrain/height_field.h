// A grid of heights and the triangles that both engines make of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "physics/core/math.h"

namespace crossgait {

/// Most samples of one field. 4096 x 4096 floats are 64 MiB; with MuJoCo's copy (floats) and Bullet's
/// (doubles) a comparison already holds 256 MiB of ground, and MuJoCo 2.2.2 counts the bytes of a model in a
/// 32-bit int.
inline constexpr std::int64_t kMaxHeightSamples = std::int64_t{4096} * 4096;

/// Describes contact of a sphere with terrain: the terrain's point closest to the sphere's centre.
struct SphereContact {
  Vector3 position = Vector3::Zero();  ///< midway between the surfaces along the normal, W, m
  Vector3 normal = Vector3::UnitZ();   ///< unit, from terrain to sphere
  double distance = 0;                 ///< between the surfaces, m; negative when penetrating
};

/// Holds a row-major float grid centred on the world origin, x fastest: heights[r * columns + c], c along +x,
/// r along +y. Each cell is split along (c,r)-(c+1,r+1), as MuJoCo does and Bullet does with flipQuadEdges;
/// never bilinear. Heights are floats because MuJoCo stores floats: what is not representable cannot differ
/// between engines. Heights are rounded to multiples of one power of two, at most 1.2e-7 of the largest
/// height or range, so that floats hold every difference of two heights: MuJoCo stores floats relative to the
/// lowest.
class HeightField {
 public:
  /// @param columns,rows  at least 2 each, at most kMaxHeightSamples together
  /// @param size_x,size_y  full extent, m, positive
  /// @param heights  columns * rows finite values, m
  /// @param source  file or generator, for messages
  /// @throws ConfigError
  HeightField(int columns, int rows, double size_x, double size_y, std::vector<float> heights,
              const std::string& source = "height field");

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  double size_x() const { return size_x_; }
  double size_y() const { return size_y_; }
  double cell_x() const { return size_x_ / (columns_ - 1); }
  double cell_y() const { return size_y_ / (rows_ - 1); }
  std::span<const float> heights() const { return heights_; }
  /// Returns sample [0, columns) x [0, rows), unchecked, m. It is at (column * cell_x() - size_x() / 2, ...).
  double at(int column, int row) const noexcept {
    return heights_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                    static_cast<std::size_t>(column)];
  }
  double min() const { return min_; }
  double max() const { return max_; }

  /// Returns true where (x, y) lies on the field, its border included. Outside, `height` and `normal` answer
  /// for the nearest point on it; for a NaN coordinate, as for minus infinity.
  bool contains(double x, double y) const noexcept;
  /// Reads the triangle's height over (x, y), m. With u, v in [0, 1] across the cell and corners a = (c, r),
  /// b = (c+1, r), e = (c, r+1), f = (c+1, r+1): a + u (b-a) + v (f-b) if u >= v, else a + v (e-a) + u (f-e).
  double height(double x, double y) const noexcept;
  Vector3 normal(double x, double y) const noexcept;  ///< unit, of the triangle under (x, y)

  /// Finds the closest point of the surface to `centre` if it is nearer than `radius` (distance < 0); deepest
  /// only. Exact over faces, edges and corners of the triangles (Ericson, Real-Time Collision Detection,
  /// 2004, section 5.1.5). A centre below the surface, however deep, is pushed out along the normal of the
  /// triangle over it: distance = -(depth along that normal) - radius. The ground ends at the border: a
  /// centre outside the field, or not finite, touches nothing.
  /// @returns false, leaving `contact` alone, when nothing is within reach.
  bool touch_sphere(const Vector3& centre, double radius, SphereContact& contact) const noexcept;

 private:
  /// Describes the plane of one triangle: its height at a point and its slopes dz/dx, dz/dy.
  struct Facet {
    double height, slope_x, slope_y;
    Vector3 normal() const noexcept { return Vector3(-slope_x, -slope_y, 1).normalized(); }
  };
  /// Holds cells [first, last] in each direction.
  struct CellRange {
    int first_column, last_column, first_row, last_row;
  };
  Facet facet(double x, double y) const noexcept;
  CellRange cells_around(const Vector3& centre, double radius) const noexcept;
  double highest(const CellRange& cells) const noexcept;
  Vector3 closest_point(const Vector3& centre, double radius, const CellRange& cells) const noexcept;

  int columns_, rows_;
  double size_x_, size_y_;
  std::vector<float> heights_;
  double min_ = 0, max_ = 0;
  double cells_per_x_ = 0, cells_per_y_ = 0;  ///< 1 / cell_x(), 1 / cell_y(): no division in a query
};

}  // namespace crossgait
