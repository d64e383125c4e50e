#include "report/chart.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <nlohmann/json.hpp>

namespace crossgait {
namespace {

using nlohmann::ordered_json;

ordered_json to_json(const Chart& chart) {
  ordered_json series = ordered_json::array();
  for (const Chart::Series& s : chart.series) {
    std::vector<std::array<double, 2>> points;
    std::copy_if(s.points.begin(), s.points.end(), std::back_inserter(points),
                 [](const auto& p) { return std::isfinite(p[0]) && std::isfinite(p[1]); });
    std::stable_sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a[0] < b[0]; });
    series.push_back({{"label", s.label}, {"colour", s.colour}, {"line", s.line}, {"points", points}});
  }
  return {{"title", chart.title},       {"x_label", chart.x_label}, {"y_label", chart.y_label},
          {"x_log", chart.x_log},       {"y_log", chart.y_log},     {"y_names", chart.y_names},
          {"series", std::move(series)}};
}

}  // namespace

ordered_json to_json(const Charts& charts) {
  ordered_json list = ordered_json::array();
  for (const Chart& chart : charts.charts) list.push_back(to_json(chart));
  return {{"title", charts.title}, {"charts", std::move(list)}};
}

}  // namespace crossgait
