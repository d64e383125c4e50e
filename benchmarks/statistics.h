// What repeated measurements come to: quartiles, orders of convergence, and the clock for timing them.
#pragma once

#include <vector>

namespace crossgait::benchmarks {

/// Returns the CPU time of the calling thread, s. Other programs on the machine do not add to it, as they do
/// to the time on the wall.
double thread_seconds() noexcept;

/// Holds quartiles.
struct Quartiles {
  double low = 0, median = 0, high = 0;
};

/// Returns the value that a `share` of `values` lies below, interpolated between neighbours. @pre not empty
double quantile(std::vector<double> values, double share);
/// @pre not empty
Quartiles quartiles(const std::vector<double>& values);

/// Fits p of error = C step^p, by least squares over the logarithms; signs do not count. NaN with fewer than
/// two errors that are not zero.
double convergence_order(const std::vector<double>& steps, const std::vector<double>& errors);

}  // namespace crossgait::benchmarks
