#include "parity/judge.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "parity/distributions.h"
#include "parity/row_test.h"
#include "parity/step_check.h"

namespace crossgait {
namespace {

// One row on its way to a word.
struct Row {
  const StatisticRuns* runs;
  StatisticVerdict verdict;
  std::unique_ptr<const PairedTest> test;  // empty with too few starts
  double p = 1;                            // against "within the margin"
  double level = 0;                        // error that Holm's tests leave for it
  bool rejected = false;                   // by them
};

// Why the median is judged and not the mean; empty where it is not.
std::string reason_for_median(const StatisticRuns& runs, double margin) {
  if (runs.is_share) return "";
  if (std::find(runs.ends_early.begin(), runs.ends_early.end(), true) != runs.ends_early.end())
    return "runs end early";
  const Shape shape = shape_of(runs.as_asked.differences(), margin);
  return shape == Shape::kRegular ? "" : std::string(name(shape));
}

Row begin(const StatisticRuns& runs) {
  Row row;
  row.runs = &runs;
  StatisticVerdict& v = row.verdict;
  v.statistic = runs.statistic;
  v.own = runs.own;
  v.pairs = runs.as_asked.a.size();
  if (v.pairs == 0) return row;
  v.margin = margin_of(runs.statistic, runs.as_asked, Estimand::kMean, runs.seconds);
  if (const std::string why = reason_for_median(runs, v.margin); !why.empty()) {
    v.estimand = Estimand::kMedian;
    v.margin = margin_of(runs.statistic, runs.as_asked, v.estimand, runs.seconds);
    add_reason(v, fmt::format("{}: the median is judged", why));
  }
  v.value_a = estimate_of(runs.as_asked.a, v.estimand);
  v.value_b = estimate_of(runs.as_asked.b, v.estimand);
  if (v.pairs < 2) return row;
  row.test = row_test(runs.as_asked, runs.is_share, v.estimand, v.margin);
  if (v.pairs >= kFewestStarts && !runs.is_cut_short) row.p = row.test->p_beyond(v.margin);
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

// Whether the whole sample lies within the margin: a median does not feel starts that lie far apart.
bool mean_within(const StatisticRuns& runs, double margin, double tail) {
  return PairedDifferences(runs.as_asked.differences()).p_within(margin) <= tail;
}

// @param error  of the simultaneous interval of one row
void find_word(Row& row, double tail, double error) {
  StatisticVerdict& v = row.verdict;
  if (row.test) {
    v.gap = row.test->interval(1 - error);
    v.equivalence = row.test->interval(1 - 2 * tail);
  }
  const bool is_median = v.estimand == Estimand::kMedian;
  if (v.pairs < kFewestStarts) {
    add_reason(v, v.pairs == 0
                      ? "no start has a value in both engines"
                      : fmt::format("fewer than {} starts have a value in both engines", kFewestStarts));
    if (v.pairs > 0) v.starts_needed = kFewestStarts;
  } else if (row.runs->is_cut_short) {
    add_reason(
        v, fmt::format("runs fail within {:.2f} s: what they did before says nothing", row.runs->seconds));
  } else if (row.rejected) {
    v.word = Word::kDiffers;
  } else if (is_alike(row.runs->is_share, row.runs->as_asked)) {
    v.word = Word::kAgrees;
    add_reason(v, fmt::format("{}: a difference above {:.0f} % is excluded",
                              v.value_a == 0 && v.value_b == 0 ? "none seen" : "the same in every start",
                              100 * share_upper_limit(0, v.pairs, tail)));
  } else if (row.test->p_within(v.margin) <= tail || (v.margin == 0 && v.gap.low == 0 && v.gap.high == 0)) {
    v.word = is_median && !mean_within(*row.runs, v.margin, tail) ? Word::kUnresolved : Word::kAgrees;
    if (v.word == Word::kUnresolved) add_reason(v, "it lies within the margin, and single starts far beyond");
  } else {
    const bool beyond = v.gap.low > v.margin || v.gap.high < -v.margin;
    add_reason(v, beyond ? "the interval lies beyond the margin, but not surely enough among all statistics"
                         : "the interval crosses the margin");
    if (is_median) {
      // How many starts a median needs, its spread does not say; but with too few there is no test.
      const std::size_t fewest = fewest_for_median(row.level);
      if (v.pairs < fewest) {
        v.starts_needed = fewest;
        add_reason(v, fmt::format("with fewer than {} starts a median is not known so surely", fewest));
      }
      return;
    }
    v.starts_needed = row.test->enough(v.margin, tail, row.level / 2);
  }
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
  const double error = (1 - options.confidence) / looks;
  test_together(rows, error);
  std::vector<StatisticVerdict> verdicts;
  for (Row& row : rows) {
    find_word(row, tail, error / static_cast<double>(rows.size()));
    check_step(*row.runs, {tail, error / static_cast<double>(rows.size()), row.level}, row.verdict);
    verdicts.push_back(std::move(row.verdict));
  }
  return verdicts;
}

}  // namespace crossgait
