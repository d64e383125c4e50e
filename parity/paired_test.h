// What pairs of runs say of the difference that lies behind them, against a margin, whatever kind it is.
#pragma once

#include <cstddef>
#include <optional>

namespace crossgait {

/// Holds the true value with the confidence that was asked for.
struct Interval {
  double estimate = 0, low = 0, high = 0;

  double half_width() const noexcept { return (high - low) / 2; }
  bool contains(double value) const noexcept { return low <= value && value <= high; }
  /// Tells whether the whole interval lies in (-margin, margin), or beyond one end of that.
  bool within(double margin) const noexcept { return low > -margin && high < margin; }
  bool beyond(double margin) const noexcept { return low > margin || high < -margin; }
};

/// Starts beyond which nobody is told how many would do.
inline constexpr std::size_t kMostStarts = 10000;

/// Tests a difference that pairs were drawn of.
class PairedTest {
 public:
  virtual ~PairedTest() = default;

  virtual double estimate() const noexcept = 0;
  /// Returns a two-sided interval.
  virtual Interval interval(double confidence) const = 0;
  /// Returns how many pairs like these would tell which it is: the fewest with which an interval as wide as
  /// theirs would lie within the margin, or beyond it; empty if that takes more than kMostStarts.
  /// @param tail_within,tail_beyond  error of each side of either interval
  virtual std::optional<std::size_t> enough(double margin, double tail_within, double tail_beyond) const = 0;

  /// Returns the P value against "at most the margin, either way": twice the smaller tail.
  double p_beyond(double margin) const;
  /// Returns the P value against "the margin or more, either way": two one-sided tests (Schuirmann 1987).
  double p_within(double margin) const;

 protected:
  PairedTest() = default;
  PairedTest(const PairedTest&) = default;
  PairedTest& operator=(const PairedTest&) = default;
  PairedTest(PairedTest&&) = default;
  PairedTest& operator=(PairedTest&&) = default;

 private:
  /// Returns the P value against "at most `limit`", and against "at least".
  virtual double p_above(double limit) const = 0;
  virtual double p_below(double limit) const = 0;
};

}  // namespace crossgait
