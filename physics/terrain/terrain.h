// The ground: an infinite plane z = 0 or a height field, made by name, by generator or from a file.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "physics/terrain/height_field.h"

namespace crossgait {

/// Holds ground that is immutable and cheap to copy: worlds and environments share one height field.
class Terrain {
 public:
  /// Makes the infinite plane z = 0.
  Terrain() = default;
  Terrain(std::string name, std::shared_ptr<const HeightField> field, std::string scale = {})
      : name_(std::move(name)), field_(std::move(field)), scale_(std::move(scale)) {}

  /// Returns the text it was made from.
  const std::string& name() const { return name_; }
  /// Says of a file what its samples were taken to measure, in words, and which of it was given, came from
  /// the file or was assumed. Empty for anything else.
  const std::string& scale() const { return scale_; }
  /// Returns the field, null for the plane.
  const HeightField* field() const { return field_.get(); }

  /// Returns the height that nothing of it exceeds, m.
  double max() const noexcept { return field_ ? field_->max() : 0.0; }
  bool contains(double x, double y) const noexcept { return !field_ || field_->contains(x, y); }
  double height(double x, double y) const noexcept { return field_ ? field_->height(x, y) : 0.0; }
  Vector3 normal(double x, double y) const noexcept {
    return field_ ? field_->normal(x, y) : Vector3::UnitZ();
  }
  /// @copydoc HeightField::touch_sphere
  /// On the plane: distance = centre.z - radius, and a contact where that is negative.
  bool touch_sphere(const Vector3& centre, double radius, SphereContact& contact) const noexcept;

 private:
  std::string name_ = "flat";
  std::shared_ptr<const HeightField> field_;
  std::string scale_;
};

inline constexpr int kRingSize = 8;
/// Samples heights (m) on a circle of `radius` m about (x, y): front, front-right, right, back-right, back,
/// back-left, left, front-left; clockwise seen from above and turned with the robot's yaw (rad): sample k
/// stands at yaw - k pi/4.
std::array<double, kRingSize> sample_ring(const Terrain& terrain, double x, double y, double yaw,
                                          double radius = 0.15) noexcept;

/// Describes one parameter of a terrain generator.
struct TerrainParameter {
  std::string_view name, unit, help;
  double value;        ///< default
  double min, max;     ///< inclusive
  bool whole = false;  ///< takes whole numbers only
};

/// A row of the table describes a generator; `crossgait terrain list` prints it.
struct TerrainGenerator {
  std::string_view name, help;
  std::vector<TerrainParameter> parameters;
};

/// Lists flat, slope, stairs, steps, waves, rough.
const std::vector<TerrainGenerator>& terrain_generators();

/// Makes a terrain from `NAME`, `NAME:key=value,...`, `FILE.png` or `FILE.csv`.
///
/// Generators: see `terrain_generators()`. `seed` feeds those that draw random numbers unless the text itself
/// has `seed=N`; the same text and seed give the same heights on every machine.
///
/// Files also take `:key=value,...`: size_x, size_y (m) and, for PNG, z_min, z_max (m).
/// - PNG of every kind: a sample is a height, linearly from z_min (black) to z_max (white), whatever gamma
/// the
///   file declares; of colours their luminance (Rec. 709) is, and transparency is ignored. The top row of
///   pixels has the largest y, so that the picture is the map seen from above. Without keys the scale comes
///   from the file's own sCAL and pCAL chunks, which `write_png` writes; without those a pixel is 0.025 m
///   wide, z_min = 0, z_max = 0.05 m.
/// - CSV: comma-separated heights in m, no header; the first line has the largest y, as in the picture.
/// Samples stand
///   0.025 m apart unless size_x, size_y are given: CSV carries no scale.
/// `Terrain::scale` says which it was.
/// @throws ConfigError naming the text, key, file, line or column
Terrain make_terrain(std::string_view text, std::uint64_t seed = 0);

/// Tells whether `make_terrain` takes `text` for a file's name, with or without settings behind a colon.
bool is_terrain_file(std::string_view text);

/// Writes 16-bit grey PNG, white = highest, with its scale (pixel size, heights of black and white), so that
/// `make_terrain(path)` gives back the field to half a grey level; the file appears whole or not at all.
/// @throws ConfigError
void write_png(const HeightField& field, const std::string& path);
/// Writes CSV, one line per row, in metres with 9 significant digits: `make_terrain` with the same size_x,
/// size_y gives back the same floats. The file appears whole or not at all. @throws ConfigError
void write_csv(const HeightField& field, const std::string& path);

}  // namespace crossgait
