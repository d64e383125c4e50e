#include "parity/paired_differences.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "parity/distributions.h"

namespace crossgait {
namespace {

// Chosen so that few normal samples are found, and every sample of some runs that fell (the header says how
// few).
constexpr double kTails = 8, kHumps = 6;
constexpr std::size_t kFewestForShape = 6;

double middle_of(const std::vector<double>& sorted) {
  const std::size_t n = sorted.size();
  return n % 2 == 1 ? sorted[n / 2] : (sorted[n / 2 - 1] + sorted[n / 2]) / 2;
}

struct Moments {
  double mean = 0, variance = 0;
};

template <typename Iterator>
Moments moments(Iterator begin, Iterator end) {
  const auto n = static_cast<double>(end - begin);
  Moments m;
  m.mean = std::accumulate(begin, end, 0.0) / n;
  for (Iterator i = begin; i != end; ++i) m.variance += (*i - m.mean) * (*i - m.mean) / std::max(1.0, n - 1);
  return m;
}

bool has_heavy_tails(const std::vector<double>& sorted) {
  const double middle = middle_of(sorted);
  std::vector<double> away;
  for (const double v : sorted) away.push_back(std::abs(v - middle));
  std::sort(away.begin(), away.end());
  constexpr double kNormal = 1.4826;  // of a normal distribution's deviation over its median absolute one
  return away.back() > kTails * kNormal * middle_of(away);
}

bool has_two_humps(const std::vector<double>& sorted) {
  for (auto cut = sorted.begin() + 2; cut + 2 <= sorted.end(); ++cut) {
    const Moments left = moments(sorted.begin(), cut), right = moments(cut, sorted.end());
    const double apart = right.mean - left.mean;
    if (apart > kHumps * std::sqrt((left.variance + right.variance) / 2)) return true;
  }
  return false;
}

}  // namespace

double mean_of(const std::vector<double>& values) noexcept {
  return values.empty() ? 0 : moments(values.begin(), values.end()).mean;
}

double median_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return middle_of(values);
}

std::string_view name(Estimand estimand) noexcept { return estimand == Estimand::kMean ? "mean" : "median"; }

double estimate_of(const std::vector<double>& values, Estimand estimand) {
  return estimand == Estimand::kMean ? mean_of(values) : median_of(values);
}

std::string_view name(Shape shape) noexcept {
  constexpr std::array<std::string_view, 3> kNames{"regular", "heavy tails", "two humps"};
  return kNames[static_cast<std::size_t>(shape)];
}

Shape shape_of(const std::vector<double>& sample, double margin) {
  if (sample.size() < kFewestForShape) return Shape::kRegular;
  std::vector<double> sorted = sample;
  std::sort(sorted.begin(), sorted.end());
  if (sorted.back() - sorted.front() <= margin / 2) return Shape::kRegular;
  if (has_two_humps(sorted)) return Shape::kTwoHumps;
  return has_heavy_tails(sorted) ? Shape::kHeavyTails : Shape::kRegular;
}

std::size_t fewest_for_median(double error) noexcept {
  return static_cast<std::size_t>(std::ceil(1 - std::log2(error)));
}

PairedDifferences::PairedDifferences(std::vector<double> differences, Estimand estimand, double resolution)
    : sorted_(std::move(differences)), estimand_(estimand) {
  std::sort(sorted_.begin(), sorted_.end());
  const Moments m = moments(sorted_.begin(), sorted_.end());
  mean_ = m.mean;
  deviation_ = std::sqrt(m.variance);
  allowance_ = std::min(resolution, deviation_);
}

double PairedDifferences::estimate() const noexcept {
  return estimand_ == Estimand::kMean ? mean_ : middle_of(sorted_);
}

Interval PairedDifferences::interval(double confidence) const {
  const std::size_t n = sorted_.size();
  if (estimand_ == Estimand::kMean) {
    const double half = student_quantile((1 + confidence) / 2, static_cast<double>(n - 1)) * deviation_ /
                            std::sqrt(static_cast<double>(n)) +
                        allowance_;
    return {mean_, mean_ - half, mean_ + half};
  }
  // Between the k-th from below and from above: a median lies outside if fewer than k + 1 are on one side.
  std::size_t k = 0;
  while (2 * (k + 1) < n && 2 * (1 - binomial_tail(k + 2, n, 0.5)) <= 1 - confidence) ++k;
  return {estimate(), sorted_[k], sorted_[n - 1 - k]};
}

double PairedDifferences::p_past(double limit, double side) const {
  const std::size_t n = sorted_.size();
  if (estimand_ == Estimand::kMean) {
    const double error = deviation_ / std::sqrt(static_cast<double>(n)),
                 way = side * (mean_ - limit) - allowance_;
    if (error == 0) return way > 0 ? 0 : 1;
    return student_tail(way / error, static_cast<double>(n - 1));
  }
  const auto past = static_cast<std::size_t>(
      std::count_if(sorted_.begin(), sorted_.end(), [=](double v) { return side * (v - limit) > 0; }));
  return binomial_tail(past, n, 0.5);
}

std::optional<std::size_t> PairedDifferences::enough(double margin, double tail_within,
                                                     double tail_beyond) const {
  const double room = std::abs(margin - std::abs(mean_)) - allowance_;
  const double tail = std::abs(mean_) < margin ? tail_within : tail_beyond;
  const auto fits = [&](std::size_t n) {
    const auto count = static_cast<double>(n);
    return student_quantile(1 - tail, count - 1) * deviation_ / std::sqrt(count) < room;
  };
  std::size_t high = sorted_.size() + 1;
  while (high < kMostStarts && !fits(high)) high = std::min(2 * high, kMostStarts);
  if (!fits(high)) return std::nullopt;
  std::size_t low = sorted_.size();
  while (high - low > 1) {
    const std::size_t middle = low + (high - low) / 2;
    (fits(middle) ? high : low) = middle;
  }
  return high;
}

}  // namespace crossgait
