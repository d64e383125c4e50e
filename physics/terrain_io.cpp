// Height fields from and to PNG pictures and CSV tables.
#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "crossgait/physics/atomic_file.h"
#include "crossgait/physics/error.h"
#include "crossgait/physics/grey_png.h"
#include "crossgait/physics/terrain_parameters.h"
#include "crossgait/physics/text.h"

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

/// Extent along one direction: as given, or from the number of samples and their distance.
double extent(const TerrainValues& values, std::string_view name, int samples, double cell) {
  return values.given(name) ? values[name] : (samples - 1) * cell;
}

/// Index of the field's sample in a table whose first line has the largest y.
std::size_t flipped(std::size_t index, int columns, int rows) {
  const auto width = static_cast<std::size_t>(columns);
  return (static_cast<std::size_t>(rows) - 1 - index / width) * width + index % width;
}

/// Lines of a CSV table, appended to `heights` value by value. @throws ConfigError naming line and column
class CsvReader {
 public:
  CsvReader(const std::string& path, std::string_view text) : path_(path), rest_(text) {
    constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";  // spreadsheets write one
    if (rest_.starts_with(kByteOrderMark)) rest_.remove_prefix(kByteOrderMark.size());
    if (rest_.empty()) throw ConfigError(path_, "line 1", "comma-separated heights in m", "an empty file");
    while (!rest_.empty()) read_line();
  }

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  const std::vector<float>& heights() const { return heights_; }

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

HeightField read_png(const std::string& path, const std::optional<std::string_view>& list) {
  const TerrainValues values(png_parameters(), list, path);
  const GreyImage image = decode_grey_png(read_text_file(path), path);
  const GreyImage::PixelSize pixel = image.pixel_size.value_or(GreyImage::PixelSize{kCell, kCell});
  const GreyImage::ValueRange range = image.value_range.value_or(GreyImage::ValueRange{kZMin, kZMax});
  const double z_min = values.given("z_min") ? values["z_min"] : range.black;
  const double z_max = values.given("z_max") ? values["z_max"] : range.white;
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
  return {image.columns,
          image.rows,
          extent(values, "size_x", image.columns, pixel.x),
          extent(values, "size_y", image.rows, pixel.y),
          std::move(heights),
          path};
}

HeightField read_csv(const std::string& path, const std::optional<std::string_view>& list) {
  const TerrainValues values(csv_parameters(), list, path);
  const std::string text = read_text_file(path);
  const CsvReader table(path, text);
  std::vector<float> heights(table.heights().size());
  for (std::size_t i = 0; i < heights.size(); ++i) {
    heights[flipped(i, table.columns(), table.rows())] = table.heights()[i];
  }
  return {table.columns(),
          table.rows(),
          extent(values, "size_x", table.columns(), kCell),
          extent(values, "size_y", table.rows(), kCell),
          std::move(heights),
          path};
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
