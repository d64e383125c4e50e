#include "parity/report.h"

#include <cmath>
#include <functional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

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

// One line of the statistics table.
struct Row {
  const char* label;
  std::function<std::string(const MotionSummary&)> value;
};

std::string optional(const std::optional<double>& value) {
  return value ? fmt::format("{:.3f}", *value) : "-";
}

const std::vector<Row>& rows() {
  static const std::vector<Row> kRows{
      {"outcome", outcome_in_words},
      {"simulated time, s",
       [](const MotionSummary& s) { return fmt::format("{:.2f}", s.simulated_seconds); }},
      {"distance, m", [](const MotionSummary& s) { return fmt::format("{:.4f}", s.distance_m); }},
      {"drift to the left, m", [](const MotionSummary& s) { return fmt::format("{:.4f}", s.lateral_m); }},
      {"mean speed, m/s", [](const MotionSummary& s) { return fmt::format("{:.4f}", s.mean_speed_mps); }},
      {"RMS roll, deg", [](const MotionSummary& s) { return fmt::format("{:.3f}", s.rms_roll_deg); }},
      {"RMS pitch, deg", [](const MotionSummary& s) { return fmt::format("{:.3f}", s.rms_pitch_deg); }},
      {"duty factor, mean of legs",
       [](const MotionSummary& s) { return fmt::format("{:.3f}", s.mean_duty_factor()); }},
      {"drag, share of swing", [](const MotionSummary& s) { return optional(s.drag); }},
      {"drag, inner 80 % of swing", [](const MotionSummary& s) { return optional(s.drag_inner); }},
      {"slip over planned stance path", [](const MotionSummary& s) { return optional(s.slip_per_path); }},
      {"heading error, deg", [](const MotionSummary& s) { return optional(s.heading_error_deg); }},
      {"slip of loaded feet, m", [](const MotionSummary& s) { return fmt::format("{:.4f}", s.slip_m); }},
      {"largest penetration, mm",
       [](const MotionSummary& s) { return fmt::format("{:.3f}", 1e3 * s.max_penetration_m); }},
      {"largest loop gap, mm",
       [](const MotionSummary& s) { return fmt::format("{:.3f}", 1e3 * s.max_loop_gap_m); }},
      {"cost of transport", [](const MotionSummary& s) { return optional(s.cost_of_transport); }},
      {"IK targets clamped", [](const MotionSummary& s) { return fmt::format("{}", s.ik_clamped); }},
      {"share of command followed",
       [](const MotionSummary& s) { return fmt::format("{:.3f}", s.limit_factor); }},
      {"wall time, s", [](const MotionSummary& s) { return fmt::format("{:.2f}", s.wall_seconds); }},
  };
  return kRows;
}

std::string heading(const WalkRun& run) {
  return fmt::format("{} on {}, {:.3g} s", run.gait, run.terrain, run.summary.simulated_seconds);
}

const WalkRun& run_named(const Comparison& comparison, const std::string& backend) {
  for (const WalkRun& run : comparison.runs) {
    if (run.engine.name == backend) return run;
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
  const Vector3& p = m.final_position_m;
  const auto at = [&m](Outcome which) { return m.first_at_s[static_cast<std::size_t>(which)]; };
  const auto or_null = [](const std::optional<double>& value) {
    return value ? ordered_json(*value) : ordered_json(nullptr);
  };
  return {{"outcome", name(m.outcome)},
          {"outcome_at_s", or_null(at(m.outcome))},
          {"simulated_seconds", m.simulated_seconds},
          {"distance_m", m.distance_m},
          {"lateral_m", m.lateral_m},
          {"path_m", m.path_m},
          {"yaw_rad", m.yaw_rad},
          {"fell", m.has(Outcome::kFell)},
          {"fell_at_s", or_null(at(Outcome::kFell))},
          {"collapsed", m.has(Outcome::kCollapsed)},
          {"left_terrain", m.has(Outcome::kLeftTerrain)},
          {"came_apart", m.has(Outcome::kCameApart)},
          {"diverged", m.has(Outcome::kDiverged)},
          {"mean_speed_mps", m.mean_speed_mps},
          {"final_position_m", {p.x(), p.y(), p.z()}},
          {"rms_roll_deg", m.rms_roll_deg},
          {"rms_pitch_deg", m.rms_pitch_deg},
          {"duty_factor", per_leg(m.duty_factor)},
          {"drag", or_null(m.drag)},
          {"drag_inner", or_null(m.drag_inner)},
          {"slip_per_path", or_null(m.slip_per_path)},
          {"heading_error_deg", or_null(m.heading_error_deg)},
          {"slip_m", m.slip_m},
          {"cost_of_transport", or_null(m.cost_of_transport)},
          {"ik_clamped", m.ik_clamped},
          {"limit_factor", m.limit_factor},
          {"max_penetration_m", m.max_penetration_m},
          {"max_loop_gap_m", m.max_loop_gap_m},
          {"physics_steps", m.physics_steps}};
}

nlohmann::ordered_json to_json(const WalkRun& run) {
  ordered_json result{{"backend", run.engine.name},
                      {"engine", run.engine.engine + " " + run.engine.version},
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
  for (const Row& row : rows()) {
    std::vector<std::string> cells{row.label};
    for (const WalkRun& run : runs) cells.push_back(row.value(run.summary));
    table.add_row(std::move(cells));
  }
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
