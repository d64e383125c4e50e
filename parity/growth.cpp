#include "parity/growth.h"

#include <algorithm>
#include <cmath>

namespace crossgait {
namespace {

constexpr double kBeyondRounding = 1e-14;  // m, rad
constexpr double kAsLarge = 1e-2;          // m, rad
constexpr std::ptrdiff_t kFewest = 10;     // windows
constexpr double kGrows = 1.2;             // in half a second

template <typename Windows>
auto begin_of(const Windows& windows) {
  return std::find_if(windows.begin(), windows.end(),
                      [](const auto& w) { return w.largest > kBeyondRounding; });
}
template <typename Windows>
auto end_of(const Windows& windows) {
  return std::find_if(begin_of(windows), windows.end(), [](const auto& w) { return w.largest >= kAsLarge; });
}

}  // namespace

double DifferenceGrowth::reaches_s(double difference) const noexcept {
  return from_s + 0.5 * std::log(difference / at_from) / std::log(per_half_second);
}

void GrowthFit::add(double time_s, double difference) {
  if (begun_s_ < 0 && difference > kBeyondRounding) begun_s_ = time_s;
  // Enough of the widest windows: narrower ones would only grow in number.
  const double enough_s = (static_cast<double>(kFewest) + 2) * kWidths.front();
  const bool is_slow = begun_s_ >= 0 && time_s > begun_s_ + enough_s;
  for (std::size_t i = 0; i < kWidths.size(); ++i) {
    Windows& windows = windows_[i];
    // What is before the beginning is of no use to narrow windows.
    if (i > 0 && (is_slow || begun_s_ < 0)) continue;
    if (windows.empty() || time_s >= windows.back().begin_s + kWidths[i]) windows.push_back({time_s, 0});
    windows.back().largest = std::max(windows.back().largest, difference);
  }
}

std::optional<DifferenceGrowth> GrowthFit::fit() const {
  // Narrower windows where wider ones are too few because it was as large as the motion so soon; what is only
  // seen for a short time may be no growth at all.
  for (std::size_t i = 0; i < kWidths.size(); ++i) {
    const Windows& windows = windows_[i];
    const auto n = std::distance(begin_of(windows), end_of(windows));
    if (n >= kFewest) return fit(windows, kWidths[i]);
    if (end_of(windows) == windows.end()) return std::nullopt;
  }
  return std::nullopt;
}

std::optional<DifferenceGrowth> GrowthFit::fit(const Windows& windows, double width) {
  const auto first = begin_of(windows), last = end_of(windows);
  const auto n = last - first;
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
  // A difference that is none has no logarithm: it counts as rounding. The slope's standard error: what is
  // not clearly beyond it is no growth.
  const double deviation = std::sqrt(squares / static_cast<double>(n - 2));
  const double factor = std::exp(0.5 * slope);
  if (slope <= 2 * deviation / std::sqrt(tt) || factor < kGrows) return std::nullopt;
  return DifferenceGrowth{factor, first->begin_s, (last - 1)->begin_s + width,
                          std::exp(y + slope * (first->begin_s - t)), std::exp(deviation)};
}

}  // namespace crossgait
