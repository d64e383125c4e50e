// What blocks of an observation need to know beside the robot, and how terms that remember are laid out.
#pragma once

#include <string_view>
#include <vector>

namespace crossgait {

/// Says how `history` of observation terms is laid out and begins.
struct HistorySettings {
  enum class By { kTerm, kFrame };  ///< all of a term's instants together, or all terms of an instant
  enum class Order { kNewestFirst, kOldestFirst };
  enum class Before { kFirst, kZeros };  ///< what was before the episode: its first observation, or nothing
  By by = By::kTerm;
  Order order = Order::kNewestFirst;
  Before before = Before::kFirst;

  bool operator==(const HistorySettings&) const = default;
};
std::string_view name(HistorySettings::By by) noexcept;
std::string_view name(HistorySettings::Order order) noexcept;
std::string_view name(HistorySettings::Before before) noexcept;

/// Describes a clock that only tells the time: it moves nothing.
struct GaitClock {
  double frequency = 0;        ///< Hz
  std::vector<double> phases;  ///< at the episode's beginning, in cycles; one pair of numbers each

  bool operator==(const GaitClock&) const = default;
};

/// Describes ground below a grid that goes with the base: its height less the ground's, less `offset`.
struct HeightScan {
  std::vector<double> x, y;  ///< ahead and left of the base, m
  double offset = 0;         ///< m
  bool x_first = true;       ///< x changes fastest

  bool operator==(const HeightScan&) const = default;
};

struct ObservationSettings {
  HistorySettings history;
  GaitClock clock;
  HeightScan height_scan;
  std::vector<double> constants;

  bool operator==(const ObservationSettings&) const = default;
};

}  // namespace crossgait
