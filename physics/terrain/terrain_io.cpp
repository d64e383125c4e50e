// Height fields from and to PNG pictures and CSV tables.
#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "physics/core/atomic_file.h"
#include "physics/core/error.h"
#include "physics/core/text.h"
#include "physics/terrain/csv_heights.h"
#include "physics/terrain/grey_png.h"
#include "physics/terrain/terrain_parameters.h"

namespace crossgait {
namespace {

constexpr double kCell = 0.025;  ///< m between samples where neither file nor text says
constexpr double kZMin = 0;      ///< m, likewise
constexpr double kZMax = 0.05;   ///< m, likewise

const std::vector<TerrainParameter>& csv_parameters() {
  static const std::vector<TerrainParameter> table{
      {"size_x", "m", "extent along x", 0, 1e-3, 1e4},
      {"size_y", "m", "extent along y", 0, 1e-3, 1e4},
  };
  return table;
}

const std::vector<TerrainParameter>& png_parameters() {
  static const std::vector<TerrainParameter> table = [] {
    std::vector<TerrainParameter> result = csv_parameters();
    result.push_back({"z_min", "m", "height of black", kZMin, -kHighestSample, kHighestSample});
    result.push_back({"z_max", "m", "height of white", kZMax, -kHighestSample, kHighestSample});
    return result;
  }();
  return table;
}

/// One of the numbers that say what a file's samples measure.
struct Measure {
  double value;        ///< m
  const char* origin;  ///< "given", "from the file" or "assumed"
};

/// As given, else as the file says, else as assumed.
Measure measure(const TerrainValues& values, std::string_view name, const std::optional<double>& file,
                double assumed) {
  if (values.given(name)) return {values[name], "given"};
  return file ? Measure{*file, "from the file"} : Measure{assumed, "assumed"};
}

/// Extent along one direction: as given, or from the number of samples and their distance.
Measure extent(const TerrainValues& values, std::string_view name, int samples,
               const std::optional<double>& file_cell) {
  const auto whole = [samples](double cell) { return (samples - 1) * cell; };
  return measure(values, name, file_cell ? std::optional(whole(*file_cell)) : std::nullopt, whole(kCell));
}

std::string in_words(std::string_view what, const Measure& m) {
  return fmt::format("{} {:.6g} m ({})", what, m.value, m.origin);
}

/// Index of the field's sample in a table whose first line has the largest y.
std::size_t flipped(std::size_t index, int columns, int rows) {
  const auto width = static_cast<std::size_t>(columns);
  return (static_cast<std::size_t>(rows) - 1 - index / width) * width + index % width;
}

}  // namespace

Terrain read_png(const std::string& path, const std::optional<std::string_view>& list,
                 const std::string& name) {
  const TerrainValues values(png_parameters(), list, path);
  const GreyImage image = decode_grey_png(read_text_file(path, kPictureBudget), path);
  const auto& pixel = image.pixel_size;
  const auto& range = image.value_range;
  const auto of = [](const auto& whole, auto member) {
    return whole ? std::optional<double>((*whole).*member) : std::nullopt;
  };
  const Measure size_x = extent(values, "size_x", image.columns, of(pixel, &GreyImage::PixelSize::x));
  const Measure size_y = extent(values, "size_y", image.rows, of(pixel, &GreyImage::PixelSize::y));
  const Measure black = measure(values, "z_min", of(range, &GreyImage::ValueRange::black), kZMin);
  const Measure white = measure(values, "z_max", of(range, &GreyImage::ValueRange::white), kZMax);
  const double z_min = black.value, z_max = white.value;
  if (std::max(std::abs(z_min), std::abs(z_max)) >
      kHighestSample) {  // the file's own scale: keys have been checked
    throw ConfigError(path, "pCAL", fmt::format("heights in [{}, {}] m", -kHighestSample, kHighestSample),
                      fmt::format("{} to {} m", z_min, z_max));
  }
  if (z_min > z_max) {
    throw ConfigError(path, "z_max", fmt::format("at least z_min, {} m", z_min), fmt::format("{} m", z_max));
  }
  std::vector<float> heights(image.samples.size());
  for (std::size_t i = 0; i < heights.size(); ++i) {
    heights[flipped(i, image.columns, image.rows)] =
        static_cast<float>(z_min + (z_max - z_min) * image.samples[i] / image.white);
  }
  auto field = std::make_shared<const HeightField>(image.columns, image.rows, size_x.value, size_y.value,
                                                   std::move(heights), path);
  return {name, std::move(field),
          fmt::format("{}, {}, {}, {}", in_words("size_x", size_x), in_words("size_y", size_y),
                      in_words("z_min (black)", black), in_words("z_max (white)", white))};
}

Terrain read_csv(const std::string& path, const std::optional<std::string_view>& list,
                 const std::string& name) {
  const TerrainValues values(csv_parameters(), list, path);
  CsvHeights table = decode_csv_heights(read_text_file(path, kTerrainTableBudget), path);
  const Measure size_x = extent(values, "size_x", table.columns, {});
  const Measure size_y = extent(values, "size_y", table.rows, {});
  auto field = std::make_shared<const HeightField>(table.columns, table.rows, size_x.value, size_y.value,
                                                   std::move(table.samples), path);
  return {name, std::move(field),
          fmt::format("{}, {}", in_words("size_x", size_x), in_words("size_y", size_y))};
}

void write_png(const HeightField& field, const std::string& path) {
  GreyImage image;
  image.columns = field.columns();
  image.rows = field.rows();
  image.pixel_size = {field.cell_x(), field.cell_y()};
  image.value_range = {field.min(), field.max()};
  const double span = field.max() - field.min();
  const auto heights = field.heights();
  image.samples.resize(heights.size());
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const double part =
        span > 0 ? (heights[flipped(i, field.columns(), field.rows())] - field.min()) / span : 0;
    image.samples[i] = static_cast<std::uint16_t>(std::lround(part * image.white));
  }
  write_file_atomically(path, encode_grey_png(image, path));
}

void write_csv(const HeightField& field, const std::string& path) {
  std::string text;
  for (int r = field.rows() - 1; r >= 0; --r) {
    for (int c = 0; c < field.columns(); ++c) {
      fmt::format_to(std::back_inserter(text), "{}{:.9g}", c == 0 ? "" : ",", field.at(c, r));
    }
    text += '\n';
  }
  write_file_atomically(path, text);
}

}  // namespace crossgait
