#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>
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

// In the order in which they come.
std::vector<std::string> distinct(const CourseResult& result, std::string (*of)(const CourseCell&)) {
  std::vector<std::string> names;
  for (const CourseCell& cell : result.cells) {
    if (std::find(names.begin(), names.end(), of(cell)) == names.end()) names.push_back(of(cell));
  }
  return names;
}

// The largest difference of a run's score on the sections that both finished; nothing if there is none, or if
// runs came to other outcomes.
std::optional<double> apart(const CourseResult& result, const std::string& a, const std::string& b) {
  std::optional<double> largest;
  for (const std::string& section : sections_of(result)) {
    const CourseCell *x = find_cell(result, section, a), *y = find_cell(result, section, b);
    if (x == nullptr || y == nullptr) continue;
    if (x->all.outcomes != y->all.outcomes) return std::nullopt;
    for (std::size_t k = 0; k < x->scores.size(); ++k)
      largest = std::max(largest.value_or(0), std::abs(x->scores[k] - y->scores[k]));
  }
  return largest;
}

}  // namespace

const CourseCell* find_cell(const CourseResult& result, const std::string& section,
                            const std::string& engine) noexcept {
  for (const CourseCell& cell : result.cells) {
    if (cell.section.name == section && cell.engine == engine) return &cell;
  }
  return nullptr;
}

std::vector<std::string> engines_of(const CourseResult& result) {
  return distinct(result, [](const CourseCell& cell) { return cell.engine; });
}

std::vector<std::string> sections_of(const CourseResult& result) {
  return distinct(result, [](const CourseCell& cell) { return cell.section.name; });
}

std::vector<CourseGroup> groups_of(const CourseResult& result) {
  std::vector<CourseGroup> groups;
  for (const std::string& engine : engines_of(result)) {
    const auto is_home = [&](const CourseGroup& group) {
      return std::all_of(group.engines.begin(), group.engines.end(), [&](const std::string& other) {
        const std::optional<double> between = apart(result, other, engine);
        return between && *between <= kSameCourseScore;
      });
    };
    const auto home = std::find_if(groups.begin(), groups.end(), is_home);
    if (home == groups.end()) {
      groups.push_back({group_name(groups.size()), {engine}});
      continue;
    }
    for (const std::string& other : home->engines)
      home->apart = std::max(home->apart, apart(result, other, engine).value_or(0));
    home->engines.push_back(engine);
  }
  return groups;
}

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

namespace {

// "; up to 5 % from A, on slope-10deg": the largest difference of the mean scores of a section.
std::string from_first(const CourseResult& r, const std::string& first, const std::string& engine) {
  double largest = 0;
  std::string text;
  for (const std::string& section : sections_of(r)) {
    const CourseCell *a = find_cell(r, section, first), *b = find_cell(r, section, engine);
    if (a == nullptr || b == nullptr) continue;
    const double between = std::abs(mean_and_deviation(a->scores).mean - mean_and_deviation(b->scores).mean);
    if (between <= largest) continue;
    largest = between;
    text = fmt::format("; up to {:.2g} % from A, on {}", 100 * between, section);
  }
  return text;
}

std::string group_line(const CourseResult& r, const CourseGroup& group) {
  std::string line = fmt::format("{} = {}: made {}", group.name, fmt::join(group.engines, ", "),
                                 percent(r.score(group.engines.front()).mean));
  if (group.engines.size() > 1) line += fmt::format(", every run the same to {:.2g} %", 100 * group.apart);
  return line + from_first(r, engines_of(r).front(), group.engines.front());
}

}  // namespace

std::vector<std::string> describe_groups(const CourseResult& r) {
  std::vector<std::string> lines;
  for (const CourseGroup& group : groups_of(r)) lines.push_back(group_line(r, group));
  return lines;
}

std::vector<std::string> notes_on(const CourseResult& r) {
  ClippedActions all;
  for (const CourseCell& cell : r.cells) all.add(cell.all.clipped_actions);
  const std::string note = note_on_clipping(short_name(r.policy), all);
  return note.empty() ? std::vector<std::string>() : std::vector{note};
}

nlohmann::ordered_json to_json(const CourseResult& r) {
  ordered_json json{{"summary", summary(r)}, {"groups", ordered_json::array()},
                    {"course", r.course},    {"policy", r.policy},
                    {"seed", r.seed},        {"runs", r.runs}};
  for (const CourseGroup& group : groups_of(r)) {
    json["groups"].push_back({{"name", group.name},
                              {"engines", group.engines},
                              {"apart", group.apart},
                              {"sentence", group_line(r, group)}});
  }
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
  json["notes"] = notes_on(r);
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

Table outcome_table(const CourseResult& r) {
  const std::vector<std::string> engines = engines_of(r);
  std::vector<std::string> header{"section"};
  header.insert(header.end(), engines.begin(), engines.end());
  Table rows(header);
  for (const std::string& section : sections_of(r)) {
    std::vector<std::string> row{section};
    for (const std::string& engine : engines) {
      const CourseCell* const cell = find_cell(r, section, engine);
      row.push_back(cell == nullptr ? "-"
                                    : fmt::format("{}, {}", percent(mean_and_deviation(cell->scores).mean),
                                                  outcomes_in_words(cell->all)));
    }
    rows.add_row(std::move(row));
  }
  return rows;
}

std::string describe(const CourseResult& r) {
  std::string text = summary(r) + "\n\n";
  if (engines_of(r).size() > 1) text += fmt::format("{}\n\n", fmt::join(describe_groups(r), "\n"));
  return text + table(r).str();
}

}  // namespace crossgait
