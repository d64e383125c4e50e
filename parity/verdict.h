// Does a behaviour depend on the engine? Paired differences between engines, against stated margins.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "parity/behaviour.h"
#include "parity/paired_differences.h"

namespace crossgait {

enum class Word { kAgrees, kDiffers, kStepDependent, kUnresolved };
/// Names a word: "agrees", "differs", "step-dependent", "unresolved".
std::string_view name(Word word) noexcept;

/// What a word is worth that is reached with less is not worth a word.
inline constexpr double kLeastConfidence = 0.8;

/// Says how a verdict is reached.
struct VerdictOptions {
  std::size_t starts = 12;   ///< at least 4; words are given from kFewestStarts on
  std::size_t looks = 1;     ///< planned: after starts / looks starts, twice as many, and so on
  double confidence = 0.95;  ///< of all intervals of all pairs together; kLeastConfidence or more
  double failures = 0.1;     ///< margin of the share of runs that end in an outcome
  Margins margins = {};      ///< in place of the statistics' own
  std::size_t workers = 1;   ///< threads; results do not depend on them

  /// @throws ConfigError naming the option
  void validate() const;
};

/// Starts below which every word is withheld: with fewer an interval rests on a spread that is hardly known.
inline constexpr std::size_t kFewestStarts = 6;
/// Error of each of the two one-sided tests behind *agrees*, at one look.
inline constexpr double kEquivalenceTail = 0.05;

/// Holds what the gap is when both engines take half the time step.
struct StepCheck {
  Interval half;    ///< the gap at half the step, at the confidence of the gap
  Interval change;  ///< from the gap as asked to that at half the step, paired
  /// The gap at a quarter of the step, where the step would change a word, and what the three lead to as the
  /// step goes to zero, if they fall in with one order of convergence (Roache 1998).
  std::optional<double> quarter, order, extrapolated;
};

/// Holds what an engine's own number changes by, from the same starts, when it is set up otherwise.
struct OwnChange {
  std::string engine, variation;
  Interval change;  ///< mean, in the statistic's unit, at 95 %
};

/// Holds a verdict by this rule. Both engines run from every start k; d_k = b_k - a_k is their difference.
/// The **gap** is what lies behind the d_k: their mean, or their median where a run ended early, or
/// `shape_of` finds heavy tails or two humps. Without either it is that of runs that do not end early. How
/// far the starts lie apart has no part in it. Against the statistic's margin the word is
/// - **agrees** if the 90 % interval of the gap lies within the margin: two one-sided tests at 5 %
///   (Schuirmann 1987);
/// - **differs** if the gap is beyond the margin, by tests that hold for all statistics of all pairs together
///   (Holm 1979); `gap` is the interval that goes with them;
/// - **step-dependent** if one of these would turn into the other, or lose its sign or half of its size, at
///   half the time step;
/// - **unresolved** otherwise, with a reason and the number of starts that would tell.
struct StatisticVerdict {
  Statistic statistic;
  double value_a = 0, value_b = 0;  ///< means over the pairs used (medians with the median), as asked
  std::size_t pairs = 0;            ///< starts in which both engines have a value
  Estimand estimand = Estimand::kMean;
  Interval gap;          ///< b - a, simultaneous
  Interval equivalence;  ///< the same, of the two one-sided tests
  double margin = 0;     ///< in the statistic's unit
  std::optional<StepCheck> step;
  std::vector<OwnChange> own;
  Word word = Word::kUnresolved;
  std::string reason;                        ///< why it is not agrees or differs; or what a limit of it is
  std::optional<std::size_t> starts_needed;  ///< for a word that is unresolved
};

/// Says where runs that fail are cut: both of a pair at the earlier failure, so that they are compared over
/// the same time.
struct PairCut {
  std::size_t pairs = 0;              ///< of which one run or both ended early
  bool any_failed = false;            ///< not all of these left the terrain
  double mean_s = 0, shortest_s = 0;  ///< of all pairs
  /// Mean length of a run, up to its end or its failure, in each engine, and their paired difference: the
  /// restricted mean time to failure. At 95 %.
  double mean_a_s = 0, mean_b_s = 0;
  Interval difference_s;
};

/// Returns the word for several together: *differs* if any of them does, else *step-dependent*, else
/// *unresolved*, else *agrees*. @tparam Judged  has a `word`
template <typename Judged>
Word worst_word(const std::vector<Judged>& judged) noexcept {
  for (const Word word : {Word::kDiffers, Word::kStepDependent, Word::kUnresolved}) {
    for (const Judged& one : judged) {
      if (one.word == word) return word;
    }
  }
  return Word::kAgrees;
}

using OutcomeCounts = std::array<std::size_t, kOutcomes>;

struct Verdict {
  std::string behaviour, a, b;
  OutcomeCounts outcomes_a{}, outcomes_b{};
  std::optional<PairCut> cut;                ///< empty where every run went to its end
  std::vector<StatisticVerdict> statistics;  ///< failures and other outcomes last
  std::vector<Statistic> undefined;          ///< of which no run of either engine has a value
  Word word = Word::kUnresolved;
  std::string reason;
  std::optional<std::size_t> starts_needed;
};

/// Holds verdicts of all pairs, and how they were reached.
struct Verdicts {
  VerdictOptions options;
  std::size_t starts = 0, looks_made = 0;  ///< starts that were looked at last
  std::vector<std::string> engines;
  std::vector<std::string> variations;  ///< that were run, with what was left out and why
  std::vector<std::string> left_out;
  std::vector<Verdict> pairs;  ///< the first engine with each that follows, then the second, and so on
};

/// Runs `behaviour` in every engine from every start, as asked, with half the time step and under the
/// settings that the engine declares, and judges all pairs. Where a word would depend on the step, a quarter
/// of it is run as well. With several looks it ends at the first after which no pair is unresolved.
/// @param engines   two or more
/// @param progress  called with the share of runs done, one call at a time, from any thread
/// @throws ConfigError
Verdicts reach_verdicts(const Behaviour& behaviour, std::span<const Engine> engines,
                        const VerdictOptions& options, const Progress& progress = {});

}  // namespace crossgait
