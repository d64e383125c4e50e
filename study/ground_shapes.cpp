#include "study/ground_shapes.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/robot_files/mesh/convex_hull.h"

namespace crossgait {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();
constexpr double kOnBorder = 1e-9;     // m: what stands on a border is on it
constexpr double kSmallestGap = 1e-3;  // m: parts that are nearer are one
constexpr double kMostLooks = 2e7;     // samples under shapes, each as often as there are: a second

using MaybeHeights = std::optional<HeightRange>;

MaybeHeights common_part(const MaybeHeights& a, const MaybeHeights& b) {
  if (!a || !b) return std::nullopt;
  const HeightRange common{std::max(a->bottom, b->bottom), std::min(a->top, b->top)};
  return common.bottom <= common.top ? MaybeHeights(common) : std::nullopt;
}

MaybeHeights joined(const MaybeHeights& a, const MaybeHeights& b) {
  if (!a || !b) return a ? a : b;
  return HeightRange{std::min(a->bottom, b->bottom), std::max(a->top, b->top)};
}

/// Where a s^2 + 2 b s + c <= 0.
MaybeHeights below_zero(double a, double b, double c) {
  if (std::abs(a) < kOnBorder) return c <= kOnBorder ? MaybeHeights(HeightRange()) : std::nullopt;
  const double root = b * b - a * c;
  if (root < 0) return std::nullopt;
  return HeightRange{(-b - std::sqrt(root)) / a, (-b + std::sqrt(root)) / a};
}

/// Where |p + s d| <= h.
MaybeHeights within(double p, double d, double h) {
  if (std::abs(d) < kOnBorder)
    return std::abs(p) <= h + kOnBorder ? MaybeHeights(HeightRange()) : std::nullopt;
  const double s = (-h - p) / d, t = (h - p) / d;
  return HeightRange{std::min(s, t), std::max(s, t)};
}

/// The vertical line over a point, in the frame of a shape: p + s d is at the world's z = s.
struct Line {
  Vector3 p, d;
  Line(const Pose& X_WG, double x, double y)
      : p(X_WG.linear().transpose() * (Vector3(x, y, 0) - X_WG.translation())),
        d(X_WG.linear().transpose() * Vector3::UnitZ()) {}
};

MaybeHeights through_sphere(const Line& line, double radius, double z) {
  const Vector3 p = line.p - Vector3(0, 0, z);
  return below_zero(1, p.dot(line.d), p.squaredNorm() - radius * radius);
}

MaybeHeights through_cylinder(const Line& line, double radius, double half_length) {
  const double a = line.d.head<2>().squaredNorm(), b = line.p.head<2>().dot(line.d.head<2>());
  return common_part(below_zero(a, b, line.p.head<2>().squaredNorm() - radius * radius),
                     within(line.p.z(), line.d.z(), half_length));
}

MaybeHeights through_box(const Line& line, const Vector3& half) {
  MaybeHeights inside = HeightRange();
  for (int i = 0; i < 3; ++i) inside = common_part(inside, within(line.p[i], line.d[i], half[i]));
  return inside;
}

/// Every plane through three corners that has all others on one side: for as few corners as kMeshCorners.
std::vector<HalfSpace> faces_of(const std::vector<Vector3>& corners) {
  std::vector<HalfSpace> faces;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    for (std::size_t j = i + 1; j < corners.size(); ++j) {
      for (std::size_t k = j + 1; k < corners.size(); ++k) {
        const Vector3 n = (corners[j] - corners[i]).cross(corners[k] - corners[i]);
        if (n.norm() < kOnBorder * kOnBorder) continue;
        for (const double sign : {1.0, -1.0}) {
          const HalfSpace face{sign * n.normalized(), sign * n.normalized().dot(corners[i])};
          if (std::ranges::all_of(corners,
                                  [&](const Vector3& p) { return face.n.dot(p) <= face.d + kOnBorder; }))
            faces.push_back(face);
        }
      }
    }
  }
  return faces;
}

/// In the world's frame.
MaybeHeights through_hull(const std::vector<HalfSpace>& faces, double x, double y) {
  HeightRange inside;
  for (const HalfSpace& face : faces) {
    const double rest = face.d - face.n.x() * x - face.n.y() * y;
    if (std::abs(face.n.z()) < kOnBorder) {
      if (rest < -kOnBorder) return std::nullopt;
    } else if (face.n.z() > 0) {
      inside.top = std::min(inside.top, rest / face.n.z());
    } else {
      inside.bottom = std::max(inside.bottom, rest / face.n.z());
    }
  }
  return inside.bottom <= inside.top + kOnBorder ? MaybeHeights(inside) : std::nullopt;
}

}  // namespace

bool GroundShapes::add_plane(const Pose& X_WG) {
  const Vector3 n = X_WG.linear().col(2);
  if (n.z() < kOnBorder) return false;
  planes_.push_back({n, n.dot(X_WG.translation())});
  return true;
}

void GroundShapes::add(const Pose& X_WG, const Vector3& half,
                       std::function<MaybeHeights(double, double)> over) {
  const Vector3 reach = X_WG.linear().cwiseAbs() * half, centre = X_WG.translation();
  solids_.push_back({centre.x() - reach.x(), centre.x() + reach.x(), centre.y() - reach.y(),
                     centre.y() + reach.y(), std::move(over)});
}

void GroundShapes::add_sphere(const Pose& X_WG, double radius) {
  add(X_WG, Vector3::Constant(radius),
      [=](double x, double y) { return through_sphere(Line(X_WG, x, y), radius, 0); });
}

void GroundShapes::add_cylinder(const Pose& X_WG, double radius, double half_length) {
  add(X_WG, {radius, radius, half_length},
      [=](double x, double y) { return through_cylinder(Line(X_WG, x, y), radius, half_length); });
}

void GroundShapes::add_capsule(const Pose& X_WG, double radius, double half_length) {
  add(X_WG, {radius, radius, radius + half_length}, [=](double x, double y) {
    const Line line(X_WG, x, y);
    return joined(
        through_cylinder(line, radius, half_length),
        joined(through_sphere(line, radius, half_length), through_sphere(line, radius, -half_length)));
  });
}

void GroundShapes::add_box(const Pose& X_WG, const Vector3& half) {
  add(X_WG, half, [=](double x, double y) { return through_box(Line(X_WG, x, y), half); });
}

bool GroundShapes::add_hull(const std::vector<Vector3>& vertices) {
  const ConvexHull hull = convex_hull(vertices, kMeshCorners);
  Vector3 low = hull.vertices.front(), high = low;
  for (const Vector3& v : hull.vertices) low = low.cwiseMin(v), high = high.cwiseMax(v);
  solids_.push_back(
      {low.x(), high.x(), low.y(), high.y(),
       [faces = faces_of(hull.vertices)](double x, double y) { return through_hull(faces, x, y); }});
  return hull.error <= kSmallestGap;
}

bool GroundShapes::add_field(GroundField field, const Pose& X_WG) {
  if (X_WG.linear()(2, 2) < 1 - kOnBorder) return false;
  const auto ground = std::make_shared<const GroundField>(std::move(field));
  const double x = ground->field.size_x() / 2, y = ground->field.size_y() / 2;
  add(X_WG, {x, y, 0}, [=](double px, double py) -> MaybeHeights {
    // On the border is on it, whatever turning it there rounded to.
    const Vector3 p = X_WG.linear().transpose() * (Vector3(px, py, 0) - X_WG.translation());
    if (std::abs(p.x()) > x + kOnBorder || std::abs(p.y()) > y + kOnBorder) return std::nullopt;
    const double z = X_WG.translation().z();
    return HeightRange{z - ground->base, z + ground->field.height(p.x(), p.y())};
  });
  return true;
}

SceneTerrain GroundShapes::sample(double cell, std::vector<std::string> warnings) {
  double x = 0, y = 0;
  for (const Solid& solid : solids_) {
    x = std::max({x, std::abs(solid.x_min), std::abs(solid.x_max)});
    y = std::max({y, std::abs(solid.y_min), std::abs(solid.y_max)});
  }
  if (solids_.empty())
    throw ConfigError(path_, "world", "shapes that are fixed to the world, beside a plane", "none");
  const double half_columns = std::max(1.0, std::ceil(x / cell - kOnBorder)),
               half_rows = std::max(1.0, std::ceil(y / cell - kOnBorder));
  if ((2 * half_columns + 1) * (2 * half_rows + 1) > static_cast<double>(kMaxHeightSamples))
    throw ConfigError(path_, "cell", fmt::format("at most {} samples, so larger cells", kMaxHeightSamples),
                      fmt::format("cells of {:g} m over {:g} x {:g} m", cell, 2 * x, 2 * y));
  double looks = 0;
  for (const Solid& solid : solids_)
    looks += ((solid.x_max - solid.x_min) / cell + 1) * ((solid.y_max - solid.y_min) / cell + 1);
  if (looks > kMostLooks)
    throw ConfigError(path_, "cell",
                      fmt::format("at most {:g} samples under shapes together, so larger cells", kMostLooks),
                      fmt::format("{:.3g}", looks));
  const int columns = 2 * static_cast<int>(half_columns) + 1, rows = 2 * static_cast<int>(half_rows) + 1;
  std::vector<float> heights;
  heights.reserve(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  for (int r = 0; r < rows; ++r) sample_row((r - half_rows) * cell, cell, columns, heights);
  return finish(columns, rows, cell, std::move(heights), std::move(warnings));
}

void GroundShapes::sample_row(double y, double cell, int columns, std::vector<float>& heights) {
  std::vector<std::vector<HeightRange>> over(static_cast<std::size_t>(columns));
  const double first = -0.5 * (columns - 1) * cell;
  for (const Solid& solid : solids_) {
    if (y < solid.y_min - kOnBorder || y > solid.y_max + kOnBorder) continue;
    const int from = std::max(0, static_cast<int>(std::floor((solid.x_min - first) / cell)));
    const int to = std::min(columns - 1, static_cast<int>(std::ceil((solid.x_max - first) / cell)));
    for (int c = from; c <= to; ++c)
      if (const auto heights_here = solid.over(first + c * cell, y))
        over[static_cast<std::size_t>(c)].push_back(*heights_here);
  }
  for (int c = 0; c < columns; ++c) {
    std::vector<HeightRange>& here = over[static_cast<std::size_t>(c)];
    for (const HalfSpace& plane : planes_)
      here.push_back(
          {-kUnbounded, (plane.d - plane.n.x() * (first + c * cell) - plane.n.y() * y) / plane.n.z()});
    heights.push_back(height_of(here));
  }
}

/// The top of what is there, NaN where there is nothing; counts a gap below it.
float GroundShapes::height_of(std::vector<HeightRange>& here) {
  if (here.empty()) return std::numeric_limits<float>::quiet_NaN();
  std::ranges::sort(here, std::ranges::greater{}, &HeightRange::top);
  double bottom = here.front().bottom;
  for (const HeightRange& next : here) {
    if (next.top < bottom - kSmallestGap) {
      ++overhangs_;
      break;
    }
    bottom = std::min(bottom, next.bottom);
  }
  return static_cast<float>(here.front().top);
}

SceneTerrain GroundShapes::finish(int columns, int rows, double cell, std::vector<float> heights,
                                  std::vector<std::string> warnings) const {
  float lowest = std::numeric_limits<float>::infinity();
  std::size_t empty = 0;
  for (const float h : heights) {
    if (std::isnan(h)) {
      ++empty;
    } else {
      lowest = std::min(lowest, h);
    }
  }
  for (float& h : heights) h = std::isnan(h) ? lowest : h;
  const auto count = static_cast<double>(heights.size());
  SceneTerrain scene;
  scene.overhang_ratio = static_cast<double>(overhangs_) / count;
  scene.warnings = std::move(warnings);
  if (empty > 0)
    scene.warnings.push_back(
        fmt::format("{:.3g} % of the samples have nothing below them: they are as high as the lowest of "
                    "the others, {:g} m",
                    100 * static_cast<double>(empty) / count, lowest));
  if (overhangs_ > 0)
    scene.warnings.push_back(
        fmt::format("{:.3g} % of the samples overhang: there is air below the surface, and ground again "
                    "further down; a height field is filled there",
                    100 * scene.overhang_ratio));
  scene.field = std::make_shared<const HeightField>(columns, rows, (columns - 1) * cell, (rows - 1) * cell,
                                                    std::move(heights), path_);
  return scene;
}

}  // namespace crossgait
