// Why do two engines differ? One factor changed at a time, from the one to the other.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "parity/behaviour.h"
#include "parity/paired_differences.h"

namespace crossgait {

/// Holds what one factor does, per statistic. Each is the mean over starts of a paired difference, with its t
/// interval at confidence 1 - (1 - confidence) / (factors * statistics).
struct FactorEffect {
  ModelFactor factor;
  std::vector<Interval> first;  ///< put into `from` (with what it needs) before all others
  std::vector<Interval> last;   ///< put in after all others (but those that need it)
  std::vector<Interval> step;   ///< put in after those before it in the table: these sum to the gap
  /// Mean of what it changes over all orders in which factors can be put in, each after those it needs, and
  /// the factors of one group one right after the other: the Owen value (Owen 1977; with precedence, Faigle
  /// and Kern 1992). These too sum to the gap, and hang on no order of the table.
  std::vector<Interval> effect;
  /// What left DivergenceTolerances::fine() first when it was put in first; empty where nothing did, or the
  /// behaviour records no traces.
  std::optional<FirstDivergence> first_divergence;
};

/// Returns the modelling decision that a factor is of: its group, or itself.
const std::string& group_of(const ModelFactor& factor) noexcept;

/// Holds what one modelling decision does: the sum of its factors' effects, per statistic.
struct GroupEffect {
  std::string name;
  std::vector<std::size_t> factors;  ///< by their places
  std::vector<Interval> effect;
};

/// Says what a gap comes from.
struct Cause {
  enum class Kind {
    kNothing,   ///< the gap is within its margin, or cannot be told from zero
    kLeading,   ///< one group, or several as large as it, with the sign of the gap
    kNoSingle,  ///< effects of both signs nearly cancel, or the largest cannot be told from zero
  };
  Kind kind = Kind::kNothing;
  std::vector<std::string> leading;  ///< groups, the largest first
  std::string sentence;              ///< "of -0.376 m: friction law -0.28, rigid contact -0.10"
};

struct Attribution {
  std::string behaviour, from, to;
  std::vector<Statistic> statistics;  ///< the behaviour's, then the share of failures
  std::size_t starts = 0;
  std::vector<double> from_mean, to_mean;  ///< per statistic
  std::vector<Interval> gap;               ///< to - from
  std::vector<double> margin;              ///< differences that nobody would act on
  std::vector<FactorEffect> effects;       ///< in the order of the family
  std::vector<GroupEffect> groups;
  /// Names the two groups that do most together beyond what each does alone, and how much, per statistic;
  /// empty where there is one group.
  struct Interaction {
    std::string first, second;
    double amount = 0;
  };
  std::vector<std::optional<Interaction>> interactions;
  bool has_traces = false;  ///< whether `first_divergence` was looked for

  /// Names what is to blame for a statistic: the group of largest effect *with the sign of the gap*, and
  /// those whose effect cannot be told from it in size. There is no single cause where that effect cannot be
  /// told from zero, and where the groups' effects sum to more than twice the gap without their signs.
  Cause cause(std::size_t statistic) const;
};

struct AttributionOptions {
  std::size_t starts = 8;  ///< at least 4
  double confidence = 0.95;
  std::size_t workers = 1;  ///< results do not depend on them
  double failures = 0.1;    ///< margin of the share of runs that fail
};

/// Runs every set of factors that is needed. Where runs from a start fail, all of that start are cut at the
/// first failure.
/// @param progress called with the share of runs done, one call at a time, from any thread
/// @throws ConfigError
Attribution attribute(const Behaviour& behaviour, const EngineFamily& family,
                      const AttributionOptions& options, const Progress& progress = {});

}  // namespace crossgait
