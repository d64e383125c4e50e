#include "motion/motion_averages.h"

#include <cmath>
#include <stdexcept>
#include <utility>

namespace crossgait {
namespace {

// Of those motions that have a value.
std::optional<MeanAndDeviation> average(const StatisticRow& row,
                                        std::span<const MotionSummary* const> motions) {
  std::vector<double> values;
  for (const MotionSummary* motion : motions) {
    if (const std::optional<double> value = number_of(row, *motion)) values.push_back(*value);
  }
  if (values.empty()) return std::nullopt;
  return mean_and_deviation(values);
}

bool may_be_absent(const StatisticRow& row) {
  return std::holds_alternative<std::optional<double> MotionSummary::*>(row.source);
}

}  // namespace

MeanAndDeviation mean_and_deviation(std::span<const double> values) noexcept {
  const auto n = static_cast<double>(values.size());
  double sum = 0, squares = 0;
  for (const double v : values) sum += v;
  const double mean = sum / n;
  for (const double v : values) squares += (v - mean) * (v - mean);
  return {mean, n > 1 ? std::sqrt(squares / (n - 1)) : 0};
}

MotionAverages::MotionAverages() {
  for (const StatisticRow* row : averaged_statistics()) {
    values_.emplace_back();
    if (!may_be_absent(*row)) values_.back().mean.emplace();
  }
}

MotionAverages::MotionAverages(std::span<const MotionSummary* const> motions) {
  for (const StatisticRow* row : averaged_statistics()) {
    values_.push_back({average(*row, motions), 0});
    if (row->average.how != OverEpisodes::kSum) continue;
    const auto count = std::get<std::int64_t MotionSummary::*>(row->source);
    for (const MotionSummary* motion : motions) values_.back().sum += motion->*count;
  }
}

const MotionAverages::Value& MotionAverages::at(const StatisticSource& source) const {
  const std::vector<const StatisticRow*>& rows = averaged_statistics();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i]->source == source) return values_[i];
  }
  throw std::logic_error("a member of MotionSummary that is not averaged (motion/statistic_rows.cpp)");
}

MotionAverages::Value& MotionAverages::at(const StatisticSource& source) {
  return const_cast<Value&>(
      std::as_const(*this).at(source));  // NOLINT(cppcoreguidelines-pro-type-const-cast)
}

}  // namespace crossgait
