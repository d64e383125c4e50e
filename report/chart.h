// Curves, dots, boxes and shaded maps that a page draws over any axis: benchmarks, workspaces, gaits,
// searches.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "report/page_numbers.h"

namespace crossgait {

/// Describes one pair of axes. Drawn from back to front: shades, boxes, paths, then lines and dots.
struct Chart {
  using Point = std::array<double, 2>;  ///< x, y in the units of the axes

  struct Series {
    enum class Style {
      kDots,
      kLine,  ///< dots and a line through them, in the order of x
      kPath,  ///< a line alone, through the points in their own order: it may cross itself
    };
    std::string label;       ///< empty: not in the legend
    std::size_t colour = 0;  ///< of the page's palette; an engine keeps its own throughout
    Style style = Style::kDots;
    std::vector<Point> points;
  };

  /// Holds rectangles of one colour along the axes.
  struct Boxes {
    struct Box {
      Point min{}, max{};
    };
    std::string label;
    std::size_t colour = 0;  ///< as of a series
    bool filled = true;      ///< else the outline alone
    std::vector<Box> boxes;
  };

  /// Shades values on a regular grid, from dark (zero) to bright (the highest of all charts beside it).
  struct Shades {
    std::string label;                          ///< of the scale, with its unit
    Point min{}, max{};                         ///< first and last grid point
    std::array<std::size_t, 2> count{};         ///< grid points along x and y, at least 2 each
    std::vector<std::optional<double>> values;  ///< x fastest; nothing is drawn where there is none
  };

  std::string title, x_label, y_label;  ///< with units
  bool x_log = false, y_log = false;    ///< what is not positive is not drawn then
  bool equal_scales = false;            ///< a metre is as long along y as along x
  /// Instead of numbers along y, which grows downward.
  std::vector<std::pair<double, std::string>> y_names = {};
  std::vector<Series> series = {};
  std::vector<Boxes> boxes = {};
  std::optional<Shades> shades = {};
};

struct Charts {
  std::string title;
  std::vector<Chart> charts;
};

/// Writes keys as the members. `points` are finite numbers alone; `style` is dots, line or path; a box is x
/// and y of its least corner, then of its largest; `values` of shades refer to `numbers`, NaN where there is
/// none; `y_names` are pairs of number and name.
nlohmann::ordered_json to_json(const Charts& charts, PageNumbers& numbers);

}  // namespace crossgait
