#include "parity/row_test.h"

#include <cmath>

#include <fmt/format.h>

#include "parity/paired_shares.h"

namespace crossgait {
namespace {

std::unique_ptr<const PairedTest> shares_of(const PairedValues& values) {
  std::size_t only_a = 0, only_b = 0;
  for (std::size_t k = 0; k < values.a.size(); ++k) {
    only_a += values.a[k] > values.b[k] ? 1 : 0;
    only_b += values.b[k] > values.a[k] ? 1 : 0;
  }
  return std::make_unique<const PairedShares>(values.a.size(), only_a, only_b);
}

}  // namespace

std::unique_ptr<const PairedTest> row_test(const PairedValues& values, bool is_share, Estimand estimand,
                                           double margin) {
  constexpr double kResolution = 0.05;  // of the margin
  if (is_share) return shares_of(values);
  return std::make_unique<const PairedDifferences>(values.differences(), estimand, kResolution * margin);
}

double margin_of(const Statistic& statistic, const PairedValues& values, Estimand estimand, double seconds) {
  const double a = std::abs(estimate_of(values.a, estimand)), b = std::abs(estimate_of(values.b, estimand));
  return statistic.margin.at((a + b) / 2, seconds);
}

void add_reason(StatisticVerdict& verdict, const std::string& reason) {
  verdict.reason += verdict.reason.empty() ? reason : fmt::format("; {}", reason);
}

bool is_alike(bool is_share, const PairedValues& values) noexcept { return is_share && values.a == values.b; }

}  // namespace crossgait
