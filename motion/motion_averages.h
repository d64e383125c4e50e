// The statistics of several motions, summed up as their rows say (motion/statistic_rows.h).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "motion/statistic_rows.h"

namespace crossgait {

/// Holds mean and deviation of the sample, zero for a single value.
struct MeanAndDeviation {
  double mean = 0, deviation = 0;
};
/// Averages at least one value.
MeanAndDeviation mean_and_deviation(std::span<const double> values) noexcept;

/// Holds what a set of motions comes to: a mean and deviation, or a sum, for every row that has one.
/// `of` finds them by the member of MotionSummary. @throws std::logic_error if the member's row has none
class MotionAverages {
 public:
  /// Sums up no motion: zeros, and nothing where a motion may have no value.
  MotionAverages();
  /// @param motions  at least one
  explicit MotionAverages(std::span<const MotionSummary* const> motions);

  MeanAndDeviation& of(double MotionSummary::*member) { return *at(member).mean; }
  MeanAndDeviation& of(LegArray<double> MotionSummary::*member) { return *at(member).mean; }
  /// Averages a statistic over those motions that have a value; empty where none has.
  std::optional<MeanAndDeviation>& of(std::optional<double> MotionSummary::*member) {
    return at(member).mean;
  }
  std::int64_t& of(std::int64_t MotionSummary::*member) { return at(member).sum; }

  const MeanAndDeviation& of(double MotionSummary::*member) const { return *at(member).mean; }
  const MeanAndDeviation& of(LegArray<double> MotionSummary::*member) const { return *at(member).mean; }
  const std::optional<MeanAndDeviation>& of(std::optional<double> MotionSummary::*member) const {
    return at(member).mean;
  }
  std::int64_t of(std::int64_t MotionSummary::*member) const { return at(member).sum; }

  /// Holds a row's average, as its `average.how` says.
  struct Value {
    std::optional<MeanAndDeviation> mean;
    std::int64_t sum = 0;
  };
  const Value& of(const StatisticRow& row) const { return at(row.source); }

 private:
  const Value& at(const StatisticSource& source) const;
  Value& at(const StatisticSource& source);

  std::vector<Value> values_;  ///< in the order of averaged_statistics()
};

}  // namespace crossgait
