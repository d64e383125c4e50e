#include "apps/bench_page.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "benchmarks/bench.h"

namespace crossgait::apps {
namespace {

using nlohmann::ordered_json;
using Style = Chart::Series::Style;

double number(const ordered_json& record, const char* key) { return record.at(key).get<double>(); }
std::string text(const ordered_json& record, const char* key) { return record.at(key).get<std::string>(); }
/// "rough" of "rough:seed=1": there is one of a kind.
std::string terrain_of(const ordered_json& record) {
  const std::string terrain = text(record, "terrain");
  return terrain.substr(0, terrain.find(':'));
}
/// A key as words.
std::string spaced(std::string key) {
  std::replace(key.begin(), key.end(), '_', ' ');
  return key;
}

/// The engines of a result, each with a colour of its own throughout.
class Engines {
 public:
  explicit Engines(const ordered_json& result) {
    for (const ordered_json& engine : result.at("engines")) names_.push_back(engine.at("name"));
  }
  const std::vector<std::string>& names() const { return names_; }
  std::size_t index(const ordered_json& record) const {
    const auto found = std::find(names_.begin(), names_.end(), text(record, "engine"));
    return static_cast<std::size_t>(found - names_.begin()) % names_.size();
  }

 private:
  std::vector<std::string> names_;
};

/// One series per engine. @param labels  "title", then those of x and y, with units
Chart chart_of(Style style, std::array<std::string, 3> labels, const Engines& engines) {
  Chart chart{
      .title = std::move(labels[0]), .x_label = std::move(labels[1]), .y_label = std::move(labels[2])};
  for (std::size_t i = 0; i < engines.names().size(); ++i)
    chart.series.push_back({engines.names()[i], i, style, {}});
  return chart;
}

/// Dots on a logarithmic axis, one group per label from top to bottom, one line per engine in it. (A bar
/// would have a length that depends on where the axis happens to begin.)
class DotChart {
 public:
  DotChart(std::string title, std::string x_label, const Engines& engines)
      : engines_(engines),
        chart_(chart_of(Style::kDots, {std::move(title), std::move(x_label), ""}, engines)) {
    chart_.x_log = true;
  }

  void add(const std::string& label, const ordered_json& record, double value) {
    auto group = std::find_if(chart_.y_names.begin(), chart_.y_names.end(),
                              [&label](const auto& known) { return known.second == label; });
    if (group == chart_.y_names.end())
      group = chart_.y_names.insert(group, {static_cast<double>(chart_.y_names.size()), label});
    if (!(value > 0)) return;
    const double count = static_cast<double>(engines_.names().size());
    const double place = (static_cast<double>(engines_.index(record)) + 0.5) / count - 0.5;
    chart_.series[engines_.index(record)].points.push_back({value, group->first + 0.6 * place});
  }

  Chart finish() && { return std::move(chart_); }

 private:
  const Engines& engines_;
  Chart chart_;
};

Chart eta_chart(const ordered_json& eta, const Engines& engines) {
  Chart chart{.title = "share of the walk's time that is the engine's (eta)",
              .x_label = "eta, 0 to 1",
              .y_label = ""};
  double row = 0;
  for (std::size_t i = 0; i < engines.names().size(); ++i) {
    Chart::Boxes& bars = chart.boxes.emplace_back(Chart::Boxes{engines.names()[i], i, true, {}});
    for (const ordered_json& r : eta) {
      if (engines.index(r) != i) continue;
      bars.boxes.push_back({{0, row - 0.35}, {number(r, "eta"), row + 0.35}});
      chart.y_names.emplace_back(row, terrain_of(r));
      row += 1;
    }
  }
  return chart;
}

Charts speed_charts(const ordered_json& speed, const Engines& engines) {
  DotChart time("CPU time of a physics step of 1 ms", "us", engines);
  for (const ordered_json& r : speed.at("scenes"))
    time.add(spaced(text(r, "scene")), r, number(r, "us_per_step"));
  Chart threads =
      chart_of(Style::kLine, {"worlds in parallel, trot on the plane", "threads", "physics steps per second"},
               engines);
  for (const ordered_json& r : speed.at("threads"))
    threads.series[engines.index(r)].points.push_back({number(r, "threads"), number(r, "steps_per_second")});
  return {"Speed", {std::move(time).finish(), eta_chart(speed.at("eta"), engines), std::move(threads)}};
}

Charts accuracy_charts(const ordered_json& accuracy, const Engines& engines) {
  std::vector<std::string> terrains;
  for (const ordered_json& p : accuracy.at("points")) {
    if (std::find(terrains.begin(), terrains.end(), terrain_of(p)) == terrains.end())
      terrains.push_back(terrain_of(p));
  }
  Charts charts;
  double longest = 0, shortest = HUGE_VAL;
  for (const std::string& terrain : terrains) {
    const char* cost = "CPU seconds per simulated second";
    Chart base = chart_of(Style::kLine, {"base, trot on " + terrain, cost, "RMS error, m"}, engines);
    Chart joints = chart_of(Style::kLine, {"joints, trot on " + terrain, cost, "RMS error, rad"}, engines);
    base.x_log = base.y_log = joints.x_log = joints.y_log = true;
    for (const ordered_json& p : accuracy.at("points")) {
      if (terrain_of(p) != terrain || p.at("position_error_m").is_null()) continue;
      const std::size_t i = engines.index(p);
      base.series[i].points.push_back({number(p, "cost"), number(p, "position_error_m")});
      joints.series[i].points.push_back({number(p, "cost"), number(p, "joint_error_rad")});
      longest = std::max(longest, number(p, "step_s"));
      shortest = std::min(shortest, number(p, "step_s"));
    }
    charts.charts.push_back(std::move(base));
    charts.charts.push_back(std::move(joints));
  }
  charts.title = fmt::format("Speed against accuracy, steps of {:g} ms (left) to {:g} ms (right)",
                             1e3 * longest, 1e3 * shortest);
  return charts;
}

Charts analytic_charts(const ordered_json& analytic, const Engines& engines) {
  Charts charts{"Errors against closed forms", {}};
  for (const ordered_json& c : analytic.at("convergence")) {
    const std::string quantity = spaced(text(c, "quantity"));
    auto found = std::find_if(charts.charts.begin(), charts.charts.end(),
                              [&quantity](const Chart& chart) { return chart.title == quantity; });
    if (found == charts.charts.end()) {
      Chart chart =
          chart_of(Style::kLine, {quantity, "physics step, ms", "error, " + text(c, "unit")}, engines);
      chart.x_log = chart.y_log = true;
      found = charts.charts.insert(charts.charts.end(), std::move(chart));
    }
    Chart::Series& series = found->series[engines.index(c)];
    for (std::size_t i = 0; i < c.at("step_s").size(); ++i) {
      series.points.push_back(
          {1e3 * c.at("step_s").at(i).get<double>(), std::abs(c.at("error").at(i).get<double>())});
    }
  }
  DotChart creep("sled just inside the friction cone", "creep, m/s", engines);
  DotChart slide("sled just outside the friction cone", "error of its distance, %", engines);
  for (const ordered_json& f : analytic.at("friction")) {
    creep.add(text(f, "ground"), f, number(f, "creep_inside_mps"));
    slide.add(text(f, "ground"), f, 100 * number(f, "distance_error_outside"));
  }
  charts.charts.push_back(std::move(creep).finish());
  charts.charts.push_back(std::move(slide).finish());
  return charts;
}

Charts feet_charts(const ordered_json& feet, const Engines& engines) {
  struct Quantity {
    const char* title;
    const char* unit;
    const char* key;
    double factor;
  };
  constexpr std::array<Quantity, 6> kQuantities{{
      {"creep while standing", "um/s", "creep_mps", 1e6},
      {"penetration while standing", "um", "penetration_m", 1e6},
      {"impulse of a touch-down, first 10 ms", "mN s", "touchdown_impulse_Ns", 1e3},
      {"largest force of a touch-down", "over the robot's weight", "touchdown_peak_over_weight", 1},
      {"slip of a standing foot per stride", "mm", "slip_per_stride_m", 1e3},
      {"toe drag per stride", "mm", "toe_drag_per_stride_m", 1e3},
  }};
  Charts charts{"Feet", {}};
  for (const Quantity& quantity : kQuantities) {
    DotChart chart(quantity.title, quantity.unit, engines);
    for (const ordered_json& c : feet) chart.add(terrain_of(c), c, quantity.factor * number(c, quantity.key));
    charts.charts.push_back(std::move(chart).finish());
  }
  return charts;
}

}  // namespace

ReportPage bench_page(const ordered_json& result) {
  struct Section {
    const char* name;
    Charts (*make)(const ordered_json& section, const Engines& engines);
  };
  constexpr std::array<Section, 4> kSections{{{"speed", speed_charts},
                                              {"accuracy", accuracy_charts},
                                              {"analytic", analytic_charts},
                                              {"feet", feet_charts}}};
  ReportPage page;
  page.title = "Benchmark of the engines";
  const Engines engines(result);
  for (const Section& section : kSections) {
    if (result.contains(section.name)) page.charts.push_back(section.make(result.at(section.name), engines));
  }
  page.texts.push_back(benchmarks::describe_bench(result));
  return page;
}

}  // namespace crossgait::apps
