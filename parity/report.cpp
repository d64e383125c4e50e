#include "parity/report.h"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "motion/statistic_rows.h"
#include "parity/answer.h"
#include "physics/core/table.h"
#include "physics/robot/contact_json.h"

namespace crossgait {
namespace {

using nlohmann::ordered_json;

template <typename T>
ordered_json per_leg(const LegArray<T>& values) {
  ordered_json result;
  for (const Leg leg : kLegs) result[std::string(name(leg))] = values[leg];
  return result;
}

ordered_json or_null(const std::optional<double>& value) {
  return value ? ordered_json(*value) : ordered_json(nullptr);
}

ordered_json to_json(const PairDifference& pair) {
  ordered_json result{{"a", pair.a},
                      {"b", pair.b},
                      {"same_laws", pair.same_laws},
                      {"max_position_difference_m", pair.max_position_difference_m},
                      {"max_joint_difference_rad", pair.max_joint_difference_rad},
                      {"max_attitude_difference_rad", pair.max_attitude_difference_rad},
                      {"one_step", nullptr},
                      {"growth", nullptr},
                      {"first_divergence", nullptr},
                      {"standing_difference_m", pair.parting.found().standing_m},
                      {"standing_difference_rad", pair.parting.found().standing_rad},
                      {"parted_at_s", or_null(pair.parting.found().time_s)}};
  if (const auto& step = pair.one_step) {
    result["one_step"] = {{"position_m", step->position_m},
                          {"joint_rad", step->joint_rad},
                          {"attitude_rad", step->attitude_rad},
                          {"at_s", step->at_s},
                          {"steps", step->steps}};
  }
  if (const auto& growth = pair.growth) {
    result["growth"] = {{"per_half_second", growth->per_half_second},
                        {"from_s", growth->from_s},
                        {"to_s", growth->to_s},
                        {"spread", growth->spread}};
  }
  if (const auto& first = pair.first_divergence) {
    result["first_divergence"] = {
        {"quantity", first->quantity}, {"time_s", first->time_s}, {"tolerance", first->tolerance}};
  }
  return result;
}

// The value of a statistic, of the type that its row says.
struct ReadJson {
  const MotionSummary& motion;

  ordered_json operator()(double MotionSummary::*member) const { return motion.*member; }
  ordered_json operator()(std::optional<double> MotionSummary::*member) const {
    return or_null(motion.*member);
  }
  ordered_json operator()(std::int64_t MotionSummary::*member) const { return motion.*member; }
  ordered_json operator()(LegArray<double> MotionSummary::*member) const { return per_leg(motion.*member); }
  ordered_json operator()(Vector3 MotionSummary::*member) const {
    const Vector3& p = motion.*member;
    return {p.x(), p.y(), p.z()};
  }
  ordered_json operator()(OutcomeHeld held) const { return motion.has(held.outcome); }
  ordered_json operator()(OutcomeTime first) const {
    return or_null(motion.first_at_s[static_cast<std::size_t>(first.outcome)]);
  }
};

std::string heading(const WalkRun& run) {
  return fmt::format("{} on {}, {:.3g} s", run.gait, run.terrain, run.summary.simulated_seconds);
}

// What the other group has to the first: a share where that says something, which across a change of sign, or
// of what is shown as nothing, it does not.
std::string change(const StatisticRow& row, const MotionSummary& a, const MotionSummary& b) {
  const std::optional<double> x = number_of(row, a), y = number_of(row, b);
  if (!x || !y) return "";
  const double shown_as_nothing = 0.5 * std::pow(10.0, -row.text.digits) / row.text.factor;
  if (*x * *y < 0 || std::abs(*x) <= 10 * shown_as_nothing) return "";
  constexpr double kShare = 10;  // as a percentage it would be a long number
  if (std::abs(*y) >= kShare * std::abs(*x)) return fmt::format("x{:.3g}", *y / *x);
  const double percent = 100 * (*y - *x) / std::abs(*x);
  return std::abs(percent) < 0.05 ? "" : fmt::format("{:+.1f} %", percent);
}

// A column per group, which stands for all of its runs, and of two groups what the other has to the first.
Table groups_table(const Comparison& comparison) {
  const std::vector<RunGroup> groups = groups_of(comparison);
  std::vector<std::string> header{heading(comparison.runs.front())};
  for (const RunGroup& group : groups) header.push_back(group.name);
  if (groups.size() == 2) header.emplace_back("B to A");
  Table table(header);
  const auto motion = [&](const RunGroup& group) -> const MotionSummary& {
    return comparison.runs[group.runs.front()].summary;
  };
  std::vector<std::string> outcomes{"outcome"};
  for (const RunGroup& group : groups) outcomes.push_back(outcome_in_words(motion(group)));
  table.add_row(outcomes);
  for (const StatisticRow* row : shown_statistics()) {
    std::vector<std::string> cells{std::string(row->text.label)};
    for (const RunGroup& group : groups) cells.push_back(text_of(*row, motion(group)));
    if (groups.size() == 2) cells.push_back(change(*row, motion(groups[0]), motion(groups[1])));
    table.add_row(cells);
  }
  std::vector<std::string> times{"wall time, s"};
  for (const RunGroup& group : groups) {
    std::vector<std::string> all;
    for (const std::size_t i : group.runs)
      all.push_back(fmt::format("{:.2f}", comparison.runs[i].summary.wall_seconds));
    times.push_back(fmt::format("{}", fmt::join(all, ", ")));
  }
  table.add_row(times);
  return table;
}

}  // namespace

nlohmann::ordered_json to_json(const ContactSpec& contact) {
  ordered_json json;
  for (const ContactSetting& setting : contact_settings())
    json[std::string(setting.name)] = to_json(setting, setting.get(contact));
  return json;
}

std::string describe_contact(const ContactSpec& contact, const std::vector<EngineInfo>& engines) {
  std::vector<std::string> changed, others;
  const ContactSettings said = all_settings(contact);
  for (const ContactSetting& setting : contact_settings()) {
    const std::vector<double>* numbers = said.find(setting.name);
    if (numbers == nullptr || setting.name == "friction" || *numbers == setting.get(ContactSpec())) continue;
    changed.push_back(setting.words.empty()
                          ? fmt::format("{}={:.6g}", setting.name, fmt::join(*numbers, ":"))
                          : fmt::format("{}={}", setting.name, contact_setting_text(setting, *numbers)));
  }
  if (changed.empty()) return "";
  for (const EngineInfo& engine : engines) {
    const std::vector<std::string> ignored = not_of_law(contact, engine.capabilities);
    if (!ignored.empty())
      others.push_back(fmt::format("; not of the law of {}: {}", engine.name, fmt::join(ignored, ", ")));
  }
  return fmt::format("Contact: {}{}.\n", fmt::join(changed, ", "), fmt::join(others, ""));
}

std::string outcome_in_words(const MotionSummary& m) {
  const OutcomeRow& row = outcome_row(m.outcome);
  const std::optional<double>& at = m.first_at_s[static_cast<std::size_t>(m.outcome)];
  return at ? fmt::format("{} at {:.2f} s", row.words, *at) : std::string(row.words);
}

nlohmann::ordered_json to_json(const MotionSummary& m) {
  ordered_json json{{"outcome", name(m.outcome)}, {"outcome_at_s", ReadJson{m}(OutcomeTime{m.outcome})}};
  for (const StatisticRow& row : statistic_rows())
    json[std::string(row.key)] = std::visit(ReadJson{m}, row.source);
  return json;
}

nlohmann::ordered_json to_json(const WalkRun& run) {
  ordered_json result{
      {"engine", run.engine.name},       {"engine_version", run.engine.library + " " + run.engine.version},
      {"terrain", run.terrain},          {"gait", run.gait},
      {"contact", to_json(run.contact)}, {"not_of_law", not_of_law(run.contact, run.engine.capabilities)}};
  result.update(to_json(run.summary));
  result["wall_seconds"] = run.summary.wall_seconds;
  if (run.interrupted) result["interrupted"] = true;
  return result;
}

nlohmann::ordered_json to_json(const Comparison& comparison) {
  ordered_json result{{"summary", summary(comparison)},
                      {"groups", groups_json(comparison)},
                      {"parted_beyond_m", kPartedLegs * comparison.leg_length_m},
                      {"runs", ordered_json::array()},
                      {"pairs", ordered_json::array()}};
  for (const WalkRun& run : comparison.runs) result["runs"].push_back(to_json(run));
  for (const PairDifference& pair : comparison.pairs) result["pairs"].push_back(to_json(pair));
  return result;
}

Table statistics_table(const std::string& heading, const std::vector<WalkRun>& runs) {
  std::vector<std::string> header{heading};
  for (const WalkRun& run : runs) header.push_back(run.engine.name);
  Table table(std::move(header));
  const auto add = [&](std::string_view label, const auto& text) {
    std::vector<std::string> cells{std::string(label)};
    for (const WalkRun& run : runs) cells.push_back(text(run.summary));
    table.add_row(std::move(cells));
  };
  add("outcome", outcome_in_words);
  for (const StatisticRow* row : shown_statistics())
    add(row->text.label, [row](const MotionSummary& m) { return text_of(*row, m); });
  add("wall time, s", [](const MotionSummary& m) { return fmt::format("{:.2f}", m.wall_seconds); });
  return table;
}

std::string describe(const WalkRun& run) {
  const std::string contact = describe_contact(run.contact, {run.engine});
  return summary(run) + "\n\n" + statistics_table(heading(run), {run}).str() +
         (contact.empty() ? "" : "\n" + contact);
}

std::string describe_briefly(const Comparison& comparison) {
  std::string text = summary(comparison) + "\n";
  if (!comparison.runs.empty()) text += fmt::format("\n{}\n", fmt::join(describe_groups(comparison), "\n"));
  return text;
}

std::string describe(const Comparison& comparison) {
  std::string text = describe_briefly(comparison);
  if (comparison.runs.empty()) return text;
  text += fmt::format("\n{}\n", groups_table(comparison).str());
  for (const std::string& line : describe_parity(comparison)) text += line + "\n";
  std::vector<EngineInfo> engines;
  for (const WalkRun& run : comparison.runs) engines.push_back(run.engine);
  return text + describe_contact(comparison.runs.front().contact, engines);
}

}  // namespace crossgait
