#include "apps/gait_page.h"

#include <fmt/format.h>

#include "gait/parameters.h"

namespace crossgait::apps {
namespace {

using Style = Chart::Series::Style;

constexpr double kToMillimetres = 1e3;
constexpr const char* kForward = "x forward in the leg frame, mm";
constexpr const char* kUp = "z up from hips or shoulders, mm";
constexpr std::size_t kStanceColour = 4, kPathColour = 4, kGroundColour = 1;  // of the page's palette

/// Where the feet are to be, sample by sample.
struct Targets {
  std::vector<double> time;  // s
  std::vector<LegArray<FootTarget>> feet;
};

Targets targets_of(GaitGenerator generator, double dt, int samples) {
  Targets targets{{0}, {generator.targets()}};
  for (int i = 1; i <= samples; ++i) {
    targets.time.push_back(i * dt);
    targets.feet.push_back(generator.update(dt));
  }
  return targets;
}

/// A bar for every stance, a line per leg.
Chart steps(const Targets& targets) {
  constexpr double kHalf = 0.35;  // of a bar's width, in legs
  Chart chart{.title = "Feet that are meant to stand", .x_label = "time, s", .y_label = ""};
  Chart::Boxes stances{"stance", kStanceColour, true, {}};
  for (const Leg leg : kLegs) {
    const double row = static_cast<double>(index(leg));
    chart.y_names.emplace_back(row, name(leg));
    // The whole time belongs to the axis, also where every foot is in the air.
    chart.series.push_back({"", kStanceColour, Style::kPath, {{0, row}, {targets.time.back(), row}}});
    for (std::size_t i = 0; i + 1 < targets.time.size(); ++i) {
      if (targets.feet[i][leg].swing) continue;
      const bool goes_on = i > 0 && !targets.feet[i - 1][leg].swing;
      if (!goes_on) stances.boxes.push_back({{targets.time[i], row - kHalf}, {targets.time[i], row + kHalf}});
      stances.boxes.back().max[0] = targets.time[i + 1];
    }
  }
  chart.boxes.push_back(std::move(stances));
  return chart;
}

Chart path(const Targets& targets, Leg leg) {
  Chart chart{.title = fmt::format("Foot {} from the side", name(leg)),
              .x_label = kForward,
              .y_label = kUp,
              .equal_scales = true};
  Chart::Series path{"path", kPathColour, Style::kPath, {}},
      ground{"stance", kGroundColour, Style::kDots, {}};
  for (const LegArray<FootTarget>& feet : targets.feet) {
    const Vector3 p = kToMillimetres * feet[leg].position;
    path.points.push_back({p.x(), p.z()});
    if (!feet[leg].swing) ground.points.push_back({p.x(), p.z()});
  }
  chart.series = {std::move(path), std::move(ground)};
  return chart;
}

/// One coordinate of all feet.
Chart over_time(const Targets& targets, Eigen::Index axis, const char* title, const char* label) {
  Chart chart{.title = title, .x_label = "time, s", .y_label = label};
  for (const Leg leg : kLegs) {
    Chart::Series series{std::string(name(leg)), index(leg), Style::kPath, {}};
    for (std::size_t i = 0; i < targets.time.size(); ++i)
      series.points.push_back({targets.time[i], kToMillimetres * targets.feet[i][leg].position[axis]});
    chart.series.push_back(std::move(series));
  }
  return chart;
}

Table parameters_of(const GaitParameters& parameters, const std::string& gait) {
  Table table({"parameter", "unit", gait});
  for (const ParameterRow& row : gait_parameters())
    table.add_row(
        {std::string(row.name), std::string(row.unit), fmt::format("{:.4g}", parameters.*row.member)});
  table.add_row({"swing", "", std::string(name(parameters.swing))});
  return table;
}

}  // namespace

ReportPage gait_page(const std::string& gait, GaitGenerator generator, double dt, int samples) {
  ReportPage page;
  page.title = fmt::format("Gait {}: where the feet are to be", gait);
  page.tables.push_back({parameters_of(generator.parameters(), gait)});
  for (const GaitPhase& phase : generator.gait().phases) {
    if (phase.name.empty()) break;
    page.sentences.push_back(fmt::format("Phase {} begins at {:g} of the cycle.", phase.name, phase.start));
  }
  const Targets targets = targets_of(std::move(generator), dt, samples);
  page.charts.push_back({"Steps", {steps(targets)}});
  Charts& paths = page.charts.emplace_back(Charts{"Paths of the feet", {}});
  for (const Leg leg : kLegs) paths.charts.push_back(path(targets, leg));
  page.charts.push_back({"Targets over time",
                         {over_time(targets, 0, "Feet forward", kForward),
                          over_time(targets, 1, "Feet to the left", "y left in the leg frame, mm"),
                          over_time(targets, 2, "Feet up", kUp)}});
  return page;
}

}  // namespace crossgait::apps
