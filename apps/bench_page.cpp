#include "apps/bench_page.h"

#include <nlohmann/json.hpp>

#include "apps/bench_figures.h"
#include "benchmarks/bench.h"

namespace crossgait::apps {
namespace {

Chart chart_of(const Panel& panel) {
  Chart chart{.title = panel.title,
              .x_label = panel.x_label,
              .y_label = panel.y_label,
              .x_log = panel.x_log,
              .y_log = panel.y_log,
              .y_names = panel.y_names};
  for (const Series& series : panel.series) {
    chart.series.push_back({series.label, static_cast<std::size_t>(series.colour),
                            series.style != Series::Style::kPoints, series.points});
  }
  for (const Bars& bars : panel.bars) {
    Chart::Series& ends = chart.series.emplace_back(
        Chart::Series{bars.label, static_cast<std::size_t>(bars.colour), false, {}});
    for (const Bars::Bar& bar : bars.bars) ends.points.push_back({bar.max[0], (bar.min[1] + bar.max[1]) / 2});
  }
  return chart;
}

}  // namespace

ReportPage bench_page(const nlohmann::ordered_json& result) {
  ReportPage page;
  page.title = "Benchmark of the engines";
  for (const auto& [name, figure] : bench_figures(result)) {
    Charts& charts = page.charts.emplace_back(Charts{figure.title, {}});
    for (const Figure::Row& row : figure.rows) {
      for (const Panel& panel : row.panels) charts.charts.push_back(chart_of(panel));
    }
  }
  page.texts.push_back(benchmarks::describe_bench(result));
  return page;
}

}  // namespace crossgait::apps
