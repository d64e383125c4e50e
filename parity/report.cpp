#include "parity/report.h"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "motion/statistic_rows.h"
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

ordered_json to_json(const PairDifference& pair) {
  ordered_json result{{"a", pair.a},
                      {"b", pair.b},
                      {"same_laws", pair.same_laws},
                      {"max_position_difference_m", pair.max_position_difference_m},
                      {"max_joint_difference_rad", pair.max_joint_difference_rad},
                      {"max_attitude_difference_rad", pair.max_attitude_difference_rad},
                      {"one_step", nullptr},
                      {"growth", nullptr},
                      {"first_divergence", nullptr}};
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

ordered_json or_null(const std::optional<double>& value) {
  return value ? ordered_json(*value) : ordered_json(nullptr);
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

const WalkRun& run_named(const Comparison& comparison, const std::string& engine) {
  for (const WalkRun& run : comparison.runs) {
    if (run.engine.name == engine) return run;
  }
  return comparison.runs.front();
}

std::string percent_apart(double a, double b) {
  if (std::abs(a) < 1e-3) return fmt::format("{:+.4f} m", b - a);
  return fmt::format("{:+.2f} %", 100 * (b - a) / std::abs(a));
}

std::string in_steps(const PairDifference& pair) {
  if (!pair.one_step || pair.one_step->steps == 0) return "";
  return fmt::format(" One control step from the same state: {:.1g} apart at most.",
                     pair.one_step->largest());
}

std::string growth(const PairDifference& pair) {
  if (!pair.growth) return "";
  return fmt::format(" Differences grow x{:.2g} per half second.", pair.growth->per_half_second);
}

std::string sentence(const Comparison& comparison, const PairDifference& pair) {
  const std::string text = fmt::format(
      "{} and {}: base {:.2g} m apart at most, joints {:.2g} rad, attitude {:.2g} rad; ", pair.a, pair.b,
      pair.max_position_difference_m, pair.max_joint_difference_rad, pair.max_attitude_difference_rad);
  const std::string how = in_steps(pair) + growth(pair);
  if (!pair.first_divergence) {
    return text + fmt::format("the same within {:.0e} m and {:.0e} rad.{}", pair.tolerances.position,
                              pair.tolerances.joint, how);
  }
  const double a = run_named(comparison, pair.a).summary.distance_m;
  const double b = run_named(comparison, pair.b).summary.distance_m;
  return text + fmt::format("distance {}; {} left its tolerance of {:.0e} first, at {:.3f} s.{}",
                            percent_apart(a, b), pair.first_divergence->quantity,
                            pair.first_divergence->tolerance, pair.first_divergence->time_s, how);
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
  const OutcomeRow& row = outcome_rows()[static_cast<std::size_t>(m.outcome)];
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
  ordered_json result{{"runs", ordered_json::array()}, {"pairs", ordered_json::array()}};
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
  return statistics_table(heading(run), {run}).str() + (contact.empty() ? "" : "\n" + contact);
}

std::vector<std::string> describe_pairs(const Comparison& comparison) {
  std::vector<std::string> sentences;
  for (const PairDifference& pair : comparison.pairs) sentences.push_back(sentence(comparison, pair));
  return sentences;
}

std::string describe(const Comparison& comparison) {
  if (comparison.runs.empty()) return "nothing to compare\n";
  std::string text = statistics_table(heading(comparison.runs.front()), comparison.runs).str() + "\n";
  for (const std::string& line : describe_pairs(comparison)) text += line + "\n";
  std::vector<EngineInfo> engines;
  for (const WalkRun& run : comparison.runs) engines.push_back(run.engine);
  return text + describe_contact(comparison.runs.front().contact, engines);
}

}  // namespace crossgait
