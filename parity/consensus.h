// Where many engines stand to one another: which agree, and whether one stands apart.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "parity/verdict.h"
#include "physics/core/table.h"

namespace crossgait {

/// Describes one engine of those that were judged.
struct JudgedEngine {
  std::string name, law, family;  ///< Laws::contact_law, Laws::contact_family
};

/// Sums up the verdicts of all pairs. `pairs` below stand as `reach_verdicts` has them.
///
/// **Clusters.** Two engines may be in one cluster only if they agree, and so may all others of it (complete
/// linkage): clusters are joined, the two nearest first, as long as every pair across them agrees. How near
/// two engines are is the largest end of any statistic's interval, in margins. "Agrees" is not transitive (a
/// with b and b with c, but not a with c): b then is in the nearer cluster, and `bridges` names the pairs
/// that agree across clusters.
///
/// **The outlier.** A set of engines stands apart if each of it differs from each of the others, while the
/// others agree among each other, and so does the set. The set is one engine, or all engines of one contact
/// law; the others have to be two votes or more, and all together three or more, or nobody could say which of
/// two is odd. Engines of one law are one vote, since they agree by construction; so are laws of one family
/// (Laws::contact_family), unless engines of them are judged to differ.
/// Where any of these pairs is unresolved no outlier is named.
struct Consensus {
  std::vector<std::vector<std::size_t>> clusters;  ///< engines, rising; the largest cluster first
  std::vector<std::size_t> bridges;                ///< pairs that agree across clusters
  std::vector<std::size_t> outlier;                ///< engines that stand apart; empty if none is named
  /// The same if every law had a vote, whatever its family.
  std::vector<std::size_t> outlier_by_law;
  std::vector<std::string> statistics;  ///< in which the outlier differs from all others
  std::string reason;                   ///< why an outlier is named, or none
};

/// Tabulates what is said of every pair, engine by engine.
/// @param title  of the table
/// @param words  of all pairs, as `reach_verdicts` has them
Table words_table(const std::string& title, const std::vector<JudgedEngine>& engines,
                  const std::vector<std::string>& words);

/// @param engines  two or more
/// @param pairs    `reach_verdicts` of them
Consensus find_consensus(const std::vector<JudgedEngine>& engines, const std::vector<Verdict>& pairs);

/// Returns where the pair of engines i < k of n stands.
constexpr std::size_t pair_index(std::size_t i, std::size_t k, std::size_t n) noexcept {
  return i * (2 * n - i - 1) / 2 + k - i - 1;
}

}  // namespace crossgait
