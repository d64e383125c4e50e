#include "parity/row_test.h"

#include <cmath>

#include <fmt/format.h>

namespace crossgait {
namespace {

PairedShares shares_of(const PairedValues& values) {
  std::size_t only_a = 0, only_b = 0;
  for (std::size_t k = 0; k < values.a.size(); ++k) {
    only_a += values.a[k] > values.b[k] ? 1 : 0;
    only_b += values.b[k] > values.a[k] ? 1 : 0;
  }
  return {values.a.size(), only_a, only_b};
}

double size_of(const std::vector<double>& values, Estimand estimand) {
  return std::abs(estimand == Estimand::kMean ? mean_of(values) : median_of(values));
}

}  // namespace

RowTest row_test(const PairedValues& values, bool is_share, Estimand estimand) {
  if (is_share) return shares_of(values);
  return PairedDifferences(values.differences(), estimand);
}

Interval interval(const RowTest& test, double confidence) {
  return std::visit([=](const auto& t) { return t.interval(confidence); }, test);
}
double p_beyond(const RowTest& test, double margin) {
  return std::visit([=](const auto& t) { return t.p_beyond(margin); }, test);
}
double p_within(const RowTest& test, double margin) {
  return std::visit([=](const auto& t) { return t.p_within(margin); }, test);
}

double margin_of(const Statistic& statistic, const PairedValues& values, Estimand estimand, double seconds) {
  return statistic.margin.at((size_of(values.a, estimand) + size_of(values.b, estimand)) / 2, seconds);
}

void add_reason(StatisticVerdict& verdict, const std::string& reason) {
  verdict.reason += verdict.reason.empty() ? reason : fmt::format("; {}", reason);
}

bool is_alike(bool is_share, const PairedValues& values) noexcept { return is_share && values.a == values.b; }

}  // namespace crossgait
