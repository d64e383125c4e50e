// Paired differences of numbers: their mean, or their median where a mean would not do.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "parity/paired_test.h"

namespace crossgait {

/// Returns the mean, zero for none.
double mean_of(const std::vector<double>& values) noexcept;
double median_of(std::vector<double> values);

/// Says what is estimated.
enum class Estimand {
  kMean,    ///< with Student's t
  kMedian,  ///< with the sign test's exact interval between order statistics, whatever the distribution
};
/// Names an estimand: "mean", "median".
std::string_view name(Estimand estimand) noexcept;
/// Returns the mean or the median of some values.
double estimate_of(const std::vector<double>& values, Estimand estimand);

/// Says what a sample looks like, as far as it matters for the interval of its mean.
enum class Shape { kRegular, kHeavyTails, kTwoHumps };
/// Names a shape: "regular", "heavy tails", "two humps".
std::string_view name(Shape shape) noexcept;

/// Looks for what makes an interval of the mean untrue. *Heavy tails*: a sample that lies more than 8 of the
/// sample's (normal-consistent) median absolute deviations from its median. *Two humps*: a split into two
/// parts of two or more whose means lie more than 6 times their root mean square deviation apart (Ashman's D
/// beyond 6; Ashman, Bird and Zepf 1994). Neither is looked for where the whole sample is narrower than half
/// of the margin, or has fewer than six. Of normal samples of 6, 12 and 24 it finds something in less than
/// 12, 4 and 1 % (tests/parity/paired_differences_test.cpp).
Shape shape_of(const std::vector<double>& sample, double margin);

/// Returns how few differences let the sign test tell a median from a limit with an error up to `error`, both
/// sides together: 2 / 2^n. With fewer the interval is the sample's range, and holds less often.
std::size_t fewest_for_median(double error) noexcept;

/// Holds differences of pairs, of which all are independent draws. The median's interval is the narrowest
/// between order statistics that has the confidence; the whole range where none has (`fewest_for_median`).
///
/// A mean's interval is Student's, wider by an allowance at either end: the resolution, or the sample's
/// deviation where that is less. Differences that are skewed or tied make Student's intervals too short by a
/// share of their deviation; where that is small beside the resolution nobody can care, so it is allowed for.
class PairedDifferences final : public PairedTest {
 public:
  /// @param differences  two or more
  /// @param resolution   what is too small to matter, in the unit of the differences
  explicit PairedDifferences(std::vector<double> differences, Estimand estimand = Estimand::kMean,
                             double resolution = 0);

  double estimate() const noexcept override;
  Interval interval(double confidence) const override;
  std::optional<std::size_t> enough(double margin, double tail_within, double tail_beyond) const override;

 private:
  double p_above(double limit) const override { return p_past(limit, 1); }
  double p_below(double limit) const override { return p_past(limit, -1); }
  /// Returns the P value against "not past `limit`", upwards (side 1) or downwards (-1).
  double p_past(double limit, double side) const;

  std::vector<double> sorted_;
  Estimand estimand_;
  double mean_ = 0, deviation_ = 0;  ///< of the sample
  double allowance_ = 0;             ///< of the mean
};

}  // namespace crossgait
