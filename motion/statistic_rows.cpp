#include "motion/statistic_rows.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

namespace crossgait {
namespace {

using M = MotionSummary;
using enum MarginScale;
using enum OverEpisodes;

constexpr std::string_view kShare = "a fiftieth of the time";

const StatisticRow kRows[] = {
    {.key = "simulated_seconds",
     .unit = "s",
     .help = "s of motion, without settling",
     .source = &M::simulated_seconds,
     .text = {.label = "simulated time, s", .digits = 2}},
    {.key = "distance_m",
     .unit = "m",
     .help = "forward, in the heading at the start, m",
     .source = &M::distance_m,
     .text = {.label = "distance, m", .digits = 4},
     .judged = {.name = "distance",
                .relative_margin = 0.02,
                .absolute_margin = 0.001,
                .per_second = true,
                .reason = "a fiftieth of the way: what a floor, or a battery, changes",
                .scale = kSpeed},
     .average = {.how = kMean, .digits = 3, .deviation = true}},
    {.key = "lateral_m",
     .unit = "m",
     .help = "to the left of the heading at the start, m",
     .source = &M::lateral_m,
     .text = {.label = "drift to the left, m", .digits = 4}},
    {.key = "path_m",
     .unit = "m",
     .help = "way over the ground, in straight pieces of 0.5 s, m",
     .source = &M::path_m,
     .average = {.how = kMean}},
    {.key = "yaw_rad", .unit = "rad", .help = "change of heading, in (-pi, pi]", .source = &M::yaw_rad},
    {.key = "fell",
     .unit = "-",
     .help = "roll or pitch went beyond the limit",
     .source = OutcomeHeld{Outcome::kFell}},
    {.key = "fell_at_s",
     .unit = "s",
     .help = "when that was first, s",
     .source = OutcomeTime{Outcome::kFell}},
    {.key = "collapsed",
     .unit = "-",
     .help = "a body other than a foot carried the weight, or the base hung low, for 0.5 s",
     .source = OutcomeHeld{Outcome::kCollapsed}},
    {.key = "left_terrain",
     .unit = "-",
     .help = "the base left the height field",
     .source = OutcomeHeld{Outcome::kLeftTerrain}},
    {.key = "loop_violated",
     .unit = "-",
     .help = "a loop opened beyond 0.05 leg lengths",
     .source = OutcomeHeld{Outcome::kLoopViolated}},
    {.key = "diverged",
     .unit = "-",
     .help = "the state was no longer finite",
     .source = OutcomeHeld{Outcome::kDiverged}},
    {.key = "mean_speed_mps",
     .unit = "m/s",
     .help = "distance over simulated time, m/s",
     .source = &M::mean_speed_mps,
     .text = {.label = "mean speed, m/s", .digits = 4},
     .average = {.how = kMean, .digits = 4, .deviation = true, .before = "distance_m"}},
    {.key = "final_position_m", .unit = "m", .help = "base origin in W, m", .source = &M::final_position_m},
    {.key = "rms_roll_deg",
     .unit = "deg",
     .help = "roll of the base, root mean square, deg",
     .source = &M::rms_roll_deg,
     .text = {.label = "RMS roll, deg", .digits = 3},
     .judged = {.name = "RMS roll",
                .relative_margin = 0.02,
                .absolute_margin = 0.1,
                .reason = "a tenth of a degree: how level a trunk is built, or an IMU mounted"},
     .average = {.how = kMean, .digits = 2}},
    {.key = "rms_pitch_deg",
     .unit = "deg",
     .help = "pitch of the base, root mean square, deg",
     .source = &M::rms_pitch_deg,
     .text = {.label = "RMS pitch, deg", .digits = 3},
     .judged = {.name = "RMS pitch",
                .relative_margin = 0.02,
                .absolute_margin = 0.1,
                .reason = "a tenth of a degree: how level a trunk is built, or an IMU mounted"},
     .average = {.how = kMean, .digits = 2}},
    {.key = "duty_factor",
     .unit = "-",
     .help = "fraction of time a foot carried load, at the physics rate",
     .source = &M::duty_factor,
     .text = {.label = "duty factor, mean of legs", .digits = 3},
     .judged = {.name = "duty factor", .absolute_margin = 0.02, .reason = kShare},
     .average = {.how = kMean, .digits = 3}},
    {.key = "swing_contact_ratio",
     .unit = "-",
     .help =
         "fraction of planned swing time in which the foot carried more than 2 % of the weight; null where "
         "no swing was planned",
     .source = &M::swing_contact_ratio,
     .text = {.label = "swing contact, fraction", .digits = 3},
     .judged = {.name = "swing contact", .absolute_margin = 0.02, .reason = kShare, .needs_plan = true},
     .average = {.how = kMean, .digits = 3, .deviation = true}},
    {.key = "swing_contact_ratio_inner",
     .unit = "-",
     .help = "swing contact ratio without the first and last tenth of each swing",
     .source = &M::swing_contact_ratio_inner,
     .text = {.label = "swing contact, inner 80 %", .digits = 3},
     .average = {.how = kMean, .digits = 3, .deviation = true}},
    {.key = "slip_per_path",
     .unit = "-",
     .help = "slip_m over the way that planned stance feet were to sweep; null where none was planned",
     .source = &M::slip_per_path,
     .text = {.label = "slip over planned stance path", .digits = 3},
     .average = {.how = kMean, .digits = 3, .deviation = true}},
    {.key = "heading_error_deg",
     .unit = "deg",
     .help = "largest difference of the heading from where the command's yaw rate leads, deg; null where "
             "nothing says what was asked for",
     .source = &M::heading_error_deg,
     .text = {.label = "heading error, deg", .digits = 3},
     .judged = {.name = "heading error",
                .relative_margin = 0.02,
                .absolute_margin = 0.2,
                .per_second = true,
                .reason = "a degree in five seconds: how straight a robot is put down",
                .before = "swing_contact_ratio"},
     .average = {.how = kMean, .digits = 2, .deviation = true}},
    {.key = "slip_m",
     .unit = "m",
     .help = "way that loaded feet slid, all four together, at the physics rate, m",
     .source = &M::slip_m,
     .text = {.label = "slip of loaded feet, m", .digits = 4},
     .judged = {.name = "slip of loaded feet",
                .relative_margin = 0.02,
                .absolute_margin = 0.004,
                .per_second = true,
                .reason = "1 mm a second for each foot",
                .scale = kSpeed,
                .before = "duty_factor"},
     .average = {.how = kMean, .digits = 2}},
    {.key = "cost_of_transport",
     .unit = "-",
     .help = "servo work over weight times path; null where nothing moved",
     .source = &M::cost_of_transport,
     .text = {.label = "cost of transport", .digits = 3},
     .judged = {.name = "cost of transport",
                .relative_margin = 0.02,
                .absolute_margin = 0.01,
                .reason = "a fiftieth of the energy: what a battery's charge is known to",
                .before = "duty_factor"},
     .average = {.how = kMean, .digits = 2, .deviation = true}},
    {.key = "ik_clamped",
     .unit = "-",
     .help = "leg targets out of reach",
     .source = &M::ik_clamped,
     .text = {.label = "IK targets clamped"},
     .average = {.how = kSum, .digits = 0}},
    {.key = "limit_factor",
     .unit = "-",
     .help = "smallest fraction of a velocity command that the steps could follow",
     .source = &M::limit_factor,
     .text = {.label = "fraction of command followed", .digits = 3}},
    {.key = "max_penetration_m",
     .unit = "m",
     .help = "deepest contact, m",
     .source = &M::max_penetration_m,
     .text = {.label = "largest penetration, mm", .digits = 3, .factor = 1e3, .before = "cost_of_transport"}},
    {.key = "max_loop_gap_m",
     .unit = "m",
     .help = "widest opening of a closed loop, m",
     .source = &M::max_loop_gap_m,
     .text = {.label = "largest loop gap, mm", .digits = 3, .factor = 1e3, .before = "cost_of_transport"}},
    {.key = "physics_steps", .unit = "-", .help = "physics steps of the motion", .source = &M::physics_steps},
};

// In the order of the table, but for rows that stand before an earlier one.
template <typename View, typename Has>
std::vector<const StatisticRow*> rows_with(View StatisticRow::*view, const Has& has) {
  std::vector<const StatisticRow*> rows;
  for (const StatisticRow& row : kRows) {
    if (!has(row.*view)) continue;
    const auto place = std::find_if(rows.begin(), rows.end(), [&](const StatisticRow* other) {
      return other->key == (row.*view).before;
    });
    rows.insert(place, &row);
  }
  return rows;
}

struct ReadNumber {
  const MotionSummary& motion;

  std::optional<double> operator()(double M::*member) const { return motion.*member; }
  std::optional<double> operator()(std::optional<double> M::*member) const { return motion.*member; }
  std::optional<double> operator()(std::int64_t M::*member) const {
    return static_cast<double>(motion.*member);
  }
  std::optional<double> operator()(LegArray<double> M::*member) const {
    double sum = 0;
    for (const Leg leg : kLegs) sum += (motion.*member)[leg];
    return sum / kLegCount;
  }
  std::optional<double> operator()(Vector3 M::*) const { return std::nullopt; }
  std::optional<double> operator()(OutcomeHeld held) const { return motion.has(held.outcome) ? 1.0 : 0.0; }
  std::optional<double> operator()(OutcomeTime first) const {
    return motion.first_at_s[static_cast<std::size_t>(first.outcome)];
  }
};

}  // namespace

std::span<const StatisticRow> statistic_rows() { return kRows; }

const std::vector<const StatisticRow*>& shown_statistics() {
  static const auto kShown =
      rows_with(&StatisticRow::text, [](const StatisticText& text) { return !text.label.empty(); });
  return kShown;
}

const std::vector<const StatisticRow*>& judged_statistics() {
  static const auto kJudged =
      rows_with(&StatisticRow::judged, [](const StatisticJudged& judged) { return !judged.name.empty(); });
  return kJudged;
}

const std::vector<const StatisticRow*>& averaged_statistics() {
  static const auto kAveraged =
      rows_with(&StatisticRow::average, [](const StatisticAverage& average) { return average.how != kNone; });
  return kAveraged;
}

const StatisticRow& statistic_row(const StatisticSource& source) {
  for (const StatisticRow& row : kRows) {
    if (row.source == source) return row;
  }
  throw std::logic_error("a member of MotionSummary without a row in motion/statistic_rows.cpp");
}

std::optional<double> number_of(const StatisticRow& row, const MotionSummary& motion) noexcept {
  return std::visit(ReadNumber{motion}, row.source);
}

std::string text_of(const StatisticRow& row, const MotionSummary& motion) {
  const std::optional<double> value = number_of(row, motion);
  return value ? fmt::format("{:.{}f}", row.text.factor * *value, row.text.digits) : "-";
}

}  // namespace crossgait
