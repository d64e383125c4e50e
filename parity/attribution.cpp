#include "parity/attribution.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "parity/campaign.h"
#include "parity/verdict_report.h"
#include "physics/core/error.h"

namespace crossgait {
namespace {

using Mask = unsigned;  // of factors

// Which factors each needs and is needed by, and which are of one group, as sets.
class Order {
 public:
  explicit Order(const EngineFamily& family)
      : count_(family.factors.size()), needs_(count_), needed_(count_) {
    for (std::size_t i = 0; i < count_; ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        const auto& names = family.factors[i].needs;
        if (std::find(names.begin(), names.end(), family.factors[k].name) == names.end()) continue;
        needs_[i] |= needs_[k] | bit(k);
      }
    }
    for (std::size_t i = 0; i < count_; ++i) {
      for (std::size_t k = 0; k < count_; ++k) {
        if ((needs_[k] & bit(i)) != 0) needed_[i] |= bit(k);
      }
    }
    for (std::size_t i = 0; i < count_;) {
      Mask group = 0;
      const std::string& name = group_of(family.factors[i]);
      for (; i < count_ && group_of(family.factors[i]) == name; ++i) group |= bit(i);
      groups_.push_back(group);
    }
    count_ways();
  }

  static Mask bit(std::size_t i) { return Mask{1} << i; }
  Mask all() const { return bit(count_) - 1; }
  Mask before_first(std::size_t i) const { return needs_[i]; }
  Mask before_last(std::size_t i) const { return all() & ~needed_[i] & ~bit(i); }
  Mask before_step(std::size_t i) const { return bit(i) - 1; }
  const std::vector<Mask>& groups() const { return groups_; }
  bool has_meaning(Mask set) const {
    for (std::size_t i = 0; i < count_; ++i) {
      if ((set & bit(i)) != 0 && (needs_[i] & ~set) != 0) return false;
    }
    return true;
  }
  /// Whether an order passes through the set in which groups are not interrupted: one is begun at most.
  bool allows(Mask set) const {
    const auto begun = std::count_if(groups_.begin(), groups_.end(),
                                     [set](Mask g) { return (set & g) != 0 && (set & g) != g; });
    return begun <= 1 && has_meaning(set);
  }
  /// Share of all orders in which i comes right after the set `before`, for every such set.
  std::vector<std::pair<Mask, double>> shares(std::size_t i) const {
    std::vector<std::pair<Mask, double>> result;
    for (Mask before = 0; before <= all(); ++before) {
      const Mask after = before | bit(i);
      if (after == before || !may_follow(before, i)) continue;
      result.emplace_back(before, ways_to_[before] * ways_from_[after] / ways_to_[all()]);
    }
    return result;
  }

 private:
  /// Whether i may come right after the set `before`: a group that has been begun is finished first.
  bool may_follow(Mask before, std::size_t i) const {
    if (!allows(before) || !allows(before | bit(i))) return false;
    return std::none_of(groups_.begin(), groups_.end(), [&](Mask g) {
      const bool begun = (before & g) != 0 && (before & g) != g;
      return begun && (g & bit(i)) == 0;
    });
  }

  // Numbers of orders that lead from nothing to each set, and from it to everything.
  void count_ways() {
    ways_to_.assign(all() + 1, 0);
    ways_from_.assign(all() + 1, 0);
    ways_to_[0] = ways_from_[all()] = 1;
    for (Mask set = 0; set <= all(); ++set) {
      for (std::size_t i = 0; i < count_; ++i) {
        if ((set & bit(i)) != 0 && may_follow(set & ~bit(i), i)) ways_to_[set] += ways_to_[set & ~bit(i)];
      }
    }
    for (Mask set = all() + 1; set-- > 0;) {
      for (std::size_t i = 0; i < count_; ++i) {
        if ((set & bit(i)) == 0 && may_follow(set, i)) ways_from_[set] += ways_from_[set | bit(i)];
      }
    }
  }

  std::vector<double> ways_to_, ways_from_;
  std::size_t count_;
  std::vector<Mask> needs_, needed_, groups_;
};

std::vector<std::string> names_of(const EngineFamily& family, Mask mask) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < family.factors.size(); ++i) {
    if ((mask & Order::bit(i)) != 0) names.push_back(family.factors[i].name);
  }
  return names;
}

// Every set of factors that is run: those that orders pass through, and those of `first`, `last` and `step`.
std::vector<Mask> masks_of(const Order& order, std::size_t factors) {
  std::set<Mask> masks;
  for (Mask mask = 0; mask <= order.all(); ++mask) {
    if (order.allows(mask)) masks.insert(mask);
  }
  for (std::size_t i = 0; i < factors; ++i) {
    for (const Mask before : {order.before_first(i), order.before_last(i), order.before_step(i)})
      masks.insert({before, before | Order::bit(i)});
  }
  // Two groups alone, for their interaction.
  for (const Mask a : order.groups()) {
    for (const Mask b : order.groups()) {
      if (order.has_meaning(a | b)) masks.insert(a | b);
    }
  }
  return {masks.begin(), masks.end()};
}

// values[mask][start][statistic], failures last.
using Values = std::map<Mask, std::vector<std::vector<std::optional<double>>>>;

struct Runs {
  Values values;
  double seconds = 0;  ///< of motion, mean over starts
};

Runs run_all(const Behaviour& behaviour, const EngineFamily& family, const Order& order,
             const AttributionOptions& options, const Progress& progress) {
  const std::vector<Mask> masks = masks_of(order, family.factors.size());
  std::vector<Engine> engines;
  for (const Mask mask : masks) engines.push_back(family.with(names_of(family, mask)));
  Campaign campaign(behaviour, engines, options.workers);
  Runs runs;
  for (;;) {
    runs = {};
    for (std::size_t k = 0; k < options.starts; ++k) {
      std::vector<const BehaviourRun*> whole;
      for (std::size_t m = 0; m < masks.size(); ++m) whole.push_back(campaign.find({m, 0, k}));
      if (std::find(whole.begin(), whole.end(), nullptr) != whole.end()) continue;
      const std::size_t cuts = campaign.first_end(whole);
      for (std::size_t m = 0; m < masks.size(); ++m) {
        const BehaviourRun* run = campaign.find({m, 0, k, cuts});
        if (run == nullptr) continue;
        std::vector<std::optional<double>> values = run->values;
        values.emplace_back(is_failure(whole[m]->outcome) ? 1.0 : 0.0);
        runs.values[masks[m]].push_back(std::move(values));
        if (m == 0) runs.seconds += run->seconds / static_cast<double>(options.starts);
      }
    }
    if (campaign.is_complete()) return runs;
    campaign.make_missing(progress);
  }
}

using Terms = std::vector<std::pair<Mask, double>>;

// Sum over sets of weight times value, at every start that has all of them; the mean with its interval.
class Contrast {
 public:
  Contrast(const Runs& runs, std::size_t statistic, std::size_t starts, double confidence)
      : runs_(runs), statistic_(statistic), starts_(starts), confidence_(confidence) {}

  Interval operator()(const Terms& terms) const {
    std::vector<double> sums;
    for (std::size_t k = 0; k < starts_; ++k) {
      double sum = 0;
      bool whole = true;
      for (const auto& [mask, weight] : terms) {
        const std::optional<double>& value = runs_.values.at(mask)[k][statistic_];
        whole = whole && value.has_value();
        sum += weight * value.value_or(0);
      }
      if (whole) sums.push_back(sum);
    }
    if (sums.size() < 2) return {};
    return PairedDifferences(sums).interval(confidence_);
  }

 private:
  const Runs& runs_;
  std::size_t statistic_, starts_;
  double confidence_;
};

Terms owen_terms(const Order& order, std::size_t factor) {
  Terms terms;
  for (const auto& [before, share] : order.shares(factor)) {
    terms.emplace_back(before | Order::bit(factor), share);
    terms.emplace_back(before, -share);
  }
  return terms;
}

// The two groups that do most together beyond what each does alone, from `from`.
std::optional<Attribution::Interaction> largest_interaction(const Order& order, const Contrast& contrast,
                                                            const std::vector<GroupEffect>& groups) {
  std::optional<Attribution::Interaction> largest;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    for (std::size_t k = i + 1; k < groups.size(); ++k) {
      const Mask a = order.groups()[i], b = order.groups()[k];
      if (!order.has_meaning(a) || !order.has_meaning(b)) continue;
      const double amount = contrast({{a | b, 1}, {a, -1}, {b, -1}, {0, 1}}).estimate;
      if (!largest || std::abs(amount) > std::abs(largest->amount))
        largest = Attribution::Interaction{groups[i].name, groups[k].name, amount};
    }
  }
  return largest;
}

void add_effects(const Runs& runs, const Order& order, double confidence, Attribution& result) {
  for (std::size_t s = 0; s < result.statistics.size(); ++s) {
    const Contrast contrast(runs, s, result.starts, confidence);
    const Interval from = contrast({{0, 1}}), to = contrast({{order.all(), 1}});
    result.from_mean.push_back(from.estimate);
    result.to_mean.push_back(to.estimate);
    result.gap.push_back(contrast({{order.all(), 1}, {0, -1}}));
    const double size = (std::abs(from.estimate) + std::abs(to.estimate)) / 2;
    result.margin.push_back(result.statistics[s].margin.at(size, runs.seconds));
    for (std::size_t i = 0; i < result.effects.size(); ++i) {
      FactorEffect& effect = result.effects[i];
      const Mask own = Order::bit(i), first = order.before_first(i), last = order.before_last(i),
                 step = order.before_step(i);
      effect.first.push_back(contrast({{first | own, 1}, {first, -1}}));
      effect.last.push_back(contrast({{last | own, 1}, {last, -1}}));
      effect.step.push_back(contrast({{step | own, 1}, {step, -1}}));
      effect.effect.push_back(contrast(owen_terms(order, i)));
    }
    for (GroupEffect& group : result.groups) {
      Terms terms;
      for (const std::size_t i : group.factors) {
        const Terms own = owen_terms(order, i);
        terms.insert(terms.end(), own.begin(), own.end());
      }
      group.effect.push_back(contrast(terms));
    }
    result.interactions.push_back(largest_interaction(order, contrast, result.groups));
  }
}

void add_divergences(const Behaviour& behaviour, const EngineFamily& family, const Order& order,
                     Attribution& result) {
  if (!behaviour.trace) return;
  result.has_traces = true;
  for (std::size_t i = 0; i < result.effects.size(); ++i) {
    const Mask before = order.before_first(i);
    const Trace without = behaviour.trace(family.with(names_of(family, before)), 0);
    const Trace with = behaviour.trace(family.with(names_of(family, before | Order::bit(i))), 0);
    result.effects[i].first_divergence =
        compare_traces(without, with, DivergenceTolerances::fine()).first_divergence;
  }
}

}  // namespace

const std::string& group_of(const ModelFactor& factor) noexcept {
  return factor.group.empty() ? factor.name : factor.group;
}

Cause Attribution::cause(std::size_t s) const {
  Cause cause;
  const double whole = gap[s].estimate;
  if (std::abs(whole) < margin[s] || gap[s].contains(0)) return cause;
  std::vector<const GroupEffect*> order;
  double sum = 0, with = 0, against = 0;
  for (const GroupEffect& group : groups) {
    const double effect = group.effect[s].estimate;
    order.push_back(&group);
    sum += std::abs(effect);
    (effect * whole > 0 ? with : against) += effect;
  }
  std::stable_sort(order.begin(), order.end(), [s](const GroupEffect* x, const GroupEffect* y) {
    return std::abs(x->effect[s].estimate) > std::abs(y->effect[s].estimate);
  });
  const std::string of = fmt::format("of {}", signed_amount(whole, statistics[s]));
  constexpr double kCancels = 2, kWorthNaming = 0.05;  // of the gap
  if (sum > kCancels * std::abs(whole)) {
    cause.kind = Cause::Kind::kNoSingle;
    cause.sentence = fmt::format("{}: no single cause, {:+.3g} and {:+.3g} nearly cancel", of, with, against);
    if (interactions[s])
      cause.sentence += fmt::format("; {} and {} together do {:+.3g} beyond what each does alone",
                                    interactions[s]->first, interactions[s]->second, interactions[s]->amount);
    return cause;
  }
  std::vector<std::string> parts;
  for (const GroupEffect* group : order) {
    const double effect = group->effect[s].estimate;
    if (std::abs(effect) >= kWorthNaming * std::abs(whole))
      parts.push_back(fmt::format("{} {:+.3g}", group->name, effect));
  }
  const auto helps = [&](const GroupEffect* g) {
    return g->effect[s].estimate * whole > 0 && !g->effect[s].contains(0);
  };
  cause.sentence = fmt::format("{}: {}", of, fmt::join(parts, ", "));
  // A smaller effect that is known better is not to blame for what the largest may do.
  const auto largest = std::find_if(order.begin(), order.end(),
                                    [&](const GroupEffect* g) { return g->effect[s].estimate * whole > 0; });
  if (largest == order.end() || !helps(*largest)) {
    cause.kind = Cause::Kind::kNoSingle;
    cause.sentence += std::any_of(order.begin(), order.end(), helps)
                          ? ", the largest of which cannot be told from zero"
                          : ", none of which can be told from zero";
    return cause;
  }
  cause.kind = Cause::Kind::kLeading;
  const Interval& most = (*largest)->effect[s];
  for (const GroupEffect* group : order) {
    const Interval& own = group->effect[s];
    const bool alike =
        std::abs(own.estimate) + own.half_width() >= std::abs(most.estimate) - most.half_width();
    if (helps(group) && alike) cause.leading.push_back(group->name);
  }
  return cause;
}

Attribution attribute(const Behaviour& behaviour, const EngineFamily& family,
                      const AttributionOptions& options, const Progress& progress) {
  family.validate();
  if (options.starts < 4)
    throw ConfigError("attribution", "starts", "4 or more", fmt::format("{}", options.starts));
  const Order order(family);
  const Runs runs = run_all(behaviour, family, order, options, progress);
  Attribution result;
  result.behaviour = behaviour.name;
  result.from = family.from;
  result.to = family.to;
  result.statistics = behaviour.statistics;
  result.statistics.push_back(
      {"failures", "failures", "fraction", {0, options.failures, false, "a share of runs that is stated"}});
  result.starts = options.starts;
  for (const ModelFactor& factor : family.factors) {
    FactorEffect effect;
    effect.factor = factor;
    result.effects.push_back(std::move(effect));
  }
  for (std::size_t i = 0; i < family.factors.size(); ++i) {
    const std::string& name = group_of(family.factors[i]);
    if (result.groups.empty() || result.groups.back().name != name) result.groups.push_back({name, {}, {}});
    result.groups.back().factors.push_back(i);
  }
  const double cells = static_cast<double>(family.factors.size() * result.statistics.size());
  add_effects(runs, order, 1 - (1 - options.confidence) / cells, result);
  add_divergences(behaviour, family, order, result);
  return result;
}

}  // namespace crossgait
