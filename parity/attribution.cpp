#include "parity/attribution.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/worker_pool.h"

namespace crossgait {
namespace {

using Mask = unsigned;  // of factors

// Which factors each needs and is needed by, as sets.
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
    count_ways();
  }

  static Mask bit(std::size_t i) { return Mask{1} << i; }
  Mask all() const { return bit(count_) - 1; }
  Mask before_first(std::size_t i) const { return needs_[i]; }
  Mask before_last(std::size_t i) const { return all() & ~needed_[i] & ~bit(i); }
  Mask before_step(std::size_t i) const { return bit(i) - 1; }
  bool allows(Mask set) const {
    for (std::size_t i = 0; i < count_; ++i) {
      if ((set & bit(i)) != 0 && (needs_[i] & ~set) != 0) return false;
    }
    return true;
  }
  /// Share of all orders in which i comes right after the set `before`, for every such set.
  std::vector<std::pair<Mask, double>> shares(std::size_t i) const {
    std::vector<std::pair<Mask, double>> result;
    for (Mask before = 0; before <= all(); ++before) {
      const Mask after = before | bit(i);
      if (after == before || !allows(before) || !allows(after)) continue;
      result.emplace_back(before, ways_to_[before] * ways_from_[after] / ways_to_[all()]);
    }
    return result;
  }

 private:
  // Numbers of orders that lead from nothing to each set, and from it to everything.
  void count_ways() {
    ways_to_.assign(all() + 1, 0);
    ways_from_.assign(all() + 1, 0);
    ways_to_[0] = ways_from_[all()] = 1;
    for (Mask set = 0; set <= all(); ++set) {
      for (std::size_t i = 0; i < count_ && allows(set); ++i) {
        if ((set & bit(i)) != 0 && allows(set & ~bit(i))) ways_to_[set] += ways_to_[set & ~bit(i)];
      }
    }
    for (Mask set = all() + 1; set-- > 0;) {
      for (std::size_t i = 0; i < count_ && allows(set); ++i) {
        if ((set & bit(i)) == 0 && allows(set | bit(i))) ways_from_[set] += ways_from_[set | bit(i)];
      }
    }
  }

  std::vector<double> ways_to_, ways_from_;
  std::size_t count_;
  std::vector<Mask> needs_, needed_;
};

// values[start][statistic] of every set of factors that was run.
using Runs = std::map<Mask, std::vector<std::vector<double>>>;

std::vector<std::string> names_of(const EngineFamily& family, Mask mask) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < family.factors.size(); ++i) {
    if ((mask & Order::bit(i)) != 0) names.push_back(family.factors[i].name);
  }
  return names;
}

Runs run_all(const Behaviour& behaviour, const EngineFamily& family, const Order& order,
             const AttributionOptions& options, const Progress& progress) {
  std::vector<Mask> masks;
  for (Mask mask = 0; mask <= order.all(); ++mask) {
    if (order.allows(mask)) masks.push_back(mask);
  }
  Runs runs;
  std::vector<Engine> engines;
  for (const Mask mask : masks) {
    runs[mask].resize(options.starts);
    engines.push_back(family.with(names_of(family, mask)));
  }
  const std::size_t count = masks.size() * options.starts;
  SharedProgress shared(progress, count);
  WorkerPool pool(std::min(options.workers, count));
  pool.run(count, [&](std::size_t i) {
    if (shared.interrupted()) return;
    const std::size_t m = i / options.starts, k = i % options.starts;
    runs.at(masks[m])[k] = behaviour.run(engines[m], variations().front(), k);
    shared.part_done();
  });
  if (shared.interrupted()) throw Interrupted();
  return runs;
}

// Sum over sets of weight times the mean over starts.
class Contrast {
 public:
  Contrast(const Runs& runs, std::size_t statistic, std::size_t starts, double confidence)
      : runs_(runs), statistic_(statistic), starts_(starts), confidence_(confidence) {}

  Interval operator()(const std::vector<std::pair<Mask, double>>& terms) const {
    const auto estimate = [&](std::size_t left_out) {
      double sum = 0;
      std::size_t used = 0;
      for (std::size_t k = 0; k < starts_; ++k) {
        if (k == left_out) continue;
        ++used;
        for (const auto& [mask, weight] : terms) sum += weight * runs_.at(mask)[k][statistic_];
      }
      return sum / static_cast<double>(used);
    };
    return jackknife(starts_, estimate, confidence_);
  }

 private:
  const Runs& runs_;
  std::size_t statistic_, starts_;
  double confidence_;
};

void add_effects(const Runs& runs, const Order& order, double confidence, Attribution& result) {
  for (std::size_t s = 0; s < result.statistics.size(); ++s) {
    const Contrast contrast(runs, s, result.starts, confidence);
    const Interval from = contrast({{0, 1}}), to = contrast({{order.all(), 1}});
    result.from_mean.push_back(from.estimate);
    result.to_mean.push_back(to.estimate);
    result.gap.push_back(contrast({{order.all(), 1}, {0, -1}}));
    const Statistic& statistic = result.statistics[s];
    result.floor.push_back(
        std::max(statistic.absolute_floor,
                 statistic.relative_floor * (std::abs(from.estimate) + std::abs(to.estimate)) / 2));
    for (std::size_t i = 0; i < result.effects.size(); ++i) {
      FactorEffect& effect = result.effects[i];
      const Mask own = Order::bit(i), first = order.before_first(i), last = order.before_last(i),
                 step = order.before_step(i);
      effect.first.push_back(contrast({{first | own, 1}, {first, -1}}));
      effect.last.push_back(contrast({{last | own, 1}, {last, -1}}));
      effect.step.push_back(contrast({{step | own, 1}, {step, -1}}));
      std::vector<std::pair<Mask, double>> terms;
      for (const auto& [before, share] : order.shares(i)) {
        terms.emplace_back(before | own, share);
        terms.emplace_back(before, -share);
      }
      effect.effect.push_back(contrast(terms));
    }
  }
}

void add_divergences(const Behaviour& behaviour, const EngineFamily& family, const Order& order,
                     Attribution& result) {
  if (!behaviour.trace) return;
  for (std::size_t i = 0; i < result.effects.size(); ++i) {
    const Mask before = order.before_first(i);
    const Trace without = behaviour.trace(family.with(names_of(family, before)), 0);
    const Trace with = behaviour.trace(family.with(names_of(family, before | Order::bit(i))), 0);
    result.effects[i].first_divergence =
        compare_traces(without, with, DivergenceTolerances::fine()).first_divergence;
  }
}

}  // namespace

std::vector<std::string> Attribution::leading(std::size_t statistic) const {
  std::vector<std::string> names;
  if (std::abs(gap[statistic].estimate) < floor[statistic]) return names;
  const auto size = [&](const FactorEffect& e) { return std::abs(e.effect[statistic].estimate); };
  const auto largest = std::max_element(effects.begin(), effects.end(),
                                        [&](const auto& x, const auto& y) { return size(x) < size(y); });
  const Interval& most = largest->effect[statistic];
  if (most.contains(0)) return names;
  names.push_back(largest->factor.name);
  for (const FactorEffect& effect : effects) {
    const Interval& own = effect.effect[statistic];
    const bool alike = size(effect) + own.half_width() >= size(*largest) - most.half_width();
    if (&effect != &*largest && alike && !own.contains(0)) names.push_back(effect.factor.name);
  }
  return names;
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
  result.starts = options.starts;
  for (const ModelFactor& factor : family.factors) {
    FactorEffect effect;
    effect.factor = factor;
    result.effects.push_back(std::move(effect));
  }
  const double cells = static_cast<double>(family.factors.size() * behaviour.statistics.size());
  add_effects(runs, order, 1 - (1 - options.confidence) / cells, result);
  add_divergences(behaviour, family, order, result);
  return result;
}

}  // namespace crossgait
