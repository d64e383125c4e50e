#include "parity/verdict.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/worker_pool.h"

namespace crossgait {
namespace {

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// Of the sample; zero for fewer than two.
double deviation(const std::vector<double>& values) {
  if (values.size() < 2) return 0;
  const double middle = mean(values);
  double squares = 0;
  for (const double v : values) squares += (v - middle) * (v - middle);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

// One statistic over the starts of one variation, all but `left_out`.
std::vector<double> column(const RunTable& runs, std::size_t variation, std::size_t statistic,
                           std::size_t left_out) {
  std::vector<double> values;
  for (std::size_t k = 0; k < runs[variation].size(); ++k) {
    if (k != left_out) values.push_back(runs[variation][k][statistic]);
  }
  return values;
}

WithinSpread within(const RunTable& runs, const std::vector<Variation>& variations, std::size_t statistic,
                    std::size_t left_out) {
  const auto over = [&](Variation::Kind kind) {
    std::vector<double> means;
    for (std::size_t v = 0; v < variations.size(); ++v) {
      if (variations[v].kind == Variation::Kind::kNominal || variations[v].kind == kind)
        means.push_back(mean(column(runs, v, statistic, left_out)));
    }
    return deviation(means);
  };
  return {deviation(column(runs, 0, statistic, left_out)), over(Variation::Kind::kTimeStep),
          over(Variation::Kind::kSolver)};
}

double pooled(const WithinSpread& a, const WithinSpread& b) {
  return std::sqrt((a.total() * a.total() + b.total() * b.total()) / 2);
}

StatisticVerdict judge_one(const std::vector<Statistic>& statistics, std::size_t s,
                           const std::vector<Variation>& variations, const RunTable& a, const RunTable& b,
                           const VerdictOptions& options, std::size_t pairs) {
  const std::size_t starts = a.front().size();
  StatisticVerdict v;
  v.statistic = statistics[s];
  v.mean_a = mean(column(a, 0, s, starts));
  v.mean_b = mean(column(b, 0, s, starts));
  v.spread_a = within(a, variations, s, starts);
  v.spread_b = within(b, variations, s, starts);
  v.spread = pooled(v.spread_a, v.spread_b);
  const double size = (std::abs(v.mean_a) + std::abs(v.mean_b)) / 2;
  v.floor = std::max(v.statistic.absolute_floor, v.statistic.relative_floor * size);

  const auto gap = [&](std::size_t left_out) {
    return mean(column(b, 0, s, left_out)) - mean(column(a, 0, s, left_out));
  };
  const auto score = [&](std::size_t left_out) {
    const double spread = pooled(within(a, variations, s, left_out), within(b, variations, s, left_out));
    return gap(left_out) / std::hypot(spread, v.floor);
  };
  const double confidence = 1 - (1 - options.confidence) / static_cast<double>(statistics.size() * pairs);
  v.gap = jackknife(starts, gap, confidence);
  v.score = jackknife(starts, score, confidence);
  if (v.score.low > -options.limit && v.score.high < options.limit) {
    v.value = VerdictValue::kAgrees;
  } else if (v.score.low > options.limit || v.score.high < -options.limit) {
    v.value = VerdictValue::kEngineDependent;
  }
  return v;
}

// All runs of all engines under every variation that the control step allows.
class Campaign {
 public:
  Campaign(const Behaviour& behaviour, std::span<const Engine> engines, const VerdictOptions& options)
      : behaviour_(behaviour), engines_(engines), options_(options), tables_(engines.size()) {
    for (const Variation& variation : variations()) {
      if (behaviour.allows(variation)) {
        variations_.push_back(variation);
      } else {
        left_out_.push_back(variation.name + ": the control step would not be a whole number of steps");
      }
    }
  }

  void run(const Progress& progress) {
    const std::size_t starts = options_.starts, per_engine = variations_.size() * starts,
                      count = engines_.size() * per_engine;
    for (RunTable& table : tables_)
      table.assign(variations_.size(), std::vector<std::vector<double>>(starts));
    SharedProgress shared(progress, count);
    WorkerPool pool(std::min(options_.workers, count));
    pool.run(count, [&](std::size_t i) {
      if (shared.interrupted()) return;
      const std::size_t engine = i / per_engine, v = i % per_engine / starts, k = i % starts;
      tables_[engine][v][k] = behaviour_.run(engines_[engine], variations_[v], k);
      shared.part_done();
    });
    if (shared.interrupted()) throw Interrupted();
  }

  // Not what the spread is to be made of: a time step at which an engine no longer works says nothing about
  // those at which it does.
  void leave_out_unstable() {
    for (std::size_t v = variations_.size() - 1; v > 0; --v) {
      for (std::size_t e = 0; e < engines_.size(); ++e) {
        if (failures(e, v) <= failures(e, 0)) continue;
        left_out_.push_back(fmt::format("{}: {} of {} runs fail in {}, {} as asked", variations_[v].name,
                                        failures(e, v), options_.starts, engines_[e].name(), failures(e, 0)));
        variations_.erase(variations_.begin() + static_cast<std::ptrdiff_t>(v));
        for (RunTable& table : tables_) table.erase(table.begin() + static_cast<std::ptrdiff_t>(v));
        break;
      }
    }
  }

  std::vector<Verdict> judge_all() const {
    const std::size_t n = engines_.size();
    std::vector<Verdict> verdicts;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = i + 1; k < n; ++k) {
        verdicts.push_back(
            {behaviour_.name, engines_[i].name(), engines_[k].name(), options_, variations_, left_out_,
             judge(behaviour_.statistics, variations_, tables_[i], tables_[k], options_, n * (n - 1) / 2)});
      }
    }
    return verdicts;
  }

 private:
  long failures(std::size_t engine, std::size_t variation) const {
    double count = 0;
    for (std::size_t s = 0; s < behaviour_.statistics.size(); ++s) {
      if (!behaviour_.statistics[s].counts_failures) continue;
      for (const auto& run : tables_[engine][variation]) count += run[s];
    }
    return std::lround(count);
  }

  const Behaviour& behaviour_;
  std::span<const Engine> engines_;
  VerdictOptions options_;
  std::vector<Variation> variations_;
  std::vector<std::string> left_out_;
  std::vector<RunTable> tables_;
};

}  // namespace

std::string_view name(VerdictValue value) noexcept {
  constexpr std::array<std::string_view, 3> kNames{"agrees", "engine-dependent", "unresolved"};
  return kNames[static_cast<std::size_t>(value)];
}

double WithinSpread::total() const noexcept {
  return std::sqrt(starts * starts + time_step * time_step + solver * solver);
}

void VerdictOptions::validate() const {
  const auto require = [](bool ok, const char* element, const char* expected, double found) {
    if (!ok) throw ConfigError("verdict", element, expected, fmt::format("{:g}", found));
  };
  require(starts >= 4 && starts <= 10000, "starts", "4 to 10000", static_cast<double>(starts));
  require(limit > 0 && std::isfinite(limit), "limit", "a positive number", limit);
  require(confidence > 0 && confidence < 1, "confidence", "a number between 0 and 1", confidence);
  require(workers >= 1, "workers", "1 or more", static_cast<double>(workers));
}

VerdictValue Verdict::value() const noexcept {
  const auto any = [this](VerdictValue what) {
    return std::any_of(statistics.begin(), statistics.end(),
                       [what](const auto& s) { return s.value == what; });
  };
  if (any(VerdictValue::kEngineDependent)) return VerdictValue::kEngineDependent;
  return any(VerdictValue::kUnresolved) ? VerdictValue::kUnresolved : VerdictValue::kAgrees;
}

std::vector<StatisticVerdict> judge(const std::vector<Statistic>& statistics,
                                    const std::vector<Variation>& variations, const RunTable& a,
                                    const RunTable& b, const VerdictOptions& options, std::size_t pairs) {
  std::vector<StatisticVerdict> result;
  for (std::size_t s = 0; s < statistics.size(); ++s)
    result.push_back(judge_one(statistics, s, variations, a, b, options, pairs));
  return result;
}

std::vector<Verdict> reach_verdicts(const Behaviour& behaviour, std::span<const Engine> engines,
                                    const VerdictOptions& options, const Progress& progress) {
  options.validate();
  if (engines.size() < 2)
    throw ConfigError("verdict", "engines", "two or more", fmt::format("{}", engines.size()));
  Campaign campaign(behaviour, engines, options);
  campaign.run(progress);
  campaign.leave_out_unstable();
  return campaign.judge_all();
}

Verdict reach_verdict(const Behaviour& behaviour, const Engine& a, const Engine& b,
                      const VerdictOptions& options, const Progress& progress) {
  const std::array<Engine, 2> both{a, b};
  return reach_verdicts(behaviour, both, options, progress).front();
}

}  // namespace crossgait
