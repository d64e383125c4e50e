// Curves and dots that a page draws over any axis, as benchmarks have them.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace crossgait {

/// One pair of axes.
struct Chart {
  struct Series {
    std::string label;
    std::size_t colour = 0;                     ///< of the page's palette; an engine keeps its own throughout
    bool line = false;                          ///< through the points, in the order of x
    std::vector<std::array<double, 2>> points;  ///< x, y
  };
  std::string title, x_label, y_label;  ///< with units
  bool x_log = false, y_log = false;    ///< what is not positive is not drawn then
  std::vector<std::pair<double, std::string>> y_names =
      {};  ///< instead of numbers along y, which grows downward
  std::vector<Series> series = {};
};

struct Charts {
  std::string title;
  std::vector<Chart> charts;
};

/// Keys as the members; `points` of finite numbers alone, `y_names` pairs of number and name.
nlohmann::ordered_json to_json(const Charts& charts);

}  // namespace crossgait
