// Height fields from and to PNG pictures and CSV tables.
#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "physics/core/atomic_file.h"
#include "physics/core/byte_order_mark.h"
#include "physics/core/error.h"
#include "physics/core/text.h"
#include "physics/terrain/grey_png.h"
#include "physics/terrain/terrain_parameters.h"

namespace crossgait {
namespace {

constexpr double kCell = 0.025;   ///< m between samples where neither file nor text says
constexpr double kZMin = 0;       ///< m, likewise
constexpr double kZMax = 0.05;    ///< m, likewise
constexpr double kHighest = 1e4;  ///< m, either way; more is a mistake, not a landscape

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
    result.push_back({"z_min", "m", "height of black", kZMin, -kHighest, kHighest});
    result.push_back({"z_max", "m", "height of white", kZMax, -kHighest, kHighest});
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

/// Lines of a CSV table, appended to `heights` value by value. @throws ConfigError naming line and column
class CsvReader {
 public:
  CsvReader(const std::string& path, std::string_view text)
      : path_(path), rest_(without_byte_order_mark(text)) {
    if (rest_.empty()) throw ConfigError(path_, "line 1", "comma-separated heights in m", "an empty file");
    // As many values as there can be: growing by doubling would need twice the memory.
    const auto commas = std::count(rest_.begin(), rest_.end(), ',');
    const auto lines = std::count(rest_.begin(), rest_.end(), '\n');
    if (commas >= kMaxHeightSamples) {
      throw ConfigError(path_, "file", fmt::format("at most {} values", kMaxHeightSamples), "more");
    }
    heights_.reserve(
        static_cast<std::size_t>(std::min<std::int64_t>(commas + lines + 1, kMaxHeightSamples + 1)));
    while (!rest_.empty()) read_line();
  }

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  /// Row-major, the first line last, as a height field has them. Leaves nothing behind.
  std::vector<float> take_heights() {
    const auto row = [this](int index) { return heights_.begin() + std::ptrdiff_t{index} * columns_; };
    for (int r = 0; r < rows_ / 2; ++r) std::swap_ranges(row(r), row(r + 1), row(rows_ - 1 - r));
    return std::move(heights_);
  }

 private:
  void read_line() {
    const std::size_t end = rest_.find('\n');
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    ++rows_;
    int count = 0;
    while (true) {
      const std::size_t comma = line.find(',');
      heights_.push_back(parse(line.substr(0, comma), ++count));
      if (static_cast<std::int64_t>(heights_.size()) > kMaxHeightSamples) {
        throw ConfigError(path_, fmt::format("line {}", rows_),
                          fmt::format("at most {} values", kMaxHeightSamples), "more");
      }
      if (comma == std::string_view::npos) break;
      line.remove_prefix(comma + 1);
    }
    if (rows_ == 1) columns_ = count;
    if (count != columns_) {
      throw ConfigError(path_, fmt::format("line {}", rows_),
                        fmt::format("{} values, as in line 1", columns_), std::to_string(count));
    }
  }

  float parse(std::string_view cell, int column) const {
    constexpr std::string_view kBlank = " \t";
    std::string_view text = cell.substr(std::min(cell.find_first_not_of(kBlank), cell.size()));
    text = text.substr(0, text.find_last_not_of(kBlank) + 1);
    const std::optional<double> value = parse_number(text);
    if (!value || std::abs(*value) > kHighest) {
      throw ConfigError(path_, fmt::format("line {}, column {}", rows_, column),
                        fmt::format("a height in [{}, {}] m", -kHighest, kHighest),
                        text.empty() ? "nothing" : quoted(text));
    }
    return static_cast<float>(*value);
  }

  const std::string& path_;
  std::string_view rest_;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<float> heights_;
};

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
      kHighest) {  // the file's own scale: keys have been checked
    throw ConfigError(path, "pCAL", fmt::format("heights in [{}, {}] m", -kHighest, kHighest),
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
  const std::string text = read_text_file(path, kTerrainTableBudget);
  CsvReader table(path, text);
  const Measure size_x = extent(values, "size_x", table.columns(), {});
  const Measure size_y = extent(values, "size_y", table.rows(), {});
  auto field = std::make_shared<const HeightField>(table.columns(), table.rows(), size_x.value, size_y.value,
                                                   table.take_heights(), path);
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
