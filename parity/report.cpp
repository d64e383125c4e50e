#include "crossgait/parity/report.h"

#include <cmath>
#include <functional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crossgait/parity/table.h"

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
  std::function<std::string(const WalkSummary&)> value;
};

std::string mean_duty(const WalkSummary& s) {
  double sum = 0;
  for (const Leg leg : kLegs) sum += s.duty_factor[leg];
  return fmt::format("{:.3f}", sum / kLegCount);
}

std::string outcome(const WalkSummary& s) {
  if (s.diverged) return "diverged";
  return s.fell ? fmt::format("fell at {:.2f} s", *s.fell_at_s) : "walked";
}

const std::vector<Row>& rows() {
  static const std::vector<Row> kRows{
      {"outcome", outcome},
      {"simulated time, s", [](const WalkSummary& s) { return fmt::format("{:.2f}", s.simulated_seconds); }},
      {"distance, m", [](const WalkSummary& s) { return fmt::format("{:.4f}", s.distance_m); }},
      {"drift to the left, m", [](const WalkSummary& s) { return fmt::format("{:.4f}", s.lateral_m); }},
      {"mean speed, m/s", [](const WalkSummary& s) { return fmt::format("{:.4f}", s.mean_speed_mps); }},
      {"RMS roll, deg", [](const WalkSummary& s) { return fmt::format("{:.3f}", s.rms_roll_deg); }},
      {"RMS pitch, deg", [](const WalkSummary& s) { return fmt::format("{:.3f}", s.rms_pitch_deg); }},
      {"duty factor, mean of legs", mean_duty},
      {"slip of loaded feet, m", [](const WalkSummary& s) { return fmt::format("{:.4f}", s.slip_m); }},
      {"largest penetration, mm",
       [](const WalkSummary& s) { return fmt::format("{:.3f}", 1e3 * s.max_penetration_m); }},
      {"largest loop gap, mm",
       [](const WalkSummary& s) { return fmt::format("{:.3f}", 1e3 * s.max_loop_gap_m); }},
      {"cost of transport", [](const WalkSummary& s) { return fmt::format("{:.3f}", s.cost_of_transport); }},
      {"IK targets clamped", [](const WalkSummary& s) { return fmt::format("{}", s.ik_clamped); }},
      {"share of command followed",
       [](const WalkSummary& s) { return fmt::format("{:.3f}", s.limit_factor); }},
      {"wall time, s", [](const WalkSummary& s) { return fmt::format("{:.2f}", s.wall_seconds); }},
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

nlohmann::ordered_json to_json(const WalkRun& run) {
  const WalkSummary& s = run.summary;
  const Vector3& p = s.final_position_m;
  ordered_json result{{"backend", run.engine.name},
                      {"engine", run.engine.engine + " " + run.engine.version},
                      {"terrain", run.terrain},
                      {"gait", run.gait},
                      {"simulated_seconds", s.simulated_seconds},
                      {"distance_m", s.distance_m},
                      {"lateral_m", s.lateral_m},
                      {"yaw_rad", s.yaw_rad},
                      {"fell", s.fell},
                      {"fell_at_s", nullptr},
                      {"mean_speed_mps", s.mean_speed_mps},
                      {"final_position_m", {p.x(), p.y(), p.z()}},
                      {"rms_roll_deg", s.rms_roll_deg},
                      {"rms_pitch_deg", s.rms_pitch_deg},
                      {"duty_factor", per_leg(s.duty_factor)},
                      {"slip_m", s.slip_m},
                      {"cost_of_transport", s.cost_of_transport},
                      {"ik_clamped", s.ik_clamped},
                      {"limit_factor", s.limit_factor},
                      {"diverged", s.diverged},
                      {"max_penetration_m", s.max_penetration_m},
                      {"max_loop_gap_m", s.max_loop_gap_m},
                      {"wall_seconds", s.wall_seconds},
                      {"physics_steps", s.physics_steps}};
  if (s.fell_at_s) result["fell_at_s"] = *s.fell_at_s;
  return result;
}

nlohmann::ordered_json to_json(const Comparison& comparison) {
  ordered_json result{{"runs", ordered_json::array()}, {"pairs", ordered_json::array()}};
  for (const WalkRun& run : comparison.runs) result["runs"].push_back(to_json(run));
  for (const PairDifference& pair : comparison.pairs) result["pairs"].push_back(to_json(pair));
  return result;
}

std::string describe(const WalkRun& run) {
  Table table({heading(run), run.engine.name});
  for (const Row& row : rows()) table.add_row({row.label, row.value(run.summary)});
  return table.str();
}

std::string describe(const Comparison& comparison) {
  if (comparison.runs.empty()) return "nothing to compare\n";
  std::vector<std::string> header{heading(comparison.runs.front())};
  for (const WalkRun& run : comparison.runs) header.push_back(run.engine.name);
  Table table(std::move(header));
  for (const Row& row : rows()) {
    std::vector<std::string> cells{row.label};
    for (const WalkRun& run : comparison.runs) cells.push_back(row.value(run.summary));
    table.add_row(std::move(cells));
  }
  std::string text = table.str() + "\n";
  for (const PairDifference& pair : comparison.pairs) text += sentence(comparison, pair) + "\n";
  return text;
}

}  // namespace crossgait
