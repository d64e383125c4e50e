#include "parity/verdict_runs.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "parity/row_test.h"

namespace crossgait {
namespace {

std::size_t place_of(const Variation& variation) {
  return static_cast<std::size_t>(&variation - variations().data());
}

void append(const std::optional<double>& a, const std::optional<double>& b, PairedValues& values) {
  if (!a || !b) return;
  values.a.push_back(*a);
  values.b.push_back(*b);
}

Interval change_of(const PairedValues& values, bool is_share) {
  constexpr double kConfidence = 0.95;
  if (values.a.size() < 2) return {};
  return row_test(values, is_share, Estimand::kMean)->interval(kConfidence);
}

}  // namespace

VerdictRuns::Both VerdictRuns::both(const EnginePair& pair, std::size_t variation, const Places& together,
                                    std::size_t start) {
  std::vector<const BehaviourRun*> whole;
  for (const std::size_t v : together) {
    for (const std::size_t engine : {pair.a, pair.b}) whole.push_back(campaign_.find({engine, v, start}));
  }
  if (std::find(whole.begin(), whole.end(), nullptr) != whole.end()) return {};
  const std::size_t cuts = campaign_.first_end(whole);
  return {campaign_.find({pair.a, variation, start, cuts}), campaign_.find({pair.b, variation, start, cuts})};
}

// @param number_of  (run) -> optional number
template <typename NumberOf>
void VerdictRuns::add(const EnginePair& pair, std::size_t starts, bool quarter, bool is_cut,
                      const NumberOf& number_of, StatisticRuns& row) {
  const std::size_t nominal = place_of(nominal_variation()), half = place_of(half_step()),
                    fourth = place_of(quarter_step());
  const bool has_half = behaviour_.allows(half_step()),
             has_quarter = quarter && behaviour_.allows(quarter_step());
  // Runs that are not cut are compared as they are, whatever others did.
  const auto at = [&](std::size_t variation, const Places& together, std::size_t k) {
    if (is_cut) return both(pair, variation, together, k);
    return Both{campaign_.find({pair.a, variation, k}), campaign_.find({pair.b, variation, k})};
  };
  const auto number = [&](std::size_t variation, const Places& together, std::size_t k, PairedValues& to) {
    if (const Both runs = at(variation, together, k)) append(number_of(*runs.a), number_of(*runs.b), to);
  };
  std::vector<double> seconds, step_seconds;
  for (std::size_t k = 0; k < starts; ++k) {
    number(nominal, {nominal}, k, row.as_asked);
    if (const Both runs = at(nominal, {nominal}, k)) {
      if (row.ends_early.size() < row.as_asked.a.size())
        row.ends_early.push_back(campaign_.ended_early(*runs.a) || campaign_.ended_early(*runs.b));
      seconds.push_back((runs.a->seconds + runs.b->seconds) / 2);
      row.is_defined = row.is_defined || number_of(*runs.a) || number_of(*runs.b);
    }
    if (!has_half) continue;
    // Of a start that has no value at one of the steps there is none at the others.
    const Places together = has_quarter ? Places{nominal, half, fourth} : Places{nominal, half};
    std::array<PairedValues, 3> steps;
    for (std::size_t i = 0; i < together.size(); ++i) number(together[i], together, k, steps[i]);
    if (steps[0].a.empty() || steps[1].a.empty() || (has_quarter && steps[2].a.empty())) continue;
    append(steps[0].a[0], steps[0].b[0], row.at_step);
    if (const Both runs = at(nominal, together, k))
      step_seconds.push_back((runs.a->seconds + runs.b->seconds) / 2);
    append(steps[1].a[0], steps[1].b[0], row.at_half);
    if (has_quarter) append(steps[2].a[0], steps[2].b[0], row.at_quarter);
  }
  row.seconds = mean_of(seconds);
  row.step_seconds = mean_of(step_seconds);
  constexpr double kLeastSeconds = 0.5;  // of a walk that fails: less is its fall alone
  row.is_cut_short = is_cut && row.seconds < std::min(kLeastSeconds, (1 - 1e-9) * behaviour_.seconds);
}

template <typename NumberOf>
std::vector<OwnChange> VerdictRuns::own_changes(const EnginePair& pair, std::size_t starts, bool is_share,
                                                const NumberOf& number_of) {
  const std::size_t nominal = place_of(nominal_variation());
  std::vector<OwnChange> changes;
  for (const std::size_t engine : {pair.a, pair.b}) {
    for (std::size_t v = 0; v < variations().size(); ++v) {
      const Variation& variation = variations()[v];
      if (v == nominal || v == place_of(quarter_step()) || !variation.of(engines_[engine].info) ||
          !behaviour_.allows(variation))
        continue;
      PairedValues values;
      for (std::size_t k = 0; k < starts; ++k) {
        const std::array whole{campaign_.find({engine, nominal, k}), campaign_.find({engine, v, k})};
        if (whole[0] == nullptr || whole[1] == nullptr) continue;
        const std::size_t cuts = is_share ? 0 : campaign_.first_end(whole);
        const BehaviourRun *from = campaign_.find({engine, nominal, k, cuts}),
                           *to = campaign_.find({engine, v, k, cuts});
        if (from != nullptr && to != nullptr) append(number_of(*from), number_of(*to), values);
      }
      // An exact interval takes its time: not of runs that are still to be made.
      const Interval change = campaign_.is_complete() ? change_of(values, is_share) : Interval{};
      changes.push_back({engines_[engine].name(), std::string(variation.name), change});
    }
  }
  return changes;
}

std::vector<StatisticRuns> VerdictRuns::outcome_rows(const EnginePair& pair, std::size_t starts,
                                                     bool quarter) {
  const Margin margin{0, options_.failures, false, "a share of runs that is stated"};
  std::vector<StatisticRuns> rows;
  const auto add_row = [&](const std::string& key, const std::string& name, const auto& is) {
    StatisticRuns row;
    row.statistic = {key, name, "fraction", margin};
    row.is_share = true;
    const auto number = [&is](const BehaviourRun& run) { return std::optional(is(run.outcome) ? 1.0 : 0.0); };
    add(pair, starts, quarter, false, number, row);
    row.own = own_changes(pair, starts, true, number);
    rows.push_back(std::move(row));
  };
  add_row("failures", "failures", is_failure);
  const OutcomeCounts a = outcomes(pair.a, starts), b = outcomes(pair.b, starts);
  const auto seen = [&](Outcome outcome) {
    return a[static_cast<std::size_t>(outcome)] + b[static_cast<std::size_t>(outcome)] > 0;
  };
  std::size_t ways_to_fail = 0;
  for (const OutcomeRow& row : crossgait::outcome_rows())
    ways_to_fail += seen(row.outcome) && is_failure(row.outcome) ? 1 : 0;
  for (const OutcomeRow& row : crossgait::outcome_rows()) {
    // One way to fail is the row of all failures once more.
    const bool repeats = row.outcome == Outcome::kWalked || (is_failure(row.outcome) && ways_to_fail < 2);
    if (!seen(row.outcome) || repeats) continue;
    add_row(std::string(row.name), std::string(row.words),
            [&row](Outcome outcome) { return outcome == row.outcome; });
  }
  return rows;
}

std::vector<StatisticRuns> VerdictRuns::rows(const EnginePair& pair, std::size_t starts, bool quarter) {
  std::vector<StatisticRuns> rows;
  for (std::size_t s = 0; s < behaviour_.statistics.size(); ++s) {
    StatisticRuns row;
    row.statistic = behaviour_.statistics[s];
    const auto number = [s](const BehaviourRun& run) { return run.values[s]; };
    add(pair, starts, quarter, true, number, row);
    row.own = own_changes(pair, starts, false, number);
    rows.push_back(std::move(row));
  }
  for (StatisticRuns& row : outcome_rows(pair, starts, quarter)) rows.push_back(std::move(row));
  return rows;
}

OutcomeCounts VerdictRuns::outcomes(std::size_t engine, std::size_t starts) {
  OutcomeCounts counts{};
  for (std::size_t k = 0; k < starts; ++k) {
    const BehaviourRun* run = campaign_.find({engine, place_of(nominal_variation()), k});
    if (run != nullptr) ++counts[static_cast<std::size_t>(run->outcome)];
  }
  return counts;
}

std::optional<PairCut> VerdictRuns::cut(const EnginePair& pair, std::size_t starts) {
  const std::size_t nominal = place_of(nominal_variation());
  PairCut cut;
  PairedValues lengths;
  std::vector<double> common;
  for (std::size_t k = 0; k < starts; ++k) {
    const BehaviourRun *a = campaign_.find({pair.a, nominal, k}), *b = campaign_.find({pair.b, nominal, k});
    if (a == nullptr || b == nullptr) return std::nullopt;
    cut.pairs += campaign_.ended_early(*a) || campaign_.ended_early(*b) ? 1 : 0;
    cut.any_failed |= is_failure(a->outcome) || is_failure(b->outcome);
    append(a->seconds, b->seconds, lengths);
    common.push_back(std::min(a->seconds, b->seconds));
  }
  if (cut.pairs == 0) return std::nullopt;
  cut.mean_s = mean_of(common);
  cut.shortest_s = *std::min_element(common.begin(), common.end());
  cut.mean_a_s = mean_of(lengths.a);
  cut.mean_b_s = mean_of(lengths.b);
  cut.difference_s = change_of(lengths, false);
  return cut;
}

}  // namespace crossgait
