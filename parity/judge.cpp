#include "parity/judge.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "parity/distributions.h"

namespace crossgait {
namespace {

using Test = std::variant<PairedDifferences, PairedShares>;

PairedShares shares_of(const PairedValues& values) {
  std::size_t only_a = 0, only_b = 0;
  for (std::size_t k = 0; k < values.a.size(); ++k) {
    only_a += values.a[k] > values.b[k] ? 1 : 0;
    only_b += values.b[k] > values.a[k] ? 1 : 0;
  }
  return {values.a.size(), only_a, only_b};
}

Test test_of(const PairedValues& values, bool is_share, Estimand estimand) {
  if (is_share) return shares_of(values);
  return PairedDifferences(values.differences(), estimand);
}

Interval interval(const Test& test, double confidence) {
  return std::visit([=](const auto& t) { return t.interval(confidence); }, test);
}
double p_beyond(const Test& test, double margin) {
  return std::visit([=](const auto& t) { return t.p_beyond(margin); }, test);
}
double p_within(const Test& test, double margin) {
  return std::visit([=](const auto& t) { return t.p_within(margin); }, test);
}

// One row on its way to a word.
struct Row {
  const StatisticRuns* runs;
  StatisticVerdict verdict;
  std::optional<Test> test;  // empty with too few starts
  double p = 1;              // against "within the margin"
  double level = 0;          // error of its simultaneous interval
  bool rejected = false;     // by Holm's tests
};

Row begin(const StatisticRuns& runs) {
  Row row;
  row.runs = &runs;
  StatisticVerdict& v = row.verdict;
  v.statistic = runs.statistic;
  v.own = runs.own;
  v.pairs = runs.as_asked.a.size();
  if (v.pairs == 0) return row;
  const double size = (std::abs(mean_of(runs.as_asked.a)) + std::abs(mean_of(runs.as_asked.b))) / 2;
  v.margin = runs.statistic.margin.at(size, runs.seconds);
  const Shape shape = runs.is_share ? Shape::kRegular : shape_of(runs.as_asked.differences(), v.margin);
  if (shape != Shape::kRegular) {
    v.estimand = Estimand::kMedian;
    v.reason = fmt::format("{}: the median is judged", name(shape));
  }
  const auto middle = [&](const std::vector<double>& values) {
    return v.estimand == Estimand::kMean ? mean_of(values) : median_of(values);
  };
  v.value_a = middle(runs.as_asked.a);
  v.value_b = middle(runs.as_asked.b);
  if (v.pairs < 2) return row;
  row.test = test_of(runs.as_asked, runs.is_share, v.estimand);
  if (v.pairs >= kFewestStarts) row.p = p_beyond(*row.test, v.margin);
  return row;
}

// Holm's step-down tests (1979): the smallest P value against error / m, the next against error / (m - 1), as
// long as each is rejected. Rows that are not share what is left.
void test_together(std::vector<Row>& rows, double error) {
  std::vector<std::size_t> order(rows.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t i, std::size_t k) { return rows[i].p < rows[k].p; });
  bool rejecting = true;
  double level = error;
  for (std::size_t j = 0; j < order.size(); ++j) {
    Row& row = rows[order[j]];
    if (rejecting) level = error / static_cast<double>(rows.size() - j);
    rejecting = rejecting && row.p <= level;
    row.rejected = rejecting;
    row.level = level;
  }
}

void add_reason(StatisticVerdict& v, const std::string& reason) {
  v.reason += v.reason.empty() ? reason : fmt::format("; {}", reason);
}

// Nobody failed: nothing differs, and what could have been missed is stated.
bool never_came_about(const Row& row) {
  const auto none = [](const std::vector<double>& values) {
    return std::all_of(values.begin(), values.end(), [](double v) { return v == 0; });
  };
  return row.runs->is_share && none(row.runs->as_asked.a) && none(row.runs->as_asked.b);
}

void find_word(Row& row, double tail) {
  StatisticVerdict& v = row.verdict;
  if (row.test) {
    v.gap = interval(*row.test, 1 - row.level);
    v.equivalence = interval(*row.test, 1 - 2 * tail);
  }
  if (v.pairs < kFewestStarts) {
    add_reason(v, v.pairs == 0
                      ? "no start has a value in both engines"
                      : fmt::format("fewer than {} starts have a value in both engines", kFewestStarts));
    v.starts_needed = v.pairs == 0 ? std::nullopt : std::optional(kFewestStarts);
  } else if (row.rejected) {
    v.word = Word::kDiffers;
  } else if (p_within(*row.test, v.margin) <= tail) {
    v.word = Word::kAgrees;
  } else if (never_came_about(row)) {
    v.word = Word::kAgrees;
    add_reason(v, fmt::format("none seen: a share above {:.0f} % is excluded",
                              100 * share_upper_limit(0, v.pairs, tail)));
  } else {
    add_reason(v, "the interval crosses the margin");
    v.starts_needed =
        std::visit([&](const auto& t) { return t.enough(v.margin, tail, row.level / 2); }, *row.test);
  }
}

std::vector<double> changes(const PairedValues& from, const PairedValues& to) {
  std::vector<double> result = to.differences();
  const std::vector<double> before = from.differences();
  for (std::size_t k = 0; k < result.size(); ++k) result[k] -= before[k];
  return result;
}

// What three steps lead to, where the gap falls in with one order.
void extrapolate(const Row& row, double from, double half, StepCheck& step) {
  const PairedValues& quarter = row.runs->at_quarter;
  if (quarter.a.size() < 2) return;
  const Test test = test_of(quarter, row.runs->is_share, row.verdict.estimand);
  step.quarter = interval(test, 0.95).estimate;
  const double first = half - from, second = *step.quarter - half;
  if (first * second <= 0 || std::abs(second) >= std::abs(first)) return;  // not on its way to a limit
  const double ratio = first / second;                                     // 2^order
  step.order = std::log2(ratio);
  step.extrapolated = *step.quarter + second / (ratio - 1);
}

// What half the step changes of the word, never into *agrees*.
void check_step(Row& row, double tail) {
  const StatisticRuns& runs = *row.runs;
  StatisticVerdict& v = row.verdict;
  if (runs.at_half.a.size() < kFewestStarts || v.pairs < kFewestStarts) return;
  const Test as_asked = test_of(runs.at_step, runs.is_share, v.estimand),
             half = test_of(runs.at_half, runs.is_share, v.estimand);
  const Interval from = interval(as_asked, 1 - row.level);
  StepCheck step{interval(half, 1 - row.level),
                 PairedDifferences(changes(runs.at_step, runs.at_half), v.estimand).interval(1 - row.level),
                 {},
                 {},
                 {}};
  extrapolate(row, from.estimate, step.half.estimate, step);
  const bool half_within = p_within(half, v.margin) <= tail,
             half_beyond = p_beyond(half, v.margin) <= row.level;
  const double g = from.estimate, h = step.half.estimate;
  const bool resolved = !step.change.contains(0), turned = g * h <= 0 || std::abs(h) <= std::abs(g) / 2;
  const bool outside = v.word == Word::kDiffers || (v.word == Word::kUnresolved && std::abs(g) > v.margin);
  if (v.word == Word::kAgrees && half_beyond) {
    v.word = Word::kStepDependent;
    add_reason(v, "differs at half the time step");
  } else if (v.word == Word::kAgrees && !half_within && !never_came_about(row)) {
    v.word = Word::kUnresolved;
    add_reason(v, "within the margin as asked, unresolved at half the time step");
  } else if (outside && ((resolved && turned) || (v.word == Word::kDiffers && half_within))) {
    v.word = Word::kStepDependent;
    add_reason(v, half_within ? "within the margin at half the time step"
                              : "half the time step takes half of it or more");
    v.starts_needed.reset();
  }
  v.step = step;
}

}  // namespace

std::vector<double> PairedValues::differences() const {
  std::vector<double> result(a.size());
  for (std::size_t k = 0; k < a.size(); ++k) result[k] = b[k] - a[k];
  return result;
}

std::vector<StatisticVerdict> judge(const std::vector<StatisticRuns>& runs, const VerdictOptions& options) {
  const auto looks = static_cast<double>(options.looks);
  const double tail = kEquivalenceTail / looks;
  std::vector<Row> rows;
  for (const StatisticRuns& row : runs) rows.push_back(begin(row));
  test_together(rows, (1 - options.confidence) / looks);
  std::vector<StatisticVerdict> verdicts;
  for (Row& row : rows) {
    find_word(row, tail);
    check_step(row, tail);
    verdicts.push_back(std::move(row.verdict));
  }
  return verdicts;
}

}  // namespace crossgait
