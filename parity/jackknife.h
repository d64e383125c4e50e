// Confidence intervals from a handful of paired runs, without random numbers.
#pragma once

#include <cstddef>
#include <functional>

namespace crossgait {

/// An estimate and the interval that holds the true value with the chosen confidence.
struct Interval {
  double estimate = 0, low = 0, high = 0;

  double half_width() const noexcept { return (high - low) / 2; }
  bool contains(double value) const noexcept { return low <= value && value <= high; }
};

/// The value that a variable of Student's t distribution stays below with `probability` (Abramowitz and
/// Stegun 1972, 26.7), by bisection on the incomplete beta function; good to 1e-9 relative.
/// @param probability in (0, 1)
/// @param degrees     of freedom, at least 1
double student_quantile(double probability, double degrees);

/// The jackknife (Tukey 1958; Efron and Tibshirani 1993, chapter 11): `estimate(n)` is the statistic of all n
/// samples and `estimate(i)` of all but the i-th; pseudo-values n all - (n - 1) without_i give its standard
/// error, and Student's t with n - 1 degrees of freedom the interval. Unlike a t interval of differences it
/// also holds for ratios, whose denominator is estimated from the same samples; unlike a bootstrap it draws
/// nothing and does not run out of resamples in the far tails that several statistics at once ask for.
/// @param n          samples, at least 2
/// @param confidence two-sided, in (0, 1)
Interval jackknife(std::size_t n, const std::function<double(std::size_t left_out)>& estimate,
                   double confidence);

}  // namespace crossgait
