// Why do two engines differ? One factor changed at a time, from the one to the other.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "parity/behaviour.h"
#include "parity/jackknife.h"

namespace crossgait {

/// What one factor does, per statistic of the behaviour. Each is the mean over starts of a paired
/// difference, with its jackknife interval at confidence 1 - (1 - confidence) / (factors * statistics).
struct FactorEffect {
  ModelFactor factor;
  std::vector<Interval> first;  ///< put into `from` (with what it needs) before all others
  std::vector<Interval> last;   ///< put in after all others (but those that need it)
  std::vector<Interval> step;   ///< put in after those before it in the table: these sum to the gap
  /// Mean of what it changes over all orders in which factors can be put in, each after those it needs:
  /// the Shapley value (Shapley 1953; with precedence, Faigle and Kern 1992). These too sum to the gap, and
  /// hang on no order of the table.
  std::vector<Interval> effect;
  /// What left DivergenceTolerances::fine() first when it was put in first; empty where nothing did, or the
  /// behaviour records no traces.
  std::optional<FirstDivergence> first_divergence;
};

struct Attribution {
  std::string behaviour, from, to;
  std::vector<Statistic> statistics;
  std::size_t starts = 0;
  std::vector<double> from_mean, to_mean;  ///< per statistic
  std::vector<Interval> gap;               ///< to - from
  std::vector<double> floor;               ///< differences that nobody would act on
  std::vector<FactorEffect> effects;       ///< in the order of the family

  /// The factors to blame for a statistic: the one of largest effect, and those whose effect cannot be
  /// told from it in size. None where the gap is below the floor or no effect can be told from zero.
  std::vector<std::string> leading(std::size_t statistic) const;
};

struct AttributionOptions {
  std::size_t starts = 8;  ///< at least 4
  double confidence = 0.95;
  std::size_t workers = 1;  ///< results do not depend on them
};

/// @param progress called with the share of runs done, one call at a time, from any thread
/// @throws ConfigError
Attribution attribute(const Behaviour& behaviour, const EngineFamily& family,
                      const AttributionOptions& options, const Progress& progress = {});

}  // namespace crossgait
