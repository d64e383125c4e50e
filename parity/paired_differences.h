// What paired differences say of the difference that lies behind them, against a margin.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace crossgait {

/// An interval that holds the true value with the confidence that was asked for.
struct Interval {
  double estimate = 0, low = 0, high = 0;

  double half_width() const noexcept { return (high - low) / 2; }
  bool contains(double value) const noexcept { return low <= value && value <= high; }
  /// The whole of it lies in (-margin, margin), or beyond one end of that.
  bool within(double margin) const noexcept { return low > -margin && high < margin; }
  bool beyond(double margin) const noexcept { return low > margin || high < -margin; }
};

/// Starts beyond which nobody is told how many would do.
inline constexpr std::size_t kMostStarts = 10000;

/// Zero for none.
double mean_of(const std::vector<double>& values) noexcept;
double median_of(std::vector<double> values);

/// What is estimated.
enum class Estimand {
  kMean,    ///< with Student's t
  kMedian,  ///< with the sign test's exact interval between order statistics, whatever the distribution
};
/// "mean", "median"
std::string_view name(Estimand estimand) noexcept;

/// What a sample looks like, as far as it matters for the interval of its mean.
enum class Shape { kRegular, kHeavyTails, kTwoHumps };
/// "regular", "heavy tails", "two humps"
std::string_view name(Shape shape) noexcept;

/// Looks for what makes an interval of the mean untrue. *Heavy tails*: a sample that lies more than 8 of the
/// sample's (normal-consistent) median absolute deviations from its median. *Two humps*: a split into two
/// parts of two or more whose means lie more than 6 times their root mean square deviation apart (Ashman's D
/// beyond 6; Ashman, Bird and Zepf 1994). Neither is looked for where the whole sample is narrower than half
/// of the margin, or has fewer than six. Of normal samples of 6, 12 and 24 it finds something in less than
/// 12, 4 and 1 % (tests/parity/paired_differences_test.cpp).
Shape shape_of(const std::vector<double>& sample, double margin);

/// Differences of pairs, of which all are independent draws.
class PairedDifferences {
 public:
  /// @param differences  two or more
  explicit PairedDifferences(std::vector<double> differences, Estimand estimand = Estimand::kMean);

  std::size_t size() const noexcept { return sorted_.size(); }
  double estimate() const noexcept;
  /// Two-sided. The median's is the narrowest between order statistics that has the confidence; the whole
  /// range where none has.
  Interval interval(double confidence) const;
  /// P value against "at most the margin, either way": twice the smaller tail.
  double p_beyond(double margin) const;
  /// P value against "the margin or more, either way": two one-sided tests (Schuirmann 1987).
  double p_within(double margin) const;
  /// How many pairs like these would tell which it is: the fewest with which an interval as wide as theirs
  /// would lie within the margin, or beyond it; empty if that takes more than kMostStarts.
  /// @param tail_within,tail_beyond  error of each side of either interval
  std::optional<std::size_t> enough(double margin, double tail_within, double tail_beyond) const;

 private:
  /// P value against "at least `limit`"; the mirror image asks of the negated sample.
  double p_below(double limit) const;
  double p_above(double limit) const;

  std::vector<double> sorted_;
  Estimand estimand_;
  double mean_ = 0, deviation_ = 0;  ///< of the sample
};

}  // namespace crossgait
