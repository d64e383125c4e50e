// Does a behaviour depend on the engine? The gap between two engines, measured in the spread within one.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "parity/behaviour.h"
#include "parity/jackknife.h"

namespace crossgait {

enum class VerdictValue { kAgrees, kEngineDependent, kUnresolved };
/// "agrees", "engine-dependent", "unresolved"
std::string_view name(VerdictValue value) noexcept;

/// Standard deviations of one statistic within one engine, by what was varied.
struct WithinSpread {
  double starts = 0;     ///< over starts (place, heading, push, terrain seed), as asked otherwise
  double time_step = 0;  ///< over time steps, of the means over starts
  double solver = 0;     ///< over solver settings, of the means over starts
  /// Root of the sum of squares.
  double total() const noexcept;
};

/// The rule: for every start k both engines run from it, and d_k = b_k - a_k is their difference,
/// settings as asked. The *gap* is the mean of d_k. The *spread* is the root mean square of the two engines'
/// WithinSpread::total(): how much the statistic moves for reasons that are not the engine. The *floor* is
/// the difference that nobody would act on (Statistic). The *score* is
///
///     score = gap / sqrt(spread^2 + floor^2)
///
/// (added as independent spreads add: the larger counts, and no kink where one overtakes the other)
/// and has a jackknife interval over starts with confidence 1 - (1 - confidence) / m for m words: one for
/// each statistic of each pair of engines (Bonferroni, so that all m together are right with at least
/// `confidence`). With `limit` L (1: as far
/// apart as one engine is from itself):
/// - **agrees** if the whole interval lies within (-L, L): the engines are equivalent to within their own
///   spread (two one-sided tests; Schuirmann 1987), or differ by less than anyone would act on;
/// - **engine-dependent** if the whole interval lies beyond L or beyond -L;
/// - **unresolved** otherwise: more starts, or a tighter setup, would tell.
///
/// A behaviour agrees if all its statistics do, is engine-dependent if any is, and else unresolved.
struct StatisticVerdict {
  Statistic statistic;
  double mean_a = 0, mean_b = 0;  ///< as asked, over starts
  Interval gap;                   ///< b - a, same confidence as the score
  WithinSpread spread_a, spread_b;
  double spread = 0, floor = 0;
  Interval score;
  VerdictValue value = VerdictValue::kUnresolved;
};

struct VerdictOptions {
  std::size_t starts = 12;  ///< at least 4
  double limit = 1;
  double confidence = 0.95;
  std::size_t workers = 1;  ///< threads; results do not depend on them

  /// @throws ConfigError naming the option
  void validate() const;
};

/// values[variation][start][statistic] of one engine.
using RunTable = std::vector<std::vector<std::vector<double>>>;

struct Verdict {
  std::string behaviour, a, b;
  VerdictOptions options;
  std::vector<Variation> variations;  ///< that were used, nominal first
  std::vector<std::string> left_out;  ///< the others, with the reason
  std::vector<StatisticVerdict> statistics;

  VerdictValue value() const noexcept;
};

/// The rule alone, on runs that were made.
/// @param a,b    of equal shape, nominal variation first
/// @param pairs  of engines that are judged together
std::vector<StatisticVerdict> judge(const std::vector<Statistic>& statistics,
                                    const std::vector<Variation>& variations, const RunTable& a,
                                    const RunTable& b, const VerdictOptions& options, std::size_t pairs = 1);

/// Runs `behaviour` in every engine from every start under every variation, once, and judges all pairs: the
/// first with each that follows, then the second, and so on. Variations that the control step does not allow,
/// or under which any engine fails more often than as asked, are left out.
/// @param engines   two or more
/// @param progress  called with the share of runs done, one call at a time, from any thread
/// @throws ConfigError
std::vector<Verdict> reach_verdicts(const Behaviour& behaviour, std::span<const Engine> engines,
                                    const VerdictOptions& options, const Progress& progress = {});

/// The same of two.
Verdict reach_verdict(const Behaviour& behaviour, const Engine& a, const Engine& b,
                      const VerdictOptions& options, const Progress& progress = {});

}  // namespace crossgait
