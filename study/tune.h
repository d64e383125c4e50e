// Gait parameters for speed, for cost of transport, or for the score on a course, by the cross-entropy method
// (Rubinstein, 1999): draw parameter sets from a normal distribution, keep the best quarter, fit the
// distribution to them, repeat. No gradients, no network: it shows that the environment can be learned, and
// what its parameters alone are worth.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "study/course.h"
#include "study/rollout.h"

namespace crossgait {

/// Says what sets of parameters are chosen by, where there is no course.
enum class TuneFor {
  kSpeed,
  kCost,  ///< the least cost of transport at 95 % or more of the speed that the command asks for
};

struct TuneOptions {
  std::size_t iterations = 10;  ///< generations
  std::size_t population = 16;  ///< parameter sets per generation, at least 4
  std::size_t terrains = 2;     ///< terrain seeds that every set walks on; of a course, runs of each section
  std::size_t unseen = 3;       ///< other terrain seeds, or runs, for the checks
  std::size_t workers = EpisodeOptions::default_workers();
  std::uint64_t seed = 0;  ///< of the search, and the first terrain seed
  /// Course by whose score sets are chosen, the lowest of all engines (study/course.h); by speed if none.
  std::optional<Course> course = {};
  TuneFor aim = TuneFor::kSpeed;
};

/// Checks the same parameters in every engine on one set of terrain seeds.
struct TuneCheck {
  std::string ground, parameters;         ///< "seeds tuned on" or "unseen seeds"; "default" or "tuned"
  std::vector<Evaluation> per_engine;     ///< as Tuning::engines; empty on a course
  std::vector<CourseResult> course = {};  ///< likewise; empty without one
};

struct Tuning {
  EnvConfig start, tuned;
  std::string course;  ///< its name; empty without one
  TuneFor aim = TuneFor::kSpeed;
  double score = 0;             ///< of the best: m/s, minus the cost of transport, or on the course
  std::vector<double> history;  ///< best score so far, per generation
  std::vector<std::string> engines;
  std::vector<TuneCheck> checks;  ///< default and tuned in turns
  bool interrupted = false;       ///< before its end, by a Progress that threw Interrupted
};

/// Tunes the parameters that `adapt` of `method` names in the engine that it names (on a course: in all of
/// `engines`), and checks the result in all of `engines`. An interruption leaves the best so far, and the
/// checks that are finished. @throws ConfigError
Tuning tune_gait(const LoadedEnv& method, const std::vector<std::string>& engines, const TuneOptions& options,
                 const Progress& progress = {});

/// Writes keys as in docs/schemas/tune.json.
nlohmann::ordered_json to_json(const Tuning& tuning);
std::string describe(const Tuning& tuning);
/// Tabulates what a tuning says: parameters before and after, and their speeds in every engine.
std::array<Table, 2> tables(const Tuning& tuning);

}  // namespace crossgait
