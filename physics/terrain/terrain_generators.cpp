// The table of terrain generators: one row holds a name, its parameters and the height it gives to a point.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/error.h"
#include "physics/core/find_row.h"
#include "physics/terrain/terrain_parameters.h"

namespace crossgait {
namespace {

/// Height of (x, y), m.
using HeightFunction = std::function<double(double x, double y)>;

struct Generator {
  TerrainGenerator row;
  HeightFunction (*make)(const TerrainValues& values, std::uint64_t seed);  ///< null: the plane, no field
};

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

/// SplitMix64's finaliser (Steele, Lea, Flood, Fast Splittable Pseudorandom Number Generators, 2014). The
/// standard library's distributions differ between implementations; this does not.
std::uint64_t mix(std::uint64_t bits) {
  bits += 0x9e3779b97f4a7c15U;
  bits = (bits ^ (bits >> 30U)) * 0xbf58476d1ce4e5b9U;
  bits = (bits ^ (bits >> 27U)) * 0x94d049bb133111ebU;
  return bits ^ (bits >> 31U);
}

/// Random bits of a lattice point: of the point and the seed alone, so that a larger field continues a
/// smaller one.
std::uint64_t lattice_bits(std::uint64_t seed, double column, double row) {
  const auto bits = [](double index) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(index)); };
  return mix(mix(mix(seed) ^ bits(column)) ^ bits(row));
}

/// Uniform in [0, 1).
double uniform(std::uint64_t bits) { return static_cast<double>(bits >> 11U) * 0x1p-53; }

/// Factor on the heights at distance r from the origin: 0 within `flat_radius`, smoothly to 1 at twice that.
double start_area(double flat_radius, double r) {
  if (r >= 2 * flat_radius) return 1;
  const double t = std::max(r / flat_radius - 1, 0.0);
  return t * t * (3 - 2 * t);
}

HeightFunction with_start_area(double flat_radius, HeightFunction height) {
  return [flat_radius, height = std::move(height)](double x, double y) {
    return start_area(flat_radius, std::sqrt(x * x + y * y)) * height(x, y);
  };
}

/// A length that the grid must be fine enough to show.
double resolved(const TerrainValues& values, std::string_view name) {
  const double least = 2 * values["cell"];
  if (values[name] < least) {
    throw ConfigError(values.source(), name, fmt::format("at least two cells, {} m", least),
                      fmt::format("{} m", values[name]));
  }
  return values[name];
}

HeightFunction slope(const TerrainValues& values, std::uint64_t /*seed*/) {
  const double rise = std::tan(radians(values["angle"]));
  const double slope_x = rise * std::cos(radians(values["heading"]));
  const double slope_y = rise * std::sin(radians(values["heading"]));
  return with_start_area(values["flat_radius"],
                         [=](double x, double y) { return slope_x * x + slope_y * y; });
}

HeightFunction stairs(const TerrainValues& values, std::uint64_t /*seed*/) {
  const double rise = values["rise"];
  const double run = resolved(values, "run");
  const double count = values["count"];
  const double start = values["start"];
  // The last sample before a tread is still on the tread below: a riser is one cell wide. The nudge keeps
  // rounding from moving the edge of a tread that starts exactly on a sample.
  return [=](double x, double /*y*/) {
    return rise * std::clamp(std::floor((x - start) / run + 1e-9) + 1, 0.0, count);
  };
}

HeightFunction steps(const TerrainValues& values, std::uint64_t seed) {
  const double block = resolved(values, "block");
  const double height = values["height"];
  const double flat_radius = values["flat_radius"];
  return [=](double x, double y) {
    const double column = std::floor(x / block + 1e-9);
    const double row = std::floor(y / block + 1e-9);
    const double centre_x = (column + 0.5) * block;
    const double centre_y = (row + 0.5) * block;
    // Scaled by the block's centre, so that every block is level.
    const double scale = start_area(flat_radius, std::sqrt(centre_x * centre_x + centre_y * centre_y));
    return scale * height * uniform(lattice_bits(seed, column, row));
  };
}

HeightFunction waves(const TerrainValues& values, std::uint64_t /*seed*/) {
  const double amplitude = values["amplitude"];
  const double wave_number = 2 * std::numbers::pi / resolved(values, "wavelength");
  const double k_x = wave_number * std::cos(radians(values["heading"]));
  const double k_y = wave_number * std::sin(radians(values["heading"]));
  return with_start_area(values["flat_radius"],
                         [=](double x, double y) { return amplitude * std::sin(k_x * x + k_y * y); });
}

/// Gradient noise in [-1, 1] with lattice spacing 1, zero at lattice points (Perlin, Improving Noise,
/// SIGGRAPH 2002, in two dimensions). Gradients have length sqrt(2), which puts the extremes, in the middle
/// of a cell, at +-1. Keeps the gradients around the last point: the next one mostly lies in the same cell.
class GradientNoise {
 public:
  explicit GradientNoise(std::uint64_t seed) : seed_(seed) {}

  double operator()(double x, double y) {
    const double column = std::floor(x);
    const double row = std::floor(y);
    if (column != column_ || row != row_) enter(column, row);
    const double u = x - column;
    const double v = y - row;
    const auto corner = [&](int i, int j) {
      const Gradient& gradient = corners_[static_cast<std::size_t>(2 * j + i)];
      return gradient[0] * (u - i) + gradient[1] * (v - j);
    };
    const auto fade = [](double t) { return t * t * t * (t * (t * 6 - 15) + 10); };
    const double low = corner(0, 0) + fade(u) * (corner(1, 0) - corner(0, 0));
    const double high = corner(0, 1) + fade(u) * (corner(1, 1) - corner(0, 1));
    return low + fade(v) * (high - low);
  }

 private:
  using Gradient = std::array<double, 2>;

  void enter(double column, double row) {
    constexpr double kRoot = std::numbers::sqrt2;
    constexpr std::array<Gradient, 8> kGradients{
        {{1, 1}, {1, -1}, {-1, 1}, {-1, -1}, {kRoot, 0}, {-kRoot, 0}, {0, kRoot}, {0, -kRoot}}};
    column_ = column, row_ = row;
    for (int j = 0; j < 2; ++j) {
      for (int i = 0; i < 2; ++i)
        corners_[static_cast<std::size_t>(2 * j + i)] =
            kGradients.at(lattice_bits(seed_, column + i, row + j) >> 61U);
    }
  }

  std::uint64_t seed_;
  double column_ = std::numeric_limits<double>::quiet_NaN(), row_ = column_;  ///< of no cell yet
  std::array<Gradient, 4> corners_{};
};

/// One of the noises that rough ground is a sum of. Each is shifted by its own part of a cell, or all would
/// be zero together on the coarsest lattice.
struct Octave {
  GradientNoise noise;
  double shift_x, shift_y;
  double frequency;  ///< cells per m
  double height;     ///< of the largest octave's
};

Octave make_octave(std::uint64_t seed, int octave, double length) {
  const std::uint64_t own_seed = mix(mix(seed) + static_cast<std::uint64_t>(octave));
  return {GradientNoise(own_seed), uniform(lattice_bits(own_seed, 0.0, 1e9)),
          uniform(lattice_bits(own_seed, 1e9, 0.0)), std::ldexp(1 / length, octave),
          std::ldexp(1.0, -octave)};
}

/// Octaves of halving length and height, scaled so that their sum stays within +-amplitude.
HeightFunction rough(const TerrainValues& values, std::uint64_t seed) {
  const double length = resolved(values, "length");
  const int count = static_cast<int>(values["octaves"]);
  const double amplitude = values["amplitude"] / (2 - std::ldexp(2.0, -count));
  std::vector<Octave> octaves;
  octaves.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) octaves.push_back(make_octave(seed, i, length));
  return with_start_area(
      values["flat_radius"], [amplitude, octaves = std::move(octaves)](double x, double y) mutable {
        double sum = 0;
        for (Octave& o : octaves)
          sum += o.height * o.noise(x * o.frequency + o.shift_x, y * o.frequency + o.shift_y);
        return amplitude * sum;
      });
}

/// The parameters of one generator, followed by those of the grid that every field has.
std::vector<TerrainParameter> on_grid(std::vector<TerrainParameter> parameters) {
  // 16 m by 4 m about the origin: 60 s at 0.1 m/s stay on it with room for a curved path.
  parameters.push_back({"size_x", "m", "extent along x", 16, 0.1, 200});
  parameters.push_back({"size_y", "m", "extent along y", 4, 0.1, 200});
  parameters.push_back({"cell", "m", "largest distance of samples", 0.025, 0.001, 1});
  return parameters;
}

TerrainParameter flat_radius(double value) {
  return {"flat_radius", "m", "level start area about the origin, blended in up to twice this", value, 0, 10};
}

TerrainParameter seed_parameter() {
  return {"seed", "", "of the random numbers; without it the seed of the run", 0, 0, 0x1p53 - 1, true};
}

const std::vector<Generator>& generators() {
  static const std::vector<Generator> table{
      {{"flat", "the infinite plane z = 0", {}}, nullptr},
      {{"slope", "an inclined plane through the origin",
        on_grid({{"angle", "deg", "inclination", 5, -45, 45},
                 {"heading", "deg", "direction it climbs in, from +x towards +y", 0, -360, 360},
                 flat_radius(0)})},
       slope},
      {{"stairs", "a staircase along +x that ends in a plateau",
        on_grid({{"rise", "m", "height of a step; negative goes down", 0.01, -0.5, 0.5},
                 {"run", "m", "depth of a step", 0.2, 0.01, 10},
                 {"count", "", "number of steps", 10, 1, 1000, true},
                 {"start", "m", "x of the first step; level ground before it", 0.3, 0, 100}})},
       stairs},
      {{"steps", "level square blocks of random heights",
        on_grid({{"height", "m", "of the highest block over the lowest", 0.01, 0, 0.5},
                 {"block", "m", "side of a block", 0.1, 0.01, 10},
                 flat_radius(0.1),
                 seed_parameter()})},
       steps},
      {{"waves", "a sine wave",
        on_grid({{"amplitude", "m", "crest over the mean", 0.01, 0, 0.5},
                 {"wavelength", "m", "crest to crest", 0.4, 0.01, 100},
                 {"heading", "deg", "direction across the crests, from +x towards +y", 0, -360, 360},
                 flat_radius(0.1)})},
       waves},
      {{"rough", "Perlin noise",
        on_grid(
            {{"amplitude", "m", "bound of the heights about zero", 0.01, 0, 0.5},
             {"length", "m", "size of the largest bumps", 0.15, 0.01, 10},
             {"octaves", "", "layers, each of half the length and height of the one before", 3, 1, 8, true},
             flat_radius(0.1),
             seed_parameter()})},
       rough},
  };
  return table;
}

HeightField build(const TerrainValues& values, const HeightFunction& height) {
  const double size_x = values["size_x"];
  const double size_y = values["size_y"];
  // As many whole cells as `cell` needs; the nudge keeps rounding from adding one more.
  const auto cells = [&](double size) {
    return static_cast<int>(std::max(1.0, std::ceil(size / values["cell"] - 1e-9)));
  };
  const int columns = cells(size_x) + 1;
  const int rows = cells(size_y) + 1;
  const std::int64_t count = std::int64_t{columns} * rows;
  if (count > kMaxHeightSamples) {  // before the work, not after it
    throw ConfigError(values.source(), "cell",
                      fmt::format("at most {} samples on the terrain", kMaxHeightSamples),
                      fmt::format("{} m, {} x {} samples", values["cell"], columns, rows));
  }
  const double cell_x = size_x / (columns - 1);
  const double cell_y = size_y / (rows - 1);
  std::vector<float> heights;
  heights.reserve(static_cast<std::size_t>(count));
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      heights.push_back(static_cast<float>(height(c * cell_x - size_x / 2, r * cell_y - size_y / 2)));
    }
  }
  return {columns, rows, size_x, size_y, std::move(heights), values.source()};
}

}  // namespace

const std::vector<TerrainGenerator>& terrain_generators() {
  static const std::vector<TerrainGenerator> rows = [] {
    std::vector<TerrainGenerator> result;
    for (const Generator& generator : generators()) result.push_back(generator.row);
    return result;
  }();
  return rows;
}

std::shared_ptr<const HeightField> generate_terrain(std::string_view name,
                                                    const std::optional<std::string_view>& list,
                                                    const std::string& source, std::uint64_t seed) {
  const Generator& generator = find_row(
      generators(), name, source, "name", [](const Generator& row) { return row.row.name; },
      ", FILE.png or FILE.csv");
  const TerrainValues values(generator.row.parameters, list, source);
  if (!generator.make) return nullptr;
  const std::uint64_t own_seed = values.given("seed") ? static_cast<std::uint64_t>(values["seed"]) : seed;
  return std::make_shared<HeightField>(build(values, generator.make(values, own_seed)));
}

}  // namespace crossgait
