#include "report/chart.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include <nlohmann/json.hpp>

namespace crossgait {
namespace {

using nlohmann::ordered_json;
using Style = Chart::Series::Style;

constexpr std::array<const char*, 3> kStyles{"dots", "line", "path"};

ordered_json to_json(const Chart::Series& series) {
  std::vector<Chart::Point> points;
  std::copy_if(series.points.begin(), series.points.end(), std::back_inserter(points),
               [](const auto& p) { return std::isfinite(p[0]) && std::isfinite(p[1]); });
  if (series.style != Style::kPath)
    std::stable_sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a[0] < b[0]; });
  return {{"label", series.label},
          {"colour", series.colour},
          {"style", kStyles[static_cast<std::size_t>(series.style)]},
          {"points", points}};
}

ordered_json to_json(const Chart::Boxes& boxes) {
  ordered_json list = ordered_json::array();
  for (const auto& [min, max] : boxes.boxes) list.push_back({min[0], min[1], max[0], max[1]});
  return {
      {"label", boxes.label}, {"colour", boxes.colour}, {"filled", boxes.filled}, {"boxes", std::move(list)}};
}

ordered_json to_json(const Chart::Shades& shades, PageNumbers& numbers) {
  std::vector<double> values;
  for (const auto& value : shades.values)
    values.push_back(value.value_or(std::numeric_limits<double>::quiet_NaN()));
  return {{"label", shades.label},
          {"min", shades.min},
          {"max", shades.max},
          {"count", shades.count},
          {"values", numbers.add(values)}};
}

ordered_json to_json(const Chart& chart, PageNumbers& numbers) {
  ordered_json series = ordered_json::array(), boxes = ordered_json::array();
  for (const Chart::Series& s : chart.series) series.push_back(to_json(s));
  for (const Chart::Boxes& b : chart.boxes) boxes.push_back(to_json(b));
  return {{"title", chart.title},
          {"x_label", chart.x_label},
          {"y_label", chart.y_label},
          {"x_log", chart.x_log},
          {"y_log", chart.y_log},
          {"equal_scales", chart.equal_scales},
          {"y_names", chart.y_names},
          {"series", std::move(series)},
          {"boxes", std::move(boxes)},
          {"shades", chart.shades ? to_json(*chart.shades, numbers) : ordered_json()}};
}

}  // namespace

ordered_json to_json(const Charts& charts, PageNumbers& numbers) {
  ordered_json list = ordered_json::array();
  for (const Chart& chart : charts.charts) list.push_back(to_json(chart, numbers));
  return {{"title", charts.title}, {"charts", std::move(list)}};
}

}  // namespace crossgait
