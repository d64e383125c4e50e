#include "parity/verdict.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "parity/verdict_runs.h"
#include "physics/core/error.h"

namespace crossgait {
namespace {

std::vector<EnginePair> pairs_of(std::size_t engines) {
  std::vector<EnginePair> pairs;
  for (std::size_t a = 0; a < engines; ++a) {
    for (std::size_t b = a + 1; b < engines; ++b) pairs.push_back({a, b});
  }
  return pairs;
}

// Takes out the rows that nothing can be said of, because no run has a value.
std::vector<Statistic> take_undefined(std::vector<StatisticRuns>& rows) {
  std::vector<Statistic> undefined;
  for (const StatisticRuns& row : rows) {
    if (!row.is_defined) undefined.push_back(row.statistic);
  }
  std::erase_if(rows, [](const StatisticRuns& row) { return !row.is_defined; });
  return undefined;
}

// A pair's word from its statistics, with what goes with it.
void sum_up(Verdict& verdict) {
  verdict.word = worst_word(verdict.statistics);
  std::vector<std::string> reasons;
  for (const StatisticVerdict& s : verdict.statistics) {
    if (verdict.word == Word::kAgrees) {
      if (!s.reason.empty() && s.statistic.key == "failures")
        reasons.push_back(fmt::format("{}: {}", s.statistic.name, s.reason));
    } else if (s.word == verdict.word) {
      reasons.push_back(s.statistic.name);
    }
  }
  verdict.reason = fmt::format("{}", fmt::join(reasons, ", "));
  if (verdict.word != Word::kUnresolved) return;
  std::size_t most = 0;
  for (const StatisticVerdict& s : verdict.statistics) {
    if (s.word != Word::kUnresolved) continue;
    if (!s.starts_needed) return;
    most = std::max(most, *s.starts_needed);
  }
  verdict.starts_needed = most;
}

// Words of the first `starts`, with whatever runs they ask for.
class Look {
 public:
  Look(const Behaviour& behaviour, std::span<const Engine> engines, const VerdictOptions& options,
       VerdictRuns& runs, std::size_t starts)
      : behaviour_(behaviour), engines_(engines), options_(options), runs_(runs), starts_(starts) {}

  std::vector<Verdict> judge_all(const Progress& progress) {
    std::vector<Verdict> verdicts = judge_with({}, progress);
    // A quarter of the step where half of it has changed a word.
    std::set<EnginePair> open;
    const std::vector<EnginePair> pairs = pairs_of(engines_.size());
    for (std::size_t p = 0; p < pairs.size(); ++p) {
      const auto& all = verdicts[p].statistics;
      const auto depends = [](const StatisticVerdict& s) { return s.word == Word::kStepDependent; };
      if (std::any_of(all.begin(), all.end(), depends)) open.insert(pairs[p]);
    }
    if (open.empty()) return verdicts;
    // It says where the gap goes, and changes no word.
    const std::vector<Verdict> finer = judge_with(open, progress);
    for (std::size_t p = 0; p < verdicts.size(); ++p) {
      for (std::size_t s = 0; s < verdicts[p].statistics.size(); ++s) {
        std::optional<StepCheck>& step = verdicts[p].statistics[s].step;
        const std::optional<StepCheck>& three = finer[p].statistics[s].step;
        if (!step || !three) continue;
        step->quarter = three->quarter;
        step->order = three->order;
        step->extrapolated = three->extrapolated;
      }
    }
    return verdicts;
  }

 private:
  std::vector<Verdict> judge_with(const std::set<EnginePair>& quarter, const Progress& progress) {
    const std::vector<EnginePair> pairs = pairs_of(engines_.size());
    std::vector<std::vector<StatisticRuns>> rows;
    for (;;) {
      rows.clear();
      for (const EnginePair& pair : pairs) rows.push_back(runs_.rows(pair, starts_, quarter.contains(pair)));
      if (runs_.campaign().is_complete()) break;
      runs_.campaign().make_missing(progress);
    }
    std::vector<StatisticRuns> all;
    std::vector<std::vector<Statistic>> undefined;
    for (auto& of_pair : rows) {
      undefined.push_back(take_undefined(of_pair));
      all.insert(all.end(), of_pair.begin(), of_pair.end());
    }
    std::vector<StatisticVerdict> judged = judge(all, options_);
    std::vector<Verdict> verdicts;
    auto next = std::make_move_iterator(judged.begin());
    for (std::size_t p = 0; p < pairs.size(); ++p) {
      const auto [a, b] = pairs[p];
      Verdict verdict{behaviour_.name,
                      engines_[a].name(),
                      engines_[b].name(),
                      runs_.outcomes(a, starts_),
                      runs_.outcomes(b, starts_),
                      runs_.cut(pairs[p], starts_),
                      {},
                      std::move(undefined[p]),
                      Word::kUnresolved,
                      {},
                      {}};
      const auto end = next + static_cast<std::ptrdiff_t>(rows[p].size());
      verdict.statistics.assign(next, end);
      next = end;
      sum_up(verdict);
      verdicts.push_back(std::move(verdict));
    }
    return verdicts;
  }

  const Behaviour& behaviour_;
  std::span<const Engine> engines_;
  const VerdictOptions& options_;
  VerdictRuns& runs_;
  std::size_t starts_;
};

void list_variations(const Behaviour& behaviour, std::span<const Engine> engines, Verdicts& result) {
  for (const Variation& variation : variations()) {
    const auto concerns = [&](const Engine& e) { return variation.of(e.info); };
    if (&variation == &quarter_step() || std::none_of(engines.begin(), engines.end(), concerns)) continue;
    const std::string reason = behaviour.why_not(variation);
    if (reason.empty()) {
      result.variations.emplace_back(variation.name);
    } else {
      result.left_out.push_back(fmt::format("{}: {}", variation.name, reason));
    }
  }
}

}  // namespace

std::string_view name(Word word) noexcept {
  constexpr std::array<std::string_view, 4> kNames{"agrees", "differs", "step-dependent", "unresolved"};
  return kNames[static_cast<std::size_t>(word)];
}

void VerdictOptions::validate() const {
  const auto require = [](bool ok, const char* element, const char* expected, double found) {
    if (!ok) throw ConfigError("verdict", element, expected, fmt::format("{:g}", found));
  };
  require(starts >= 4 && starts <= 10000, "starts", "4 to 10000", static_cast<double>(starts));
  require(looks >= 1 && looks <= 20 && (looks == 1 || starts / looks >= kFewestStarts), "looks",
          "1 to 20, each of 6 starts or more", static_cast<double>(looks));
  require(confidence >= kLeastConfidence && confidence < 1, "confidence",
          "0.8 or more, and less than 1: below, a word says little", confidence);
  require(failures > 0 && failures < 1, "failures", "a share between 0 and 1", failures);
  require(workers >= 1, "workers", "1 or more", static_cast<double>(workers));
}

Verdicts reach_verdicts(const Behaviour& behaviour, std::span<const Engine> engines,
                        const VerdictOptions& options, const Progress& progress) {
  options.validate();
  if (engines.size() < 2)
    throw ConfigError("verdict", "engines", "two or more", fmt::format("{}", engines.size()));
  const Behaviour judged = with_margins(behaviour, options.margins);
  Verdicts result;
  result.options = options;
  for (const Engine& engine : engines) result.engines.push_back(engine.name());
  list_variations(judged, engines, result);
  VerdictRuns runs(judged, engines, options);
  while (result.looks_made < options.looks) {
    ++result.looks_made;
    result.starts = (options.starts * result.looks_made + options.looks - 1) / options.looks;
    std::vector<Verdict> pairs = Look(judged, engines, options, runs, result.starts).judge_all(progress);
    // A word that was reached at a planned look is final.
    for (std::size_t p = 0; p < result.pairs.size(); ++p) {
      if (result.pairs[p].word != Word::kUnresolved) pairs[p] = std::move(result.pairs[p]);
    }
    result.pairs = std::move(pairs);
    const auto open = [](const Verdict& v) { return v.word == Word::kUnresolved; };
    if (std::none_of(result.pairs.begin(), result.pairs.end(), open)) break;
  }
  return result;
}

}  // namespace crossgait
