#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "parity/answer.h"
#include "physics/core/schema.h"
#include "physics/core/table.h"
#include "study/course.h"

namespace crossgait {
namespace {

using nlohmann::ordered_json;

ordered_json to_json(const Range& range) { return {range.min, range.max}; }

ordered_json to_json(const CourseSection& s) {
  return {{"name", s.name},
          {"terrain", s.terrain},
          {"speed_mps", s.speed},
          {"friction", s.friction},
          {"payload", s.payload},
          {"push_speed_mps", to_json(s.push_speed)},
          {"push_interval_s", to_json(s.push_interval)}};
}

std::string number(const std::optional<MeanAndDeviation>& value, int digits) {
  return value ? fmt::format("{:.{}f}", value->mean, digits) : "-";
}

std::string score(const MeanAndDeviation& s) { return fmt::format("{:.3f} +- {:.3f}", s.mean, s.deviation); }

// In the order of their first cells.
std::vector<std::string> engines_of(const CourseResult& result) {
  std::vector<std::string> engines;
  for (const CourseCell& cell : result.cells) {
    if (std::find(engines.begin(), engines.end(), cell.engine) == engines.end())
      engines.push_back(cell.engine);
  }
  return engines;
}

std::string percent(double share) { return fmt::format("{:.0f} %", 100 * share); }

// " They differ most on pushed: 100 % in mujoco, 0 % in bullet."; empty where they differ by less than the
// percent that is told.
std::string largest_difference(const CourseResult& r) {
  constexpr double kTold = 0.01;
  std::map<std::string, std::vector<const CourseCell*>> sections;
  for (const CourseCell& cell : r.cells) sections[cell.section.name].push_back(&cell);
  if (sections.size() < 2) return "";
  double largest = kTold;
  std::string text;
  for (const auto& [name, cells] : sections) {
    const auto score = [](const CourseCell* cell) { return mean_and_deviation(cell->scores).mean; };
    const auto [low, high] = std::minmax_element(
        cells.begin(), cells.end(), [&](const auto* a, const auto* b) { return score(a) < score(b); });
    if (score(*high) - score(*low) <= largest) continue;
    largest = score(*high) - score(*low);
    text = fmt::format(" They differ most on {}: {} in {}, {} in {}.", name, percent(score(*high)),
                       (*high)->engine, percent(score(*low)), (*low)->engine);
  }
  return text;
}

}  // namespace

std::string summary(const CourseResult& r) {
  const std::vector<std::string> engines = engines_of(r);
  if (engines.empty())
    return fmt::format("{} finished no section of course {}.", short_name(r.policy), r.course);
  const auto elsewhere = [&](const CourseCell& cell) {
    return cell.section.name != r.cells.front().section.name;
  };
  const std::string of = std::none_of(r.cells.begin(), r.cells.end(), elsewhere)
                             ? fmt::format("{} of course {}", r.cells.front().section.name, r.course)
                             : fmt::format("course {}", r.course);
  std::vector<std::string> parts;
  for (const std::string& engine : engines) {
    parts.push_back(fmt::format("{}{} in {}", percent(r.score(engine).mean),
                                parts.empty() ? fmt::format(" of {}", of) : "", engine));
  }
  return fmt::format("{} made {}.{}", short_name(r.policy), listed(parts), largest_difference(r));
}

nlohmann::ordered_json to_json(const CourseResult& r) {
  ordered_json json{{"summary", summary(r)},
                    {"course", r.course},
                    {"policy", r.policy},
                    {"seed", r.seed},
                    {"runs", r.runs}};
  json["cells"] = ordered_json::array();
  for (const CourseCell& cell : r.cells) {
    const MeanAndDeviation s = mean_and_deviation(cell.scores);
    json["cells"].push_back({{"section", to_json(cell.section)},
                             {"engine", cell.engine},
                             {"score", {{"mean", s.mean}, {"deviation", s.deviation}}},
                             {"scores", cell.scores},
                             {"all", to_json(cell.all)}});
  }
  json["scores"] = ordered_json::array();
  for (const std::string& engine : engines_of(r)) {
    const MeanAndDeviation s = r.score(engine);
    json["scores"].push_back({{"engine", engine}, {"mean", s.mean}, {"deviation", s.deviation}});
  }
  if (r.interrupted) json["interrupted"] = true;
  return with_schema("course", json);
}

Table table(const CourseResult& r) {
  Table rows({fmt::format("{} on course {}, {} each", short_name(r.policy), r.course, counted(r.runs, "run")),
              "engine", "asked, m/s", "made, m/s", "score", "outcome", "cost of transport", "swing contact",
              "slip"});
  for (const CourseCell& cell : r.cells) {
    using M = MotionSummary;
    const Evaluation& e = cell.all;
    const MotionAverages& m = e.motion;
    rows.add_row({cell.section.name, cell.engine, fmt::format("{:.2f}", cell.section.speed),
                  number(m.of(&M::mean_speed_mps), 3), score(mean_and_deviation(cell.scores)),
                  outcomes_in_words(e), number(m.of(&M::cost_of_transport), 2),
                  number(m.of(&M::swing_contact_ratio), 3), number(m.of(&M::slip_per_path), 3)});
  }
  for (const std::string& engine : engines_of(r))
    rows.add_row({"all sections", engine, "", "", score(r.score(engine))});
  return rows;
}

std::string describe(const CourseResult& r) { return summary(r) + "\n\n" + table(r).str(); }

}  // namespace crossgait
