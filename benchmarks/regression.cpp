#include "benchmarks/regression.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "physics/core/error.h"
#include "physics/core/table.h"

namespace crossgait::benchmarks {
namespace {

using nlohmann::ordered_json;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Differences below these come from the rounding of sums and not from a change.
constexpr double kLengthFloor = 1e-9, kRelativeFloor = 1e-6;

double magnitude(const ordered_json& record, const char* key) {
  const ordered_json& value = record.at(key);
  return value.is_null() ? kInfinity : std::abs(value.get<double>());
}

std::string text(const ordered_json& record, const char* key) { return record.at(key).get<std::string>(); }

using Figures = std::vector<Figure>;

void add_speed(const ordered_json& speed, const std::string& base, Figures& figures) {
  for (const ordered_json& r : speed.at("scenes")) {
    if (r.at("engine") == base) continue;
    figures.push_back(
        {fmt::format("speed, {}: time of {} over {}", text(r, "scene"), text(r, "engine"), base),
         magnitude(r, "ratio"), 0});
  }
  for (const ordered_json& r : speed.at("eta")) {
    figures.push_back(
        {fmt::format("speed, walk on {}: time over that of {} alone", text(r, "terrain"), text(r, "engine")),
         1 / magnitude(r, "eta"), 0});
  }
  for (const ordered_json& r : speed.at("threads")) {
    const int threads = r.at("threads");
    if (threads == 1) continue;
    figures.push_back({fmt::format("speed, {} on {} threads: 1 / efficiency", text(r, "engine"), threads),
                       1 / magnitude(r, "efficiency"), 0});
  }
}

void add_accuracy(const ordered_json& accuracy, const std::string& base, Figures& figures) {
  const auto setting = [](const ordered_json& p) {
    return fmt::format("{}, {:g} ms", text(p, "terrain"), 1e3 * p.at("step_s").get<double>());
  };
  for (const ordered_json& p : accuracy.at("points")) {
    const std::string at = setting(p), engine = text(p, "engine");
    figures.push_back({fmt::format("accuracy, {}: base of {}, m", at, engine),
                       magnitude(p, "position_error_m"), kLengthFloor});
    figures.push_back({fmt::format("accuracy, {}: joints of {}, rad", at, engine),
                       magnitude(p, "joint_error_rad"), kRelativeFloor});
    if (engine != base) {
      figures.push_back(
          {fmt::format("accuracy, {}: time of {} over {}", at, engine, base), magnitude(p, "cost_ratio"), 0});
    }
  }
  for (const ordered_json& s : accuracy.at("stable_steps")) {
    const double largest = magnitude(s, "largest_s");
    figures.push_back({fmt::format("accuracy, {}: 1 / largest stable step of {}, 1/s", text(s, "terrain"),
                                   text(s, "engine")),
                       std::isinf(largest) ? kInfinity : 1 / largest, 0});
  }
}

void add_rebound(const ordered_json& rebound, Figures& figures) {
  for (const ordered_json& r : rebound) {
    figures.push_back({fmt::format("analytic, rebound in {} at {:g} ms", text(r, "engine"),
                                   1e3 * r.at("step_s").get<double>()),
                       magnitude(r, "share_of_speed"), kRelativeFloor});
  }
}

void add_analytic(const ordered_json& analytic, Figures& figures) {
  for (const ordered_json& c : analytic.at("convergence")) {
    for (std::size_t i = 0; i < c.at("step_s").size(); ++i) {
      figures.push_back({fmt::format("analytic, {} of {} at {:g} ms", text(c, "quantity"), text(c, "engine"),
                                     1e3 * c.at("step_s").at(i).get<double>()),
                         std::abs(c.at("error").at(i).get<double>()), kLengthFloor});
    }
  }
  for (const ordered_json& f : analytic.at("friction")) {
    const std::string where = fmt::format("friction on the {} in {}", text(f, "ground"), text(f, "engine"));
    figures.push_back(
        {"analytic, " + where + ": creep, m/s", magnitude(f, "creep_inside_mps"), kLengthFloor});
    figures.push_back(
        {"analytic, " + where + ": distance", magnitude(f, "distance_error_outside"), kRelativeFloor});
    figures.push_back(
        {"analytic, " + where + ": range over headings", magnitude(f, "range_over_headings"), 1e-4});
  }
  if (analytic.contains("rebound")) add_rebound(analytic.at("rebound"), figures);
}

void add_feet(const ordered_json& feet, Figures& figures) {
  struct Column {
    const char* name;
    const char* key;
    double floor;
  };
  constexpr std::array<Column, 8> kColumns{{
      {"creep, m/s", "creep_mps", kLengthFloor},
      {"penetration, m", "penetration_m", kLengthFloor},
      {"force over weight - 1", "force_error", kRelativeFloor},
      {"touch-down impulse, N s", "touchdown_impulse_Ns", 0},
      {"touch-down peak over weight", "touchdown_peak_over_weight", 0},
      {"slip per stride, m", "slip_per_stride_m", kLengthFloor},
      {"toe drag per stride, m", "toe_drag_per_stride_m", kLengthFloor},
      {"deepest penetration, m", "deepest_penetration_m", kLengthFloor},
  }};
  for (const ordered_json& c : feet) {
    for (const Column& column : kColumns) {
      figures.push_back({fmt::format("feet, {}, {:g} s, {} strides, {}: {}", text(c, "terrain"),
                                     c.at("stand_seconds").get<double>(), c.at("strides").get<int>(),
                                     text(c, "engine"), column.name),
                         magnitude(c, column.key), column.floor});
    }
  }
}

// "speed, trot_flat: ..." is of the section "speed".
std::string section_of(const std::string& name) { return name.substr(0, name.find(',')); }

double ratio(const Figure& before, const Figure& after) {
  const double floor = std::max(before.floor, after.floor);
  const double b = std::max(before.value, floor), a = std::max(after.value, floor);
  return a == b ? 1 : a / b;  // equal infinities and zeros, too
}

}  // namespace

Figures comparable_figures(const ordered_json& result) {
  Figures figures;
  const std::string base = result.at("engines").at(0).at("name");
  if (result.contains("speed")) add_speed(result.at("speed"), base, figures);
  if (result.contains("accuracy")) add_accuracy(result.at("accuracy"), base, figures);
  if (result.contains("analytic")) add_analytic(result.at("analytic"), figures);
  if (result.contains("feet")) add_feet(result.at("feet"), figures);
  return figures;
}

void check_worse_than(double factor) {
  if (factor > 1 && std::isfinite(factor)) return;
  throw ConfigError("benchmark", "--worse-than", "a factor above 1", fmt::format("{}", factor));
}

Regression compare_results(const ordered_json& before, const ordered_json& after, double worse_than) {
  check_worse_than(worse_than);
  const std::string robot = before.value("robot", ""), other = after.value("robot", "");
  if (robot != other) {
    throw ConfigError("benchmark", "stored result", "the robot that is measured now, " + other, robot);
  }
  std::map<std::string, Figure> now;
  std::set<std::string> sections;
  for (Figure& figure : comparable_figures(after)) {
    sections.insert(section_of(figure.name));
    now.emplace(figure.name, std::move(figure));
  }
  Regression result;
  result.worse_than = worse_than;
  for (const Figure& figure : comparable_figures(before)) {
    const auto found = now.find(figure.name);
    if (found == now.end()) {
      if (sections.contains(section_of(figure.name))) result.missing.push_back(figure.name);
      continue;
    }
    ++result.compared;
    const double factor = ratio(figure, found->second);
    const Change change{figure.name, figure.value, found->second.value, factor};
    if (factor > worse_than) result.worse.push_back(change);
    if (factor < 1 / worse_than) result.better.push_back(change);
  }
  if (result.compared == 0) {
    throw ConfigError("benchmark", "stored result", "figures that this run has too", "none");
  }
  const auto by_factor = [](const Change& a, const Change& b) { return a.factor > b.factor; };
  std::stable_sort(result.worse.begin(), result.worse.end(), by_factor);
  std::stable_sort(result.better.rbegin(), result.better.rend(), by_factor);
  return result;
}

std::string describe(const Regression& regression) {
  const auto table = [](const char* heading, const std::vector<Change>& changes) {
    if (changes.empty()) return std::string();
    Table rows({heading, "stored", "now", "factor"});
    for (const Change& c : changes) {
      rows.add_row({c.name, fmt::format("{:.4g}", c.before), fmt::format("{:.4g}", c.after),
                    fmt::format("{:.3g}", c.factor)});
    }
    return rows.str() + "\n";
  };
  std::string text = table("worse", regression.worse) + table("better", regression.better);
  text += fmt::format("{} compared with the stored result: {} worse by more than a factor of {:g}, {} better",
                      counted(regression.compared, "figure"), regression.worse.size(), regression.worse_than,
                      regression.better.size());
  if (!regression.missing.empty()) {
    text +=
        fmt::format("; {} of the stored ones were not measured now (other settings or engines), e.g. \"{}\"",
                    regression.missing.size(), regression.missing.front());
  }
  return text + "\n";
}

ordered_json to_json(const Regression& regression) {
  const auto list = [](const std::vector<Change>& changes) {
    ordered_json result = ordered_json::array();
    for (const Change& c : changes) {
      // An engine that does not get through has no number.
      const auto value = [](double v) { return std::isfinite(v) ? ordered_json(v) : nullptr; };
      result.push_back({{"figure", c.name},
                        {"stored", value(c.before)},
                        {"now", value(c.after)},
                        {"factor", value(c.factor)}});
    }
    return result;
  };
  return {{"worse_than", regression.worse_than},
          {"compared", regression.compared},
          {"worse", list(regression.worse)},
          {"better", list(regression.better)},
          {"missing", regression.missing}};
}

}  // namespace crossgait::benchmarks
