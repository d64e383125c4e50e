#include "parity/step_check.h"

#include <cmath>

#include "parity/row_test.h"

namespace crossgait {
namespace {

std::vector<double> changes(const PairedValues& from, const PairedValues& to) {
  std::vector<double> result = to.differences();
  const std::vector<double> before = from.differences();
  for (std::size_t k = 0; k < result.size(); ++k) result[k] -= before[k];
  return result;
}

// What three steps lead to, where the first change is resolved and the gap falls in with one order.
void extrapolate(const StatisticRuns& runs, double from, Estimand estimand, StepCheck& step) {
  if (runs.at_quarter.a.size() < 2) return;
  step.quarter = row_test(runs.at_quarter, runs.is_share, estimand)->estimate();
  const double first = step.half.estimate - from, second = *step.quarter - step.half.estimate;
  if (step.change.contains(0) || first * second <= 0) return;
  const double ratio = first / second;  // 2^order
  constexpr double kLeast = 1.4,
                   kMost = 8;  // orders of 0.5 and 3: of integrators, and what contact makes of them
  if (ratio < kLeast || ratio > kMost) return;
  step.order = std::log2(ratio);
  step.extrapolated = *step.quarter + second / (ratio - 1);
}

// What became of a gap from one step to half of it, in words; empty if it is still there.
std::string loss(double g, double h, double margin) {
  if (g * h <= 0) return "half the time step turns it round";
  if (std::abs(h) <= std::abs(g) / 2) return "half the time step takes half of it or more";
  const double none = 2 * h - g;  // at no step, if it goes with the step
  if (none * g <= 0 || std::abs(none) <= margin) return "it would be within the margin at no time step";
  return "";
}

}  // namespace

void check_step(const StatisticRuns& runs, const RowErrors& errors, StatisticVerdict& v) {
  if (v.pairs < kFewestStarts || runs.is_cut_short) return;
  if (runs.at_half.a.size() < kFewestStarts) return add_reason(v, "half the time step was not compared");
  const double g = row_test(runs.at_step, runs.is_share, v.estimand)->estimate();
  const double margin = margin_of(runs.statistic, runs.at_step, v.estimand, runs.step_seconds);
  const auto half = row_test(runs.at_half, runs.is_share, v.estimand, margin);
  StepCheck step;
  step.half = half->interval(1 - errors.simultaneous);
  step.change =
      PairedDifferences(changes(runs.at_step, runs.at_half), v.estimand).interval(1 - errors.simultaneous);
  extrapolate(runs, g, v.estimand, step);
  v.step = step;
  const bool alike = is_alike(runs.is_share, runs.at_half);
  const bool half_within = half->p_within(margin) <= errors.tail || alike,
             half_beyond = half->p_beyond(margin) <= errors.level;
  const double h = step.half.estimate;
  if (v.word == Word::kAgrees) {
    if (half_beyond) {
      v.word = Word::kStepDependent;
      add_reason(v, "differs at half the time step");
    } else if (!half_within) {
      v.word = Word::kUnresolved;
      add_reason(v, "within the margin as asked, unresolved at half the time step");
    }
    return;
  }
  // Where runs fail sooner at half the step, what is left of a gap may be too little to judge by.
  if (std::abs(g) <= margin) {
    if (v.word == Word::kDiffers && runs.step_seconds < runs.seconds)
      add_reason(v, "half the time step is not compared: runs fail before the gap is there");
    return;
  }
  const bool is_changed = !step.change.contains(0);
  const std::string lost = is_changed ? loss(g, h, margin) : "";
  // A gap that is not resolved may lie beyond the margin by chance, in one run of some that fell: not to see
  // that run at half the step says nothing of the step.
  const bool is_gone = half_within && (is_changed || v.word == Word::kDiffers);
  if (lost.empty() && !is_gone) return;
  v.word = Word::kStepDependent;
  add_reason(v, is_gone ? "within the margin at half the time step" : lost);
  v.starts_needed.reset();
}

}  // namespace crossgait
