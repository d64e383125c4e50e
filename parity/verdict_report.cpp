#include "parity/verdict_report.h"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "physics/core/table.h"

namespace crossgait {
namespace {

using nlohmann::ordered_json;

ordered_json to_json(const WithinSpread& s) {
  return {{"starts", s.starts}, {"time_step", s.time_step}, {"solver", s.solver}, {"total", s.total()}};
}

ordered_json to_json(const StatisticVerdict& v) {
  return {{"name", v.statistic.name},
          {"unit", v.statistic.unit},
          {"mean_a", v.mean_a},
          {"mean_b", v.mean_b},
          {"gap", to_json(v.gap)},
          {"spread_a", to_json(v.spread_a)},
          {"spread_b", to_json(v.spread_b)},
          {"spread", v.spread},
          {"floor", v.floor},
          {"score", to_json(v.score)},
          {"verdict", name(v.value)}};
}

}  // namespace

nlohmann::ordered_json to_json(const Interval& i) {
  return {{"estimate", i.estimate}, {"low", i.low}, {"high", i.high}};
}

std::string label(const Statistic& s) {
  return s.unit == "-" ? s.name : fmt::format("{}, {}", s.name, s.unit);
}

nlohmann::ordered_json to_json(const Verdict& verdict) {
  ordered_json json{{"behaviour", verdict.behaviour},
                    {"a", verdict.a},
                    {"b", verdict.b},
                    {"verdict", name(verdict.value())},
                    {"starts", verdict.options.starts},
                    {"limit", verdict.options.limit},
                    {"confidence", verdict.options.confidence},
                    {"variations", ordered_json::array()},
                    {"left_out", verdict.left_out},
                    {"statistics", ordered_json::array()}};
  for (const Variation& v : verdict.variations) json["variations"].push_back(v.name);
  for (const StatisticVerdict& s : verdict.statistics) json["statistics"].push_back(to_json(s));
  return json;
}

nlohmann::ordered_json to_json(const std::vector<AuditFinding>& findings) {
  ordered_json json = ordered_json::array();
  for (const AuditFinding& f : findings)
    json.push_back(
        {{"quantity", f.quantity}, {"element", f.element}, {"a", f.a}, {"b", f.b}, {"unit", f.unit}});
  return json;
}

std::string describe(const Verdict& verdict) {
  Table table({verdict.behaviour, verdict.a, verdict.b, "gap", "+-", "spread", "floor", "score", "from", "to",
               "verdict"});
  for (const StatisticVerdict& v : verdict.statistics) {
    const auto number = [](double value) { return fmt::format("{:.3g}", value); };
    table.add_row({label(v.statistic), fmt::format("{:.4g}", v.mean_a), fmt::format("{:.4g}", v.mean_b),
                   fmt::format("{:+.3g}", v.gap.estimate), number(v.gap.half_width()), number(v.spread),
                   number(v.floor), fmt::format("{:+.2f}", v.score.estimate),
                   fmt::format("{:+.2f}", v.score.low), fmt::format("{:+.2f}", v.score.high),
                   std::string(name(v.value))});
  }
  std::vector<std::string> varied;
  for (const Variation& v : verdict.variations) varied.push_back(v.name);
  std::string text = table.str();
  text += fmt::format(
      "\n{} starts; {}.\nScore = gap / sqrt(spread^2 + floor^2), at {:g} % confidence for all lines "
      "together: agrees "
      "within +-{:g},\nengine-dependent beyond, unresolved across.\n",
      verdict.options.starts, fmt::join(varied, ", "), 100 * verdict.options.confidence,
      verdict.options.limit);
  for (const std::string& reason : verdict.left_out) text += "Left out: " + reason + ".\n";
  return text + fmt::format("\n{} against {}: {}.\n", verdict.b, verdict.a, name(verdict.value()));
}

}  // namespace crossgait
