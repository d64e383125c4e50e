#include "parity/consensus.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace crossgait {
namespace {

using Indices = std::vector<std::size_t>;

// How far apart two engines may be: the largest end of any statistic's interval, in margins.
double distance(const Verdict& pair) {
  double most = 0;
  for (const StatisticVerdict& s : pair.statistics) {
    // Shares of runs that were seen in no engine lie equally far apart in all pairs.
    if (s.margin > 0 && s.statistic.unit != "fraction")
      most = std::max({most, std::abs(s.gap.low) / s.margin, std::abs(s.gap.high) / s.margin});
  }
  return most;
}

class Words {
 public:
  Words(const std::vector<JudgedEngine>& engines, const std::vector<Verdict>& pairs)
      : engines_(engines), pairs_(pairs) {}

  std::size_t engines() const { return engines_.size(); }
  const Verdict& pair(std::size_t i, std::size_t k) const {
    return pairs_[pair_index(std::min(i, k), std::max(i, k), engines_.size())];
  }
  bool is(std::size_t i, std::size_t k, Word what) const { return pair(i, k).word == what; }

  bool all_across(const Indices& a, const Indices& b, Word what) const {
    return std::all_of(a.begin(), a.end(), [&](std::size_t i) {
      return std::all_of(b.begin(), b.end(), [&](std::size_t k) { return is(i, k, what); });
    });
  }
  bool all_agree(const Indices& a) const {
    for (std::size_t i = 0; i < a.size(); ++i) {
      for (std::size_t k = i + 1; k < a.size(); ++k) {
        if (!is(a[i], a[k], Word::kAgrees)) return false;
      }
    }
    return true;
  }
  std::set<std::string> laws(const Indices& a) const {
    std::set<std::string> found;
    for (const std::size_t i : a) found.insert(engines_[i].law);
    return found;
  }
  /// Opinions among these engines: laws, of which relatives that nobody found to differ are one.
  std::size_t votes(const Indices& a, bool families) const {
    std::vector<Indices> opinions;
    for (const std::size_t i : a) {
      const auto same = std::find_if(opinions.begin(), opinions.end(),
                                     [&](const Indices& o) { return is_one_opinion(o, i, families); });
      if (same == opinions.end()) {
        opinions.push_back({i});
      } else {
        same->push_back(i);
      }
    }
    return opinions.size();
  }
  Indices without(const Indices& a) const {
    Indices rest;
    for (std::size_t i = 0; i < engines_.size(); ++i) {
      if (std::find(a.begin(), a.end(), i) == a.end()) rest.push_back(i);
    }
    return rest;
  }
  std::string names(const Indices& a) const {
    std::vector<std::string> found;
    for (const std::size_t i : a) found.push_back(engines_[i].name);
    return fmt::format("{}", fmt::join(found, ", "));
  }

 private:
  bool is_one_opinion(const Indices& opinion, std::size_t i, bool families) const {
    return std::all_of(opinion.begin(), opinion.end(), [&](std::size_t k) {
      const bool relatives = families && !engines_[i].family.empty() &&
                             engines_[i].family == engines_[k].family && !is(i, k, Word::kDiffers);
      return engines_[i].law == engines_[k].law || relatives;
    });
  }

  const std::vector<JudgedEngine>& engines_;
  const std::vector<Verdict>& pairs_;
};

double farthest(const Words& words, const Indices& a, const Indices& b) {
  double most = 0;
  for (const std::size_t i : a) {
    for (const std::size_t k : b) most = std::max(most, distance(words.pair(i, k)));
  }
  return most;
}

std::vector<Indices> clusters_of(const Words& words) {
  std::vector<Indices> clusters;
  for (std::size_t i = 0; i < words.engines(); ++i) clusters.push_back({i});
  for (;;) {
    std::size_t a = 0, b = 0;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < clusters.size(); ++i) {
      for (std::size_t k = i + 1; k < clusters.size(); ++k) {
        if (!words.all_across(clusters[i], clusters[k], Word::kAgrees)) continue;
        const double far = farthest(words, clusters[i], clusters[k]);
        if (far >= nearest) continue;
        nearest = far;
        a = i;
        b = k;
      }
    }
    if (a == b) break;
    clusters[a].insert(clusters[a].end(), clusters[b].begin(), clusters[b].end());
    clusters.erase(clusters.begin() + static_cast<std::ptrdiff_t>(b));
  }
  for (Indices& cluster : clusters) std::sort(cluster.begin(), cluster.end());
  std::stable_sort(clusters.begin(), clusters.end(),
                   [](const Indices& x, const Indices& y) { return x.size() > y.size(); });
  return clusters;
}

Indices bridges_of(const Words& words, const std::vector<Indices>& clusters) {
  Indices bridges;
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    for (std::size_t d = c + 1; d < clusters.size(); ++d) {
      for (const std::size_t i : clusters[c]) {
        for (const std::size_t k : clusters[d]) {
          if (words.is(i, k, Word::kAgrees))
            bridges.push_back(pair_index(std::min(i, k), std::max(i, k), words.engines()));
        }
      }
    }
  }
  std::sort(bridges.begin(), bridges.end());
  return bridges;
}

// Single engines first, then all engines of a law that has several.
std::vector<Indices> candidates(const Words& words, const std::vector<JudgedEngine>& engines) {
  std::vector<Indices> found;
  for (std::size_t i = 0; i < engines.size(); ++i) found.push_back({i});
  std::set<std::string> seen;
  for (const JudgedEngine& engine : engines) {
    if (!seen.insert(engine.law).second) continue;
    Indices of_law;
    for (std::size_t k = 0; k < engines.size(); ++k) {
      if (engines[k].law == engine.law) of_law.push_back(k);
    }
    if (of_law.size() > 1 && words.laws(words.without(of_law)).size() > 1) found.push_back(of_law);
  }
  return found;
}

bool stands_apart(const Words& words, const Indices& set, bool families) {
  const Indices rest = words.without(set);
  return words.votes(rest, families) >= 2 && words.all_across(set, rest, Word::kDiffers) &&
         words.all_agree(rest) && words.all_agree(set);
}

Indices find_outlier(const Words& words, const std::vector<JudgedEngine>& engines, bool families) {
  if (words.votes(words.without({}), families) < 3) return {};
  for (const Indices& set : candidates(words, engines)) {
    if (stands_apart(words, set, families)) return set;
  }
  return {};
}

bool differs_in(const Verdict& pair, const std::string& key) {
  return std::any_of(pair.statistics.begin(), pair.statistics.end(), [&](const StatisticVerdict& s) {
    return s.statistic.key == key && s.word == Word::kDiffers;
  });
}

// Pairs need not have the same statistics: an outcome is one where it came about.
std::vector<std::string> separating(const Words& words, const Indices& set) {
  std::vector<std::string> names;
  const Indices rest = words.without(set);
  for (const StatisticVerdict& s : words.pair(set.front(), rest.front()).statistics) {
    const bool everywhere = std::all_of(set.begin(), set.end(), [&](std::size_t i) {
      return std::all_of(rest.begin(), rest.end(),
                         [&](std::size_t k) { return differs_in(words.pair(i, k), s.statistic.key); });
    });
    if (everywhere) names.push_back(s.statistic.name);
  }
  return names;
}

std::string no_outlier(const Words& words, const std::vector<Indices>& clusters,
                       const std::vector<Verdict>& pairs) {
  if (clusters.size() == 1) return "all agree";
  std::vector<std::string> open;
  for (const Verdict& pair : pairs) {
    if (pair.word == Word::kUnresolved || pair.word == Word::kStepDependent)
      open.push_back(fmt::format("{} and {} ({})", pair.a, pair.b, name(pair.word)));
  }
  const std::size_t votes = words.votes(words.without({}), true);
  if (votes < 3) {
    return fmt::format(
        "engines of one contact law, and laws of one family that do not differ, are one vote, and there are "
        "{}: of "
        "two nobody can say which is odd",
        votes);
  }
  if (!open.empty()) return fmt::format("not settled: {}", fmt::join(open, ", "));
  std::vector<std::string> sets;
  for (const Indices& cluster : clusters) sets.push_back(fmt::format("{{{}}}", words.names(cluster)));
  return fmt::format("no engine, and no law, stands against others that agree: {}", fmt::join(sets, ", "));
}

}  // namespace

Consensus find_consensus(const std::vector<JudgedEngine>& engines, const std::vector<Verdict>& pairs) {
  const Words words(engines, pairs);
  Consensus consensus;
  consensus.clusters = clusters_of(words);
  consensus.bridges = bridges_of(words, consensus.clusters);
  consensus.outlier = find_outlier(words, engines, true);
  consensus.outlier_by_law = find_outlier(words, engines, false);
  if (consensus.outlier.empty()) {
    consensus.reason = no_outlier(words, consensus.clusters, pairs);
    return consensus;
  }
  const Indices rest = words.without(consensus.outlier);
  consensus.statistics = separating(words, consensus.outlier);
  consensus.reason = fmt::format("differs from each of {}, which agree ({})", words.names(rest),
                                 fmt::join(words.laws(rest), ", "));
  return consensus;
}

Table words_table(const std::string& title, const std::vector<JudgedEngine>& engines,
                  const std::vector<std::string>& words) {
  std::vector<std::string> header{title, "law"};
  for (const JudgedEngine& engine : engines) header.push_back(engine.name);
  Table table(header);
  const std::size_t n = engines.size();
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<std::string> row{engines[i].name, engines[i].law};
    for (std::size_t k = 0; k < n; ++k)
      row.emplace_back(i == k ? "." : words[pair_index(std::min(i, k), std::max(i, k), n)]);
    table.add_row(row);
  }
  return table;
}

}  // namespace crossgait
