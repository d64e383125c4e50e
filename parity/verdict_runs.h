// From runs to the rows of numbers that a verdict judges.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "parity/campaign.h"
#include "parity/judge.h"

namespace crossgait {

/// Names two engines by their places.
struct EnginePair {
  std::size_t a = 0, b = 0;
  bool operator<(const EnginePair& other) const { return std::tie(a, b) < std::tie(other.a, other.b); }
};

/// Keeps what is needed of some engines' runs. All is incomplete until the campaign is (Campaign).
class VerdictRuns {
 public:
  VerdictRuns(const Behaviour& behaviour, std::span<const Engine> engines, const VerdictOptions& options)
      : behaviour_(behaviour),
        engines_(engines),
        options_(options),
        campaign_(behaviour, engines, options.workers) {}

  Campaign& campaign() { return campaign_; }

  /// Returns the rows of a pair from its first starts: the behaviour's statistics, then outcomes.
  /// @param quarter  with a quarter of the time step, too
  std::vector<StatisticRuns> rows(const EnginePair& pair, std::size_t starts, bool quarter);
  OutcomeCounts outcomes(std::size_t engine, std::size_t starts);
  /// Returns where the pair is cut; empty where nothing was.
  std::optional<PairCut> cut(const EnginePair& pair, std::size_t starts);

 private:
  using Places = std::vector<std::size_t>;

  // What both engines did from a start under a variation, cut where the first of them ended under any of the
  // variations `together`.
  struct Both {
    const BehaviourRun *a = nullptr, *b = nullptr;
    explicit operator bool() const { return a != nullptr && b != nullptr; }
  };
  Both both(const EnginePair& pair, std::size_t variation, const Places& together, std::size_t start);

  template <typename NumberOf>
  void add(const EnginePair& pair, std::size_t starts, bool quarter, bool is_cut, const NumberOf& number_of,
           StatisticRuns& row);
  template <typename NumberOf>
  std::vector<OwnChange> own_changes(const EnginePair& pair, std::size_t starts, bool is_share,
                                     const NumberOf& number_of);
  std::vector<StatisticRuns> outcome_rows(const EnginePair& pair, std::size_t starts, bool quarter);

  const Behaviour& behaviour_;
  std::span<const Engine> engines_;
  const VerdictOptions& options_;
  Campaign campaign_;
};

}  // namespace crossgait
