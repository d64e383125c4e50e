// The runs that a verdict rests on: asked for one by one, made together, each once.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <span>
#include <tuple>
#include <vector>

#include "parity/behaviour.h"
#include "physics/core/progress.h"

namespace crossgait {

/// Keeps runs. Whoever needs one asks for it; those that are not there are made, in parallel, by
/// `make_missing`, and then whoever needs them asks again.
class Campaign {
 public:
  /// @param engines  stay the caller's, as does the behaviour
  Campaign(const Behaviour& behaviour, std::span<const Engine> engines, std::size_t workers)
      : behaviour_(behaviour), engines_(engines), workers_(workers) {}

  /// Names one run: engine and variation by their places, start, and after how many cuts of the behaviour it
  /// is cut (0: it goes to its end).
  struct Key {
    std::size_t engine = 0, variation = 0, start = 0, cuts = 0;
    bool operator<(const Key& other) const {
      return std::tie(engine, variation, start, cuts) <
             std::tie(other.engine, other.variation, other.start, other.cuts);
    }
  };

  /// Finds a run; one that ends before it would be cut is the run to its end. Null if it is not made yet.
  const BehaviourRun* find(const Key& key);
  bool is_complete() const { return missing_.empty(); }
  /// Makes all runs that were not found. @throws ConfigError, Interrupted
  void make_missing(const Progress& progress);

  /// Returns after how many whole cuts the run is over that ended first; 0 if each went on to the end.
  std::size_t first_end(std::span<const BehaviourRun* const> runs) const;
  bool ended_early(const BehaviourRun& run) const;

 private:
  double seconds(std::size_t cuts) const;

  const Behaviour& behaviour_;
  std::span<const Engine> engines_;
  std::size_t workers_;
  std::map<Key, BehaviourRun> runs_;
  std::set<Key> missing_;
};

}  // namespace crossgait
