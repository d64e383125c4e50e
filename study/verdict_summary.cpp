// A verdict in one to three sentences.
#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "parity/answer.h"
#include "parity/distributions.h"
#include "parity/verdict_report.h"
#include "study/engine_comparison.h"

namespace crossgait {
namespace {

std::vector<const StatisticVerdict*> with_word(const Verdict& verdict, Word word) {
  std::vector<const StatisticVerdict*> found;
  for (const StatisticVerdict& s : verdict.statistics) {
    if (s.word == word) found.push_back(&s);
  }
  return found;
}

std::vector<std::string> names(const std::vector<const StatisticVerdict*>& statistics) {
  std::vector<std::string> all;
  for (const StatisticVerdict* s : statistics) all.push_back(s->statistic.name);
  return all;
}

// "slip of loaded feet (-0.113 m; 0.02 m would not matter)": the largest gaps, in margins, first.
std::string gaps(std::vector<const StatisticVerdict*> statistics) {
  std::stable_sort(statistics.begin(), statistics.end(), [](const auto* x, const auto* y) {
    return std::abs(x->gap.estimate) * y->margin > std::abs(y->gap.estimate) * x->margin;
  });
  constexpr std::size_t kShown = 3;
  std::vector<std::string> parts;
  for (const StatisticVerdict* s : statistics) {
    if (parts.size() == kShown && statistics.size() > kShown + 1) {
      parts.push_back(fmt::format("{} more", statistics.size() - kShown));
      break;
    }
    parts.push_back(fmt::format("{} ({}, margin {:.2g})", s->statistic.name,
                                signed_amount(s->gap.estimate, s->statistic), s->margin));
  }
  return listed(parts);
}

std::string failures(const Verdict& verdict, std::size_t starts, std::size_t looks) {
  if (describe(verdict.outcomes_a) != describe(verdict.outcomes_b)) {
    return fmt::format("{}: {}; {}: {}.", verdict.a, describe(verdict.outcomes_a), verdict.b,
                       describe(verdict.outcomes_b));
  }
  const auto failed = [](const OutcomeCounts& counts) {
    std::size_t sum = 0;
    for (const OutcomeRow& row : outcome_rows())
      sum += is_failure(row.outcome) ? counts[static_cast<std::size_t>(row.outcome)] : 0;
    return sum;
  };
  if (failed(verdict.outcomes_a) > 0) return fmt::format("Both: {}.", describe(verdict.outcomes_a));
  return fmt::format("No run of {} failed, which excludes failures in more than {:.0f} % of runs.", starts,
                     100 * share_upper_limit(0, starts, kEquivalenceTail / static_cast<double>(looks)));
}

// Why the largest gap is there.
std::string cause(const Verdict& verdict, const PairBackground& background) {
  if (!background.attribution) return "";
  const Attribution& a = *background.attribution;
  const StatisticVerdict* largest = nullptr;
  std::size_t place = 0;
  for (std::size_t s = 0; s < a.statistics.size(); ++s) {
    for (const StatisticVerdict& v : verdict.statistics) {
      if (v.statistic.key != a.statistics[s].key || v.word != Word::kDiffers) continue;
      if (largest == nullptr ||
          std::abs(v.gap.estimate) * largest->margin > std::abs(largest->gap.estimate) * v.margin) {
        largest = &v;
        place = s;
      }
    }
  }
  if (largest == nullptr) return "";
  const Cause found = a.cause(place);
  if (found.sentence.empty()) return "";
  return fmt::format(" Why, in {}, from {} to {}: {}.", largest->statistic.name, a.from, a.to,
                     found.sentence);
}

// @param what  two of which are held against each other: "engine"
std::string pair_sentence(const Verdict& v, std::string_view what) {
  const auto agree = with_word(v, Word::kAgrees), differ = with_word(v, Word::kDiffers),
             step = with_word(v, Word::kStepDependent), open = with_word(v, Word::kUnresolved);
  switch (v.word) {
    case Word::kAgrees:
      return fmt::format("{} and {} agree in all {} statistics.", v.a, v.b, agree.size());
    case Word::kDiffers: {
      std::string rest;
      if (!agree.empty()) rest = fmt::format("; within the margin: {}", listed(names(agree)));
      if (!step.empty()) rest += fmt::format("; step-dependent: {}", listed(names(step)));
      if (!open.empty()) rest += fmt::format("; unresolved: {}", listed(names(open)));
      return fmt::format("{} and {} differ in {}{}.", v.a, v.b, gaps(differ), rest);
    }
    case Word::kStepDependent:
      return fmt::format("Whether {} and {} agree in {} depends on the time step, not on the {}.", v.a, v.b,
                         listed(names(step)), what);
    case Word::kUnresolved:
      break;
  }
  return fmt::format("Whether {} and {} agree in {} is not resolved{}.", v.a, v.b, listed(names(open)),
                     v.starts_needed ? fmt::format(" (about {} starts would tell)", *v.starts_needed) : "");
}

// "Groups that agree: {mujoco}, {bullet, dart}."
std::string groups(const EngineComparison& comparison) {
  std::vector<std::string> sets;
  for (const auto& cluster : comparison.consensus.clusters)
    sets.push_back(fmt::format("{{{}}}", fmt::join(names_of(comparison, cluster), ", ")));
  if (sets.size() == 1) return fmt::format("All {} engines agree.", comparison.engines.size());
  return fmt::format("Engines that agree with one another: {}.", listed(sets));
}

// What the words were reached with that is the user's own.
std::string own_rule(const EngineComparison& comparison) {
  const VerdictOptions usual;
  const double confidence = comparison.verdicts.options.confidence;
  std::vector<std::string> parts;
  if (confidence != usual.confidence) parts.push_back(fmt::format("a confidence of {:g}", confidence));
  std::vector<std::string> margins;
  for (const StatisticVerdict& v : comparison.verdicts.pairs.front().statistics) {
    if (v.statistic.margin.reason == kStatedByUser)
      margins.push_back(fmt::format("{} {}", v.statistic.name, v.statistic.margin.words(v.statistic.unit)));
  }
  if (!margins.empty()) parts.push_back(fmt::format("margins of the user's for {}", listed(margins)));
  return parts.empty() ? "" : fmt::format(" With {}.", listed(parts));
}

}  // namespace

std::string summary(const EngineComparison& comparison) {
  const std::vector<Verdict>& pairs = comparison.verdicts.pairs;
  const std::string behaviour = pairs.front().behaviour;
  if (pairs.size() == 1) {
    return fmt::format("{}: {} {}{}{}", behaviour,
                       pair_sentence(pairs.front(), comparison.against ? "setup" : "engine"),
                       failures(pairs.front(), comparison.verdicts.starts, comparison.verdicts.options.looks),
                       cause(pairs.front(), comparison.backgrounds.front()), own_rule(comparison));
  }
  std::string text = fmt::format("{}: {}", behaviour, groups(comparison));
  const auto worst = std::find_if(pairs.begin(), pairs.end(),
                                  [&](const Verdict& v) { return v.word == word_of(comparison); });
  if (worst->word != Word::kAgrees) {
    text += fmt::format(" {}", pair_sentence(*worst, "engine"));
    text += cause(*worst, comparison.backgrounds[static_cast<std::size_t>(worst - pairs.begin())]);
  }
  if (!comparison.consensus.outlier.empty())
    text += fmt::format(" The outlier is {}.", listed(names_of(comparison, comparison.consensus.outlier)));
  return text + own_rule(comparison);
}

}  // namespace crossgait
