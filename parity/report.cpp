#include "parity/report.h"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "motion/statistic_rows.h"
#include "physics/core/table.h"

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
                      {"first_divergence", nullptr}};
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

std::string sentence(const Comparison& comparison, const PairDifference& pair) {
  const std::string text = fmt::format(
      "{} and {}: base {:.2g} m apart at most, joints {:.2g} rad, attitude {:.2g} rad; ", pair.a, pair.b,
      pair.max_position_difference_m, pair.max_joint_difference_rad, pair.max_attitude_difference_rad);
  if (!pair.first_divergence) {
    return text + fmt::format("the same within {:.0e} m and {:.0e} rad.", pair.tolerances.position,
                              pair.tolerances.joint);
  }
  const double a = run_named(comparison, pair.a).summary.distance_m;
  const double b = run_named(comparison, pair.b).summary.distance_m;
  return text + fmt::format("distance {}; {} left its tolerance of {:.0e} first, at {:.3f} s.",
                            percent_apart(a, b), pair.first_divergence->quantity,
                            pair.first_divergence->tolerance, pair.first_divergence->time_s);
}

}  // namespace

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
  ordered_json result{{"engine", run.engine.name},
                      {"engine_version", run.engine.library + " " + run.engine.version},
                      {"terrain", run.terrain},
                      {"gait", run.gait}};
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

std::string describe(const WalkRun& run) { return statistics_table(heading(run), {run}).str(); }

std::vector<std::string> describe_pairs(const Comparison& comparison) {
  std::vector<std::string> sentences;
  for (const PairDifference& pair : comparison.pairs) sentences.push_back(sentence(comparison, pair));
  return sentences;
}

std::string describe(const Comparison& comparison) {
  if (comparison.runs.empty()) return "nothing to compare\n";
  std::string text = statistics_table(heading(comparison.runs.front()), comparison.runs).str() + "\n";
  for (const std::string& line : describe_pairs(comparison)) text += line + "\n";
  return text;
}

}  // namespace crossgait
