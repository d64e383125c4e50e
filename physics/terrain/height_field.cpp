#include "physics/terrain/height_field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait {
namespace {

/// Clamped to [0, highest]; NaN becomes 0, so that no query can index outside the grid.
double clamp_index(double value, double highest) noexcept { return value > 0 ? std::min(value, highest) : 0; }

/// Closest point of the triangle abc to the origin: Ericson, Real-Time Collision Detection, 2004,
/// section 5.1.5, with p = 0.
Vector3 closest_on_triangle(const Vector3& a, const Vector3& b, const Vector3& c) noexcept {
  const Vector3 ab = b - a;
  const Vector3 ac = c - a;
  const double d1 = -ab.dot(a);
  const double d2 = -ac.dot(a);
  if (d1 <= 0 && d2 <= 0) return a;
  const double d3 = -ab.dot(b);
  const double d4 = -ac.dot(b);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + ab * (d1 / (d1 - d3));
  const double d5 = -ab.dot(c);
  const double d6 = -ac.dot(c);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + ac * (d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
  // Inside: the foot on the plane, along the normal so that it gives the exact direction however near the
  // plane is.
  const Vector3 normal = ab.cross(ac);
  return normal * (normal.dot(a) / normal.squaredNorm());
}

/// Rounds to multiples of one power of two, so fine that a float holds every height and every difference of
/// two: 24 bits for the largest of either. What rounds is below 1e-7 of the range.
void quantise(std::vector<float>& heights) {
  const auto [lowest, highest] = std::minmax_element(heights.begin(), heights.end());
  const double range = static_cast<double>(*highest) - static_cast<double>(*lowest);
  const double largest = std::max({range, std::abs(double{*lowest}), std::abs(double{*highest})});
  if (largest == 0) return;
  constexpr int kBits = std::numeric_limits<float>::digits;
  const double quantum = std::ldexp(1.0, std::ilogb(largest) + 1 - kBits);
  for (float& height : heights) height = static_cast<float>(std::nearbyint(height / quantum) * quantum);
}

}  // namespace

HeightField::HeightField(int columns, int rows, double size_x, double size_y, std::vector<float> heights,
                         const std::string& source)
    : columns_(columns), rows_(rows), size_x_(size_x), size_y_(size_y), heights_(std::move(heights)) {
  if (columns < 2)
    throw ConfigError(source, "columns", "at least 2 samples along x", std::to_string(columns));
  if (rows < 2) throw ConfigError(source, "rows", "at least 2 samples along y", std::to_string(rows));
  const std::int64_t count = std::int64_t{columns} * rows;
  if (count > kMaxHeightSamples) {
    throw ConfigError(source, "samples", fmt::format("at most {}", kMaxHeightSamples),
                      fmt::format("{} x {} = {}", columns, rows, count));
  }
  const auto check_size = [&](const char* name, double size) {
    if (!(size > 0) || !std::isfinite(size)) {
      throw ConfigError(source, name, "a positive extent in m", fmt::format("{}", size));
    }
  };
  check_size("size_x", size_x);
  check_size("size_y", size_y);
  if (heights_.size() != static_cast<std::size_t>(count)) {
    throw ConfigError(source, "heights", fmt::format("{} x {} = {} values", columns, rows, count),
                      std::to_string(heights_.size()));
  }
  for (std::size_t i = 0; i < heights_.size(); ++i) {
    if (!std::isfinite(heights_[i])) {
      const auto width = static_cast<std::size_t>(columns);
      throw ConfigError(source, fmt::format("height at column {}, row {}", i % width, i / width),
                        "a finite number of m", fmt::format("{}", heights_[i]));
    }
  }
  quantise(heights_);
  const auto [lowest, highest] = std::minmax_element(heights_.begin(), heights_.end());
  min_ = *lowest;
  max_ = *highest;
  cells_per_x_ = (columns - 1) / size_x;
  cells_per_y_ = (rows - 1) / size_y;
}

bool HeightField::contains(double x, double y) const noexcept {
  return std::abs(x) <= size_x_ / 2 && std::abs(y) <= size_y_ / 2;
}

HeightField::Facet HeightField::facet(double x, double y) const noexcept {
  const double grid_x = clamp_index((x + size_x_ / 2) * cells_per_x_, columns_ - 1);
  const double grid_y = clamp_index((y + size_y_ / 2) * cells_per_y_, rows_ - 1);
  const int column = std::min(static_cast<int>(grid_x), columns_ - 2);
  const int row = std::min(static_cast<int>(grid_y), rows_ - 2);
  const double u = grid_x - column;
  const double v = grid_y - row;
  const double a = at(column, row);
  const double f = at(column + 1, row + 1);
  const bool lower = u >= v;  // the triangle a, b, f; otherwise a, f, e
  const double corner = lower ? at(column + 1, row) : at(column, row + 1);
  const double along_x = lower ? corner - a : f - corner;
  const double along_y = lower ? f - corner : corner - a;
  return {a + u * along_x + v * along_y, along_x * cells_per_x_, along_y * cells_per_y_};
}

double HeightField::height(double x, double y) const noexcept { return facet(x, y).height; }

Vector3 HeightField::normal(double x, double y) const noexcept { return facet(x, y).normal(); }

HeightField::CellRange HeightField::cells_around(const Vector3& centre, double radius) const noexcept {
  const auto column = [&](double x) {
    return static_cast<int>(clamp_index((x + size_x_ / 2) * cells_per_x_, columns_ - 2));
  };
  const auto row = [&](double y) {
    return static_cast<int>(clamp_index((y + size_y_ / 2) * cells_per_y_, rows_ - 2));
  };
  return {column(centre.x() - radius), column(centre.x() + radius), row(centre.y() - radius),
          row(centre.y() + radius)};
}

double HeightField::highest(const CellRange& cells) const noexcept {
  double result = min_;
  for (int r = cells.first_row; r <= cells.last_row + 1; ++r) {
    for (int c = cells.first_column; c <= cells.last_column + 1; ++c) result = std::max(result, at(c, r));
  }
  return result;
}

/// Closest point of the triangles of `cells`, relative to `centre`; of length `radius` when none is nearer.
Vector3 HeightField::closest_point(const Vector3& centre, double radius,
                                   const CellRange& cells) const noexcept {
  Vector3 closest(0, 0, -radius);
  double closest_squared = radius * radius;
  const auto consider = [&](const Vector3& a, const Vector3& b, const Vector3& c) {
    const Vector3 point = closest_on_triangle(a, b, c);
    const double squared = point.squaredNorm();
    if (squared < closest_squared) {
      closest_squared = squared;
      closest = point;
    }
  };
  const double width = cell_x();
  const double depth = cell_y();
  for (int r = cells.first_row; r <= cells.last_row; ++r) {
    const double y = r * depth - size_y_ / 2 - centre.y();
    for (int c = cells.first_column; c <= cells.last_column; ++c) {
      const double x = c * width - size_x_ / 2 - centre.x();
      const Vector3 a(x, y, at(c, r) - centre.z());
      const Vector3 b(x + width, y, at(c + 1, r) - centre.z());
      const Vector3 e(x, y + depth, at(c, r + 1) - centre.z());
      const Vector3 f(x + width, y + depth, at(c + 1, r + 1) - centre.z());
      const double top = std::max(std::max(a.z(), b.z()), std::max(e.z(), f.z()));
      if (top < 0 && top * top >= closest_squared) continue;  // the whole cell lies too far below
      consider(a, b, f);
      consider(a, f, e);
    }
  }
  return closest;
}

bool HeightField::touch_sphere(const Vector3& centre, double radius, SphereContact& contact) const noexcept {
  if (!(centre.z() - radius < max_) || !std::isfinite(centre.z())) return false;
  if (!contains(centre.x(), centre.y())) return false;
  const CellRange cells = cells_around(centre, radius);
  if (centre.z() - radius >= highest(cells)) return false;

  const Facet under = facet(centre.x(), centre.y());
  const double above = centre.z() - under.height;
  Vector3 closest = Vector3::Zero();  // from the centre
  double length = 0;                  // from the surface to the centre, along the normal
  if (above > 0) {
    closest = closest_point(centre, radius, cells);
    length = closest.norm();
    if (length >= radius) return false;
  }
  // Nearer than a nanometre the direction to an edge is rounding error; below the surface there is none.
  const bool along_face = length < 1e-9;
  const Vector3 normal = along_face ? under.normal() : Vector3(-closest / length);
  if (along_face) length = above * normal.z();
  contact.distance = length - radius;
  contact.normal = normal;
  contact.position = centre - normal * ((length + radius) / 2);
  return true;
}

}  // namespace crossgait
