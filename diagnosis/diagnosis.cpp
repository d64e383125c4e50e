#include "diagnosis/diagnosis.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "diagnosis/cure_search.h"
#include "diagnosis/import_table.h"
#include <fmt/format.h>

#include "backends/registry.h"
#include "parity/paired_differences.h"
#include "physics/core/error.h"
#include "physics/core/random.h"

namespace crossgait {
namespace {

constexpr double kConfidence = 0.95;
constexpr std::size_t kRanked = 10;
constexpr double kMostMinutes = 1e4;

std::set<std::string> fields_of(const Candidate& candidate) {
  return {candidate.fields.begin(), candidate.fields.end()};
}

// What two changes have to be better by than one, since two always fit better.
constexpr double kSecondChange = 0.15;

double ranking_score(const Candidate& candidate) {
  return candidate.whole->mean() + (candidate.fields.size() > 1 ? kSecondChange : 0);
}

// One of every field, or pair of fields: cures first, then by score.
std::vector<Candidate> rank(std::vector<Candidate> candidates, const Search& search) {
  std::stable_sort(candidates.begin(), candidates.end(), [&](const Candidate& a, const Candidate& b) {
    const bool cures_a = cures(a, search), cures_b = cures(b, search);
    return cures_a != cures_b ? cures_a : ranking_score(a) < ranking_score(b);
  });
  std::vector<Candidate> ranked;
  std::set<std::set<std::string>> seen;
  for (Candidate& candidate : candidates) {
    if (ranked.size() < kRanked && seen.insert(fields_of(candidate)).second)
      ranked.push_back(std::move(candidate));
  }
  return ranked;
}

// Of resamplings of the walks, the share in which each is the best.
std::vector<double> shares_of_first(const std::vector<Candidate>& ranked, std::uint64_t seed) {
  constexpr int kResamplings = 1000;
  std::vector<double> shares(ranked.size(), 0);
  if (ranked.empty()) return shares;
  const std::size_t walks = ranked.front().whole->scores.size();
  Random random(seed);
  std::vector<double> sums(ranked.size());
  for (int k = 0; k < kResamplings; ++k) {
    std::fill(sums.begin(), sums.end(), 0.0);
    for (std::size_t w = 0; w < walks; ++w) {
      const auto drawn =
          std::min(walks - 1, static_cast<std::size_t>(random.uniform(0, static_cast<double>(walks))));
      for (std::size_t i = 0; i < ranked.size(); ++i) sums[i] += ranked[i].whole->scores[drawn];
    }
    shares[static_cast<std::size_t>(std::min_element(sums.begin(), sums.end()) - sums.begin())] +=
        1.0 / kResamplings;
  }
  return shares;
}

RankedChange ranked_change(const Candidate& candidate, const WalkResult& patient, double confidence,
                           const Search& search) {
  const std::size_t seeds = search.whole_test().seeds;
  std::vector<double> effects = patient.by_seed(seeds);
  const std::vector<double> with = candidate.whole->by_seed(seeds);
  for (std::size_t k = 0; k < seeds; ++k) effects[k] -= with[k];
  const Interval effect = PairedDifferences(effects).interval(kConfidence);
  RankedChange change{.field = candidate.field, .from = candidate.from, .to = candidate.to};
  change.score = candidate.whole->mean();
  change.effect = effect.estimate;
  change.low = effect.low;
  change.high = effect.high;
  change.confidence = confidence;
  change.physics = candidate.physics;
  change.unstated = candidate.unstated;
  change.cures = cures(candidate, search);
  change.leaves = change.cures ? "" : what_is_wrong(*candidate.whole, search.whole_test());
  change.config = candidate.config;
  return change;
}

// Scores that lie so near are one: so much a field that is right takes away of a healthy policy's score when
// it is changed.
constexpr double kSameScore = 0.06;

// Cures that explain as much as the first of the ranking.
std::size_t count_rivals(const std::vector<Candidate>& ranked, double spread, const Search& search) {
  std::size_t count = 0;
  while (count < ranked.size() && cures(ranked[count], search) &&
         ranking_score(ranked[count]) - ranking_score(ranked.front()) < std::max(spread, kSameScore))
    ++count;
  return count;
}

// Of cures that explain as much those come first that a test without walking points at, or else those that
// nobody stated. @returns how many then are as likely as the first
std::size_t put_suspects_first(std::vector<Candidate>& ranked, std::size_t rivals) {
  const auto end = ranked.begin() + static_cast<std::ptrdiff_t>(rivals);
  for (const auto is_likelier : {&Candidate::suspect, &Candidate::unstated}) {
    const auto others = std::stable_partition(
        ranked.begin(), end, [is_likelier](const Candidate& candidate) { return candidate.*is_likelier; });
    if (others != ranked.begin()) return static_cast<std::size_t>(others - ranked.begin());
  }
  return rivals;
}

// By how much a score may differ from the mean: the interval is that of the mean.
double spread_of(const Candidate& candidate, std::size_t seeds) {
  const Interval mean = PairedDifferences(candidate.whole->by_seed(seeds)).interval(kConfidence);
  return mean.half_width() * std::sqrt(static_cast<double>(seeds));
}

// The walk in which two explanations differ most.
std::string telling_walk(const Candidate& a, const Candidate& b, const WalkTest& test) {
  double most = -1;
  std::string words;
  for (std::size_t w = 0; w < a.whole->walks.size(); ++w) {
    const WalkMeasure &x = a.whole->walks[w], &y = b.whole->walks[w];
    const double speed = std::abs(x.speed_error - y.speed_error),
                 turn = std::abs(x.yaw_rate_error - y.yaw_rate_error);
    if (speed + turn <= most) continue;
    most = speed + turn;
    words = fmt::format(
        "look up {} and {} where the policy was trained, or walk it there {}: it misses the speed by {:.3f} "
        "m/s and the yaw rate by {:.3f} rad/s with the first, by {:.3f} and {:.3f} with the second",
        a.field, b.field, test.commands[w / test.seeds].name, x.speed_error, x.yaw_rate_error, y.speed_error,
        y.yaw_rate_error);
  }
  return words;
}

std::string in_words(const RankedChange& change) {
  return fmt::format("{}: {} in the place of {}", change.field, change.to, change.from);
}

// @param rivals  how many of the ranking are as likely as its first
void conclude_cured(Diagnosis& result, const std::vector<Candidate>& ranked, std::size_t rivals,
                    const Search& search) {
  const RankedChange& first = result.ranking.front();
  if (first.effect <= result.spread) {
    result.abstained = true;
    result.experiment = "walk it from other starts (--seed): its scores differ as much from start to start";
    result.summary = fmt::format("The policy {}, which {} cures, but by no more than starts differ by.",
                                 result.complaint, first.field);
    return;
  }
  if (rivals > 1) {
    result.abstained = true;
    result.experiment = telling_walk(ranked[0], ranked[1], search.whole_test());
    result.summary = fmt::format("The policy {}; {} and {} explain it as well as one another.",
                                 result.complaint, result.ranking[0].field, result.ranking[1].field);
    return;
  }
  result.cause = first.physics ? CauseKind::kPhysics : CauseKind::kContract;
  result.summary = fmt::format("The policy {} because of its {}: it does what it is asked with {}.",
                               result.complaint, name(*result.cause), in_words(first));
}

// Nothing cures it: what the home engine says.
void conclude_uncured(Diagnosis& result, const LoadedEnv& environment, const RelabelledPolicy& policy,
                      const Search& search, const DiagnosisOptions& options) {
  const std::string best = result.ranking.empty()
                               ? "nothing that was tried helps"
                               : fmt::format("the best that was tried is {}, with which it {}",
                                             in_words(result.ranking.front()), result.ranking.front().leaves);
  const std::string nothing =
      result.cut_short
          ? fmt::format("no change of one field cures it, nor any of two that were tried in {:g} minutes",
                        options.minutes)
          : "no change of one or two fields cures it";
  const std::string longer = result.cut_short ? "search for longer (--minutes), or " : "";
  if (!options.home_engine) {
    result.abstained = true;
    result.experiment =
        longer +
        "run it, as it is, in the engine that it was trained in (--home-engine): if it does what it is asked "
        "there, the physics is the cause; if not, the policy, or what it was asked";
    result.summary = fmt::format("The policy {}, and {}: {}.", result.complaint, nothing, best);
    return;
  }
  LoadedEnv home = environment;
  home.config.engine = *options.home_engine;
  const WalkResult there = run_walks(home, policy, search.whole_test(), options.seed);
  if (does_what_is_asked(there, search.whole_test().seeds)) {
    result.cause = CauseKind::kPhysics;
    result.summary =
        fmt::format("The policy {} because of the physics: in {} it does what it is asked, as it is.",
                    result.complaint, *options.home_engine);
    return;
  }
  const std::string there_too =
      fmt::format("The policy {}, in {} as well, and {}", result.complaint, *options.home_engine, nothing);
  if (result.cut_short) {
    result.abstained = true;
    result.experiment = "search for longer (--minutes)";
    result.summary = fmt::format("{}: {}.", there_too, best);
    return;
  }
  result.cause = CauseKind::kPolicy;
  result.summary = fmt::format("{}: it is the policy itself, or what it was asked; {}.", there_too, best);
}

void require_joints(const LoadedEnv& environment) {
  if (environment.config.action != ActionKind::kJoints)
    throw ConfigError(environment.config.source, "action", "joints, whose contract a diagnosis looks at",
                      "gait");
}

}  // namespace

Diagnosis diagnose(const LoadedEnv& environment, const std::string& policy_text,
                   const DiagnosisOptions& options, const Progress& progress) {
  require_joints(environment);
  if (!(options.minutes >= 0 && options.minutes <= kMostMinutes))
    throw ConfigError("diagnose", "minutes", fmt::format("0 (no limit) to {:g}", kMostMinutes),
                      fmt::format("{:g}", options.minutes));
  if (options.home_engine) static_cast<void>(find_engine(*options.home_engine));
  const RelabelledPolicy policy = read_relabelled_policy(policy_text);
  Diagnosis result;
  result.environment = environment.config;
  result.tests = run_standing_tests(environment, policy, options.seed);
  Suspicion suspicion{options.unstated, {}};
  for (std::string& field : unstated_fields(policy_text)) suspicion.unstated.push_back(std::move(field));
  for (const StandingTest& test : result.tests)
    if (test.judged && !test.passed)
      suspicion.suspects.insert(suspicion.suspects.end(), test.suspects.begin(), test.suspects.end());
  Search search(environment, policy, suspicion, options.workers, options.seed, options.minutes);
  const WalkResult patient = search.examine();
  result.test = search.whole_test();
  result.as_given = patient;
  result.score = patient.mean();
  result.complaint = what_is_wrong(patient, search.whole_test());
  result.healthy = does_what_is_asked(patient, search.whole_test().seeds);
  result.configurations = search.configurations();
  if (result.healthy) {
    result.summary = "The policy does what it is asked: no cause is named.";
    return result;
  }
  if (!options.search) {
    result.summary = fmt::format("The policy {}.", result.complaint);
    return result;
  }
  std::vector<Candidate> ranked = rank(search_cures(search, progress), search);
  result.cut_short = search.was_cut_short();
  std::size_t rivals = 0;
  if (!ranked.empty()) {
    const std::size_t seeds = search.whole_test().seeds;
    rivals = count_rivals(ranked, spread_of(ranked.front(), seeds), search);
    rivals = put_suspects_first(ranked, put_needless_pairs_last(ranked, rivals));
    result.spread = spread_of(ranked.front(), seeds);
  }
  const std::vector<double> shares = shares_of_first(ranked, options.seed);
  for (std::size_t i = 0; i < ranked.size(); ++i)
    result.ranking.push_back(ranked_change(ranked[i], patient, shares[i], search));
  if (!result.ranking.empty()) {
    result.environment = result.ranking.front().config;
    result.changed = ranked.front().whole;
  }
  if (rivals > 0) {
    conclude_cured(result, ranked, rivals, search);
  } else {
    conclude_uncured(result, environment, policy, search, options);
  }
  result.configurations = search.configurations();
  return result;
}

std::string_view name(CauseKind kind) noexcept {
  constexpr std::array<std::string_view, 3> kNames{"contract", "physics", "policy"};
  return kNames[static_cast<std::size_t>(kind)];
}

}  // namespace crossgait
