// The few probability distributions that exact and t intervals need.
#pragma once

#include <cstddef>

namespace crossgait {

/// Returns the probability that a variable of Student's t distribution exceeds `t` (Abramowitz and Stegun
/// 1972, 26.7); good to 1e-13. @param degrees  of freedom, at least 1
double student_tail(double t, double degrees);

/// Returns the value that such a variable stays below with `probability`, by bisection; good to 1e-9
/// relative.
/// @param probability in (0, 1)
/// @param degrees     of freedom, at least 1
double student_quantile(double probability, double degrees);

/// Returns the probability of at least `successes` of `trials` that succeed with `share` each.
double binomial_tail(std::size_t successes, std::size_t trials, double share);

/// Returns Clopper and Pearson's exact limits (1934) of a share of which `successes` of `trials` were seen:
/// below the lower one, and above the upper one, as many or as few come with less than `tail` probability.
double share_lower_limit(std::size_t successes, std::size_t trials, double tail);
double share_upper_limit(std::size_t successes, std::size_t trials, double tail);

}  // namespace crossgait
