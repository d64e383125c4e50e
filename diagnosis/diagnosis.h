// Why a policy does not do here what it was trained for: its contract, the physics, or itself.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/search.h"
#include "diagnosis/standing_tests.h"
#include <nlohmann/json_fwd.hpp>

#include "physics/core/table.h"

namespace crossgait {

/// Says how to look for a cause.
struct DiagnosisOptions {
  std::size_t workers = 1;  ///< threads; results do not depend on them
  std::uint64_t seed = 0;
  std::vector<std::string> unstated =
      {};  ///< fields that nobody said, beside those that the policy's folder lists
  std::optional<std::string> home_engine = {};  ///< in which the policy was trained, where that is known
  bool search = true;                           ///< else it is only seen whether it does what it is asked
  /// After so long no further pairs are begun; what was found until then counts. 0: no limit. Which of the
  /// rare searches that are cut short find something depends on the machine, all others do not.
  double minutes = 3;
};

/// Says what a wrong walk comes from.
enum class CauseKind {
  kContract,  ///< a field of the environment
  kPhysics,   ///< the contact law or the engine
  kPolicy,    ///< nothing around it
};
/// Names a kind of cause: "contract", "physics", "policy".
std::string_view name(CauseKind kind) noexcept;

/// Describes a change of one field or two, and what it does to the score (walk_score, mean over all walks).
struct RankedChange {
  std::string field;     ///< "servos.kp"; of two "history + servos.kp"
  std::string from, to;  ///< in words
  double score = 0;      ///< with it
  double effect = 0, low = 0,
         high = 0;          ///< what it takes away of the score, with its 95 % interval over seeds
  double confidence = 0;    ///< share of resamplings of the walks in which it is the best of this list
  bool physics = false;     ///< of the contact law or the engine
  bool unstated = false;    ///< nobody said the field
  bool cures = false;       ///< with it the policy does what it is asked
  std::string leaves = {};  ///< what is still wrong, in words
  EnvConfig config = {};    ///< with it
};

struct Diagnosis {
  std::string summary;             ///< a sentence
  std::optional<CauseKind> cause;  ///< nothing where it is healthy, or where the diagnosis abstains
  bool healthy = false;            ///< it does what it is asked
  bool abstained = false;
  std::string experiment;  ///< that would decide, where it abstains
  std::string complaint;   ///< what is wrong, in words
  double score = 0;        ///< of the patient
  double spread = 0;       ///< 95 % of the scores of the best change lie so near to their mean, over seeds
  WalkTest test;           ///< what it was asked
  WalkResult as_given;     ///< what came of it
  std::optional<WalkResult> changed;  ///< with the first of the ranking
  std::vector<StandingTest> tests;
  std::vector<RankedChange> ranking;  ///< cures first, then by score; one of every field
  EnvConfig environment;              ///< with the first of the ranking, as it is if there is none
  std::size_t configurations = 0;     ///< that were run
  bool cut_short = false;             ///< by DiagnosisOptions::minutes: some pairs were not tried
};

/// Examines a policy in its environment; where it does not do what it is asked, looks for the change of one
/// field, or of two, with which it does.
/// @param policy  as `load_policy` takes it; what its file states of its layout is a test, no condition
/// @throws ConfigError for an environment that does not command joints, a policy of other sizes, or a home
/// engine that is not there
/// @throws Interrupted from `progress`
Diagnosis diagnose(const LoadedEnv& environment, const std::string& policy, const DiagnosisOptions& options,
                   const Progress& progress = {});

/// Writes keys as in docs/schemas/diagnose.json. @param file  that `environment` was written to; empty: none
nlohmann::ordered_json to_json(const Diagnosis& diagnosis, const std::string& file = {});
/// Says in a sentence what would decide, where the diagnosis abstains; else empty.
std::string deciding_sentence(const Diagnosis& diagnosis);
/// Tabulates what was asked and what came of it, by command: as given, then with the first of the ranking.
Table walks_table(const Diagnosis& diagnosis);
/// Tells which of the rows of `walks_table` are as asked.
std::vector<bool> walks_done(const Diagnosis& diagnosis);
/// Tabulates the changes with their effects. @param longest  values of more characters are cut short
Table ranking_table(const Diagnosis& diagnosis, std::size_t longest = std::string::npos);
/// Says "passed", "failed" or, where it is not judged, "noted".
std::string_view result_of(const StandingTest& test) noexcept;
/// Tabulates the tests without walking. @param explained  also what passing shows, and what it does not
Table tests_table(const Diagnosis& diagnosis, bool explained);
/// Describes the summary, the tests and the ranking, as text.
std::string describe(const Diagnosis& diagnosis);

}  // namespace crossgait
