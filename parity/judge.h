// The rule of a verdict on rows of paired numbers that were measured.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "parity/verdict.h"

namespace crossgait {

/// Holds numbers of two engines from the same starts.
struct PairedValues {
  std::vector<double> a, b;

  std::vector<double> differences() const;
};

/// Holds one statistic of one pair of engines, as measured.
struct StatisticRuns {
  Statistic statistic;
  double seconds = 0;       ///< of motion, mean of the pairs
  double step_seconds = 0;  ///< the same of `at_step` and `at_half`
  /// Whether runs failed so early that what they did before says nothing.
  bool is_cut_short = false;
  /// Whether any run as asked, of either engine, has a value: a robot that stays where it is has no heading.
  bool is_defined = false;
  PairedValues as_asked;
  /// Whether a run of each pair as asked ended early, so that it is compared up to then.
  std::vector<bool> ends_early;
  /// The same starts over the time that both engines last at both steps; empty where it was not run.
  PairedValues at_step, at_half, at_quarter;
  /// Whether values are 1 or 0, for an outcome that came about or did not.
  bool is_share = false;
  std::vector<OwnChange> own;
};

/// Judges the rows of any pairs together, as StatisticVerdict says: one result for each, in their order.
/// @param options  of which `looks` and `confidence` are used
std::vector<StatisticVerdict> judge(const std::vector<StatisticRuns>& runs, const VerdictOptions& options);

}  // namespace crossgait
