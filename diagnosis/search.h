// Runs an environment with changes of one field, and of two, on several threads.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/candidate_fields.h"
#include "diagnosis/walk_score.h"

#include "physics/core/progress.h"
#include "physics/core/worker_pool.h"

namespace crossgait {

/// Holds changes of the environment, and what came of them.
struct Candidate {
  std::string field, from, to;             ///< of two "a + b"
  std::vector<std::string> fields;         ///< one or two
  bool physics = false;                    ///< any of them is the contact law or the engine
  bool unstated = false, suspect = false;  ///< all of them are (Suspicion)
  FieldChange change;                      ///< the last that was made
  EnvConfig before, config;                ///< without the last, and with all of them
  std::optional<WalkResult> glance;        ///< the walk in which the patient is worst
  std::optional<WalkResult> once;          ///< every command once
  std::optional<WalkResult> whole;         ///< every command from every start
};

/// Says which fields are looked at whatever a first glance says.
struct Suspicion {
  std::vector<std::string> unstated;  ///< names of fields that nobody said
  std::vector<std::string> suspects;  ///< what names begin with that a test without walking points at

  bool is_unstated(const std::string& field) const;
  bool is_suspect(const std::string& field) const;
};

/// Runs the walks of a diagnosis. A patient's environment, with its joints' numbers stated, is their base.
class Search {
 public:
  /// @param policy  outlives this
  /// @param minutes  after which `is_late`; 0: never
  Search(const LoadedEnv& environment, const RelabelledPolicy& policy, const Suspicion& suspicion,
         std::size_t workers, std::uint64_t seed, double minutes = 0);

  const EnvConfig& base() const noexcept { return base_; }
  const WalkTest& whole_test() const noexcept { return whole_; }
  std::size_t configurations() const noexcept { return configurations_; }
  /// Tells whether no more should be begun than what ends it; from then on it was cut short.
  bool is_late() noexcept;
  bool was_cut_short() const noexcept { return cut_short_; }

  /// Walks the patient as it is. From then on a glance is the command that it does worst: of those to
  /// move, unless it does all of these as asked.
  WalkResult examine();
  /// Lists every change that the table has for `before`, a candidate or the base, but of fields that it has
  /// changed.
  std::vector<Candidate> changes(const Candidate* before) const;
  /// Returns `candidate` with another change of its last field.
  static Candidate with_change(const Candidate& candidate, const FieldChange& change);
  /// Returns it with that change in another strength.
  static Candidate in_strength(const Candidate& candidate, double strength);

  /// Runs those candidates that have not been; what no environment can be is dropped.
  /// @throws Interrupted from `progress`
  void glance(std::vector<Candidate>& candidates, const Progress& progress);
  void once(std::vector<Candidate>& candidates, const Progress& progress);
  void whole(std::vector<Candidate>& candidates, const Progress& progress);

 private:
  void run(std::vector<Candidate>& candidates, const WalkTest& test,
           std::optional<WalkResult> Candidate::*result, const Progress& progress);

  LoadedEnv environment_;
  const RelabelledPolicy& policy_;
  Suspicion suspicion_;
  std::uint64_t seed_;
  WorkerPool pool_;
  EnvConfig base_;
  WalkTest whole_, once_, glance_;
  std::size_t configurations_ = 0;
  std::chrono::steady_clock::time_point late_;
  bool cut_short_ = false;
};

/// Returns the best first, at most `each` of a field and `most` in all, by the scores of `result`; and the
/// best of each field that is suspect or unstated.
std::vector<Candidate> best_of_fields(std::vector<Candidate> candidates,
                                      std::optional<WalkResult> Candidate::*result, std::size_t each,
                                      std::size_t most);

/// Puts pairs of which one field cures alone behind the other ones of the first `rivals`, all of which cure:
/// a change that cures alone explains what it does with any second one, too.
/// @returns how many these others are
std::size_t put_needless_pairs_last(std::vector<Candidate>& ranked, std::size_t rivals);

}  // namespace crossgait
