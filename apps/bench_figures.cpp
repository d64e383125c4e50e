#include "apps/bench_figures.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/gnuplot.h"
#include "physics/core/atomic_file.h"
#include "physics/core/error.h"

namespace crossgait::apps {
namespace {

using nlohmann::ordered_json;

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
    for (const ordered_json& backend : result.at("backends")) names_.push_back(backend.at("name"));
  }
  const std::vector<std::string>& names() const { return names_; }
  std::size_t index(const ordered_json& record) const {
    const auto found = std::find(names_.begin(), names_.end(), text(record, "backend"));
    return static_cast<std::size_t>(found - names_.begin()) % names_.size();
  }

 private:
  std::vector<std::string> names_;
};

/// Dots on a logarithmic axis, one group per label from top to bottom, one line per engine in it. (A bar
/// would have a length that depends on where the axis happens to begin.)
class DotChart {
 public:
  DotChart(std::string title, std::string x_label, const Engines& engines) : engines_(engines) {
    panel_.title = std::move(title);
    panel_.x_label = std::move(x_label);
    panel_.x_log = true;
    panel_.y_down = true;
    for (std::size_t i = 0; i < engines.names().size(); ++i) {
      panel_.series.push_back({engines.names()[i], {}, static_cast<int>(i), Series::Style::kPoints, kDot});
    }
  }

  void add(const std::string& label, const ordered_json& record, double value) {
    auto group = std::find(labels_.begin(), labels_.end(), label);
    if (group == labels_.end()) group = labels_.insert(group, label);
    const auto y = static_cast<double>(group - labels_.begin());
    if (!(value > 0)) return;
    const double count = static_cast<double>(engines_.names().size());
    const double place = (static_cast<double>(engines_.index(record)) + 0.5) / count - 0.5;
    panel_.series[engines_.index(record)].points.push_back({value, y + 0.6 * place});
    low_ = std::min(low_, value);
    high_ = std::max(high_, value);
  }

  Panel finish() {
    constexpr double kRoom = 1.6;  // beyond the outermost dots
    if (low_ <= high_) panel_.x_range = {low_ / kRoom, high_ * kRoom};
    panel_.y_range = {-0.6, static_cast<double>(labels_.size()) - 0.4};
    for (std::size_t i = 0; i < labels_.size(); ++i) {
      panel_.y_names.emplace_back(static_cast<double>(i), labels_[i]);
    }
    return panel_;
  }

 private:
  static constexpr double kDot = 5;

  const Engines& engines_;
  Panel panel_;
  std::vector<std::string> labels_;
  double low_ = HUGE_VAL, high_ = 0;
};

/// One curve per engine.
Panel curves(std::string title, std::string x_label, std::string y_label, const Engines& engines) {
  Panel panel;
  panel.title = std::move(title);
  panel.x_label = std::move(x_label);
  panel.y_label = std::move(y_label);
  for (std::size_t i = 0; i < engines.names().size(); ++i) {
    // Thinner and thinner: curves that lie on each other stay visible.
    const double width = std::max(1.2, 5 - 1.9 * static_cast<double>(i));
    panel.series.push_back({engines.names()[i], {}, static_cast<int>(i), Series::Style::kLinePoints, width});
  }
  return panel;
}

Figure speed_figure(const ordered_json& speed, const Engines& engines) {
  DotChart time("CPU time of a physics step of 1 ms", "us", engines);
  for (const ordered_json& r : speed.at("scenes"))
    time.add(spaced(text(r, "scene")), r, number(r, "us_per_step"));
  Panel threads =
      curves("worlds in parallel, trot on the plane", "threads", "physics steps per second", engines);
  double most = 1;
  for (const ordered_json& r : speed.at("threads")) {
    threads.series[engines.index(r)].points.push_back({number(r, "threads"), number(r, "steps_per_second")});
    most = std::max(most, number(r, "threads"));
  }
  double highest = 0;
  for (const Series& series : threads.series) {
    for (const PlotPoint& p : series.points) highest = std::max(highest, p[1]);
  }
  threads.x_range = {0, most + 1};
  threads.x_tics = std::ceil(most / 8);
  threads.y_range = {0, 1.1 * highest};
  Panel eta = curves("share of the walk's time that is the engine's (eta)", "", "", engines);
  eta.series.clear();
  eta.y_down = true;
  double row = 0;
  for (std::size_t i = 0; i < engines.names().size(); ++i) {
    Bars bars{engines.names()[i], {}, static_cast<int>(i), true};
    for (const ordered_json& r : speed.at("eta")) {
      if (engines.index(r) != i) continue;
      bars.bars.push_back({{0, row - 0.35}, {number(r, "eta"), row + 0.35}});
      eta.y_names.emplace_back(row, terrain_of(r));
      row += 1;
    }
    eta.bars.push_back(std::move(bars));
  }
  eta.x_range = {0, 1};
  eta.y_range = {-0.6, row - 0.4};
  Figure figure;
  figure.title = "Speed";
  figure.rows = {{{time.finish()}, 440}, {{std::move(eta), std::move(threads)}, 320}};
  return figure;
}

Figure accuracy_figure(const ordered_json& accuracy, const Engines& engines) {
  Figure figure;
  std::vector<std::string> terrains;
  for (const ordered_json& p : accuracy.at("points")) {
    if (std::find(terrains.begin(), terrains.end(), terrain_of(p)) == terrains.end()) {
      terrains.push_back(terrain_of(p));
    }
  }
  double longest = 0, shortest = HUGE_VAL;
  for (const std::string& terrain : terrains) {
    Panel base =
        curves("base, trot on " + terrain, "CPU seconds per simulated second", "RMS error, m", engines);
    Panel joints =
        curves("joints, trot on " + terrain, "CPU seconds per simulated second", "RMS error, rad", engines);
    base.x_log = base.y_log = joints.x_log = joints.y_log = true;
    for (const ordered_json& p : accuracy.at("points")) {
      if (terrain_of(p) != terrain || p.at("position_error_m").is_null()) continue;
      const std::size_t i = engines.index(p);
      base.series[i].points.push_back({number(p, "cost"), number(p, "position_error_m")});
      joints.series[i].points.push_back({number(p, "cost"), number(p, "joint_error_rad")});
      longest = std::max(longest, number(p, "step_s"));
      shortest = std::min(shortest, number(p, "step_s"));
    }
    figure.rows.push_back({{std::move(base), std::move(joints)}, 360});
  }
  figure.title = fmt::format("Speed against accuracy, steps of {:g} ms (left) to {:g} ms (right)",
                             1e3 * longest, 1e3 * shortest);
  return figure;
}

Figure analytic_figure(const ordered_json& analytic, const Engines& engines) {
  Figure figure;
  figure.title = "Errors against closed forms";
  std::vector<Panel> panels;
  for (const ordered_json& c : analytic.at("convergence")) {
    const std::string quantity = spaced(text(c, "quantity"));
    auto found = std::find_if(panels.begin(), panels.end(),
                              [&quantity](const Panel& panel) { return panel.title == quantity; });
    if (found == panels.end()) {
      Panel panel = curves(quantity, "physics step, ms", "error, " + text(c, "unit"), engines);
      panel.x_log = panel.y_log = true;
      found = panels.insert(panels.end(), std::move(panel));
    }
    Series& series = found->series[engines.index(c)];
    for (std::size_t i = 0; i < c.at("step_s").size(); ++i) {
      series.points.push_back(
          {1e3 * c.at("step_s").at(i).get<double>(), std::abs(c.at("error").at(i).get<double>())});
    }
  }
  for (std::size_t i = 0; i < panels.size(); i += 2) {
    Figure::Row row;
    row.height = 320;
    row.columns = 2;
    for (std::size_t k = i; k < std::min(i + 2, panels.size()); ++k) row.panels.push_back(panels[k]);
    figure.rows.push_back(std::move(row));
  }
  DotChart creep("sled just inside the friction cone", "creep, m/s", engines);
  DotChart slide("sled just outside the friction cone", "error of its distance, %", engines);
  for (const ordered_json& f : analytic.at("friction")) {
    creep.add(text(f, "ground"), f, number(f, "creep_inside_mps"));
    slide.add(text(f, "ground"), f, 100 * number(f, "distance_error_outside"));
  }
  figure.rows.push_back({{creep.finish(), slide.finish()}, 260});
  return figure;
}

Figure feet_figure(const ordered_json& feet, const Engines& engines) {
  struct Chart {
    const char* title;
    const char* unit;
    const char* key;
    double factor;
  };
  constexpr std::array<Chart, 6> kCharts{{
      {"creep while standing", "um/s", "creep_mps", 1e6},
      {"penetration while standing", "um", "penetration_m", 1e6},
      {"impulse of a touch-down, first 10 ms", "mN s", "touchdown_impulse_Ns", 1e3},
      {"largest force of a touch-down", "over the robot's weight", "touchdown_peak_over_weight", 1},
      {"slip of a standing foot per stride", "mm", "slip_per_stride_m", 1e3},
      {"drag of a swinging foot per stride", "mm", "drag_per_stride_m", 1e3},
  }};
  Figure figure;
  figure.title = "Feet";
  for (std::size_t i = 0; i < kCharts.size(); i += 2) {
    Figure::Row row;
    row.height = 230;
    for (std::size_t k = i; k < i + 2; ++k) {
      DotChart chart(kCharts[k].title, kCharts[k].unit, engines);
      for (const ordered_json& c : feet) {
        chart.add(terrain_of(c), c, kCharts[k].factor * number(c, kCharts[k].key));
      }
      row.panels.push_back(chart.finish());
    }
    figure.rows.push_back(std::move(row));
  }
  return figure;
}

}  // namespace

void check_bench_figures(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw ConfigError("command line", "--figures", "a folder to write to", error.message());
  check_writable((std::filesystem::path(folder) / "probe").string());
  static_cast<void>(run_gnuplot("set print '-'\nprint 1\n"));
}

std::vector<std::pair<std::string, Figure>> bench_figures(const ordered_json& result) {
  struct Section {
    const char* name;
    Figure (*make)(const ordered_json& section, const Engines& engines);
  };
  constexpr std::array<Section, 4> kSections{{{"speed", speed_figure},
                                              {"accuracy", accuracy_figure},
                                              {"analytic", analytic_figure},
                                              {"feet", feet_figure}}};
  const Engines engines(result);
  std::vector<std::pair<std::string, Figure>> figures;
  for (const Section& section : kSections) {
    if (result.contains(section.name))
      figures.emplace_back(section.name, section.make(result.at(section.name), engines));
  }
  return figures;
}

std::vector<std::string> draw_bench_figures(const ordered_json& result, const std::string& folder,
                                            const std::string& format) {
  check_bench_figures(folder);
  std::vector<std::string> files;
  for (const auto& [name, figure] : bench_figures(result)) {
    files.push_back((std::filesystem::path(folder) / (name + "." + format)).string());
    draw(figure, files.back());
  }
  return files;
}

}  // namespace crossgait::apps
