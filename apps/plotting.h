// Pictures of curves, bars and shaded maps, drawn by gnuplot.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace crossgait::apps {

/// x, y in the units of the panel's axes.
using PlotPoint = std::array<double, 2>;

/// One row of a panel's legend.
struct Series {
  enum class Style { kLine, kDashed, kPoints, kLinePoints };
  std::string label;  ///< empty: not in the legend
  std::vector<PlotPoint> points;
  int colour = 0;  ///< of a palette that people with any colour vision tell apart; repeats after kColours
  Style style = Style::kLine;
  double width = 1.6;  ///< of the line, px; points grow with it
};
inline constexpr int kColours = 7;

/// Axis-aligned rectangles of one colour.
struct Bars {
  struct Bar {
    PlotPoint min{}, max{};
  };
  std::string label;
  std::vector<Bar> bars;
  int colour = 0;
  bool filled = true;  ///< else the outline alone
};

/// Values on a regular grid as shades from dark (zero) to bright (high).
struct ShadeMap {
  std::string label;                          ///< of the colour bar, with its unit
  PlotPoint min{}, max{};                     ///< first and last grid point
  std::array<int, 2> count{};                 ///< grid points along x and y, at least 2 each
  std::vector<std::optional<double>> values;  ///< x fastest; nothing is drawn where there is no value
};

/// One pair of axes. Drawn from back to front: shades, bars, series.
struct Panel {
  std::string title, x_label, y_label;
  std::optional<ShadeMap> shades;
  std::vector<Bars> bars;
  std::vector<Series> series;
  bool equal_scales = false;          ///< a metre is as long along y as along x
  bool y_down = false;                ///< y grows downward
  bool x_log = false, y_log = false;  ///< logarithmic; what is not positive is not drawn
  /// Lowest and highest x and y; found from the contents if empty.
  std::optional<PlotPoint> x_range, y_range;
  /// Distance of the tick marks along x; found if zero.
  double x_tics = 0;
  /// Names instead of numbers along y.
  std::vector<std::pair<double, std::string>> y_names;
};

/// Panels in rows from top to bottom; those of a row share its width.
struct Figure {
  struct Row {
    std::vector<Panel> panels;
    int height = 260;         ///< px
    std::size_t columns = 1;  ///< places; some stay free on the right if there are fewer panels
  };
  std::string title;
  std::vector<Row> rows;
  int width = 1200;  ///< px

  std::size_t panel_count() const;
};

/// @param option  that the path was given with, for the message
/// @throws ConfigError unless `path` ends in .svg or .png
void check_plot_path(const std::string& path, const std::string& option);

/// Draws `figure` into `path` (.svg or .png). The file appears whole or not at all.
/// @throws ConfigError as check_plot_path, if gnuplot is not installed or the file cannot be written
/// @throws std::runtime_error with gnuplot's words if it fails
void draw(const Figure& figure, const std::string& path);

}  // namespace crossgait::apps
