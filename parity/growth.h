// How the difference of two runs grows: chaos multiplies it by the same factor in every half second.
#pragma once

#include <array>
#include <optional>
#include <vector>

namespace crossgait {

/// Describes an exponential through the differences of two runs.
struct DifferenceGrowth {
  double per_half_second = 1;   ///< factor
  double from_s = 0, to_s = 0;  ///< simulated time that it was fitted over
  double at_from = 0;           ///< the difference that it begins with, m or rad
  double spread = 1;            ///< standard deviation about it, as a factor: 2 is "within a factor of two"

  /// Returns when it reaches `difference`, simulated time, s.
  double reaches_s(double difference) const noexcept;
};

/// Takes differences as they come, step by step.
class GrowthFit {
 public:
  /// @param difference  of positions (m) and angles (rad), the largest
  void add(double time_s, double difference);

  /// Fits the logarithm, by least squares, of the largest difference in every tenth of a second, from where
  /// it is beyond rounding (1e-14) to where it is as large as the motion (0.01). Fast chaos takes less than a
  /// second: then in every twentieth, fiftieth or hundredth. Empty for less than ten of these, or where it
  /// does not grow: by less than a fifth in half a second, or no more than what it scatters by.
  std::optional<DifferenceGrowth> fit() const;

 private:
  struct Window {
    double begin_s = 0, largest = 0;
  };
  using Windows = std::vector<Window>;
  static std::optional<DifferenceGrowth> fit(const Windows& windows, double width);

  static constexpr std::array kWidths{0.1, 0.05, 0.02, 0.01};  // s
  std::array<Windows, kWidths.size()> windows_;                // by width
  double begun_s_ = -1;                                        // beyond rounding
};

}  // namespace crossgait
