// Units in which a number would have been right.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <fmt/format.h>

namespace crossgait {

/// Names a unit in which a number would have been right, and by which factor it is too large as it is.
struct Unit {
  double factor;
  const char* words;
};
inline constexpr std::array kInertiaUnits{Unit{1e3, "g m^2"}, Unit{1e4, "kg cm^2"}, Unit{1e6, "kg mm^2"},
                                          Unit{1e7, "g cm^2"}, Unit{1e9, "g mm^2"}};
inline constexpr std::array kLengthUnits{Unit{1e3, "mm"}, Unit{100, "cm"}, Unit{39.37, "inches"}};

/// Says "moments in kg mm^2": the unit that makes most of being `times` too large, if it is near one.
template <std::size_t N>
std::string likely_unit(const char* what, const std::array<Unit, N>& units, double times) {
  constexpr double kNear = 0.75;  // decades
  const auto off = [&](const Unit& unit) { return std::abs(std::log10(times / unit.factor)); };
  const Unit& best = *std::ranges::min_element(units, {}, off);
  return off(best) < kNear ? fmt::format("{} in {}", what, best.words) : "";
}

}  // namespace crossgait
