// When feet were on the ground, from the rows of a trace.
#pragma once

#include <cstddef>
#include <vector>

namespace crossgait {

/// Holds a time in which a foot is on the ground.
struct Stance {
  double begin = 0, end = 0;  ///< s
};

/// Default of `shortest`, s: hard contacts bounce for some milliseconds.
inline constexpr double kShortestContact = 0.02;

/// Returns when a row ends, s: as the next begins; the last row lasts as long as the one before.
double row_end(const std::vector<double>& time, std::size_t row);

/// @param contact  1 where there is contact, one per time
/// @param shortest  gaps, then stances, below it are left out, s
std::vector<Stance> stances(const std::vector<double>& time, const std::vector<double>& contact,
                            double shortest);

}  // namespace crossgait
