#include "parity/growth.h"

#include <algorithm>
#include <cmath>

namespace crossgait {
namespace {

constexpr double kGrowthWindow = 0.1;      // s
constexpr double kBeyondRounding = 1e-14;  // m, rad
constexpr double kAsLarge = 1e-2;          // m, rad
constexpr std::size_t kFewest = 10;        // windows
constexpr double kGrows = 1.2;             // in half a second

}  // namespace

double DifferenceGrowth::reaches_s(double difference) const noexcept {
  return from_s + 0.5 * std::log(difference / at_from) / std::log(per_half_second);
}

void GrowthFit::add(double time_s, double difference) {
  // A difference that is none has no logarithm.
  if (windows_.empty() || time_s >= windows_.back().begin_s + kGrowthWindow) windows_.push_back({time_s, 0});
  windows_.back().largest = std::max(windows_.back().largest, difference);
}

std::optional<DifferenceGrowth> GrowthFit::fit() const {
  const auto begins = [](const Window& w) { return w.largest > kBeyondRounding; };
  const auto ends = [](const Window& w) { return w.largest >= kAsLarge; };
  const auto first = std::find_if(windows_.begin(), windows_.end(), begins);
  const auto last = std::find_if(first, windows_.end(), ends);
  const auto n = static_cast<std::size_t>(last - first);
  if (n < kFewest) return std::nullopt;
  double t = 0, y = 0;
  for (auto w = first; w != last; ++w) {
    t += w->begin_s / static_cast<double>(n);
    y += std::log(std::max(w->largest, kBeyondRounding)) / static_cast<double>(n);
  }
  double tt = 0, ty = 0;
  for (auto w = first; w != last; ++w) {
    const double dt = w->begin_s - t;
    tt += dt * dt;
    ty += dt * (std::log(std::max(w->largest, kBeyondRounding)) - y);
  }
  const double slope = ty / tt;
  double squares = 0;
  for (auto w = first; w != last; ++w) {
    const double off = std::log(std::max(w->largest, kBeyondRounding)) - y - slope * (w->begin_s - t);
    squares += off * off;
  }
  // The slope's standard error: what is not clearly beyond it is no growth.
  const double deviation = std::sqrt(squares / static_cast<double>(n - 2));
  const double factor = std::exp(0.5 * slope);
  if (slope <= 2 * deviation / std::sqrt(tt) || factor < kGrows) return std::nullopt;
  return DifferenceGrowth{factor, first->begin_s, (last - 1)->begin_s + kGrowthWindow,
                          std::exp(y + slope * (first->begin_s - t)), std::exp(deviation)};
}

}  // namespace crossgait
