// What a walk or a comparison comes to, in a sentence to repeat and in groups of engines that did the same.
// The one source of that text for terminal, pages, JSON and Python.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "parity/comparison.h"

namespace crossgait {

/// Writes parts as one enumeration: "a", "a and b", "a, b and c".
std::string listed(const std::vector<std::string>& parts);

/// Names groups as a spreadsheet names its columns: "A", "B", ..., "Z", "AA", ...
std::string group_name(std::size_t index);

/// Holds runs that did the same: as long as one another, and within `DivergenceTolerances::exact()` of each
/// other at every step.
struct RunGroup {
  std::string name;               ///< as `group_name`
  std::vector<std::size_t> runs;  ///< places in Comparison::runs, rising
  double apart_m = 0;             ///< largest distance between the bases of any two of them
  /// Difference between the first run of group A and the first of this one; null for A itself.
  const PairDifference* from_first = nullptr;
};

/// Groups the runs, in the order of their first. Two runs whose pair is not there are not the same.
/// @returns groups that point into `comparison`
std::vector<RunGroup> groups_of(const Comparison& comparison);

/// Says what became of a run, after a subject: "walked 1.02 m", "slid 1.53 m back", "fell at 1.67 s".
std::string outcome_phrase(const MotionSummary& motion);

/// Says in one sentence: "trot on flat walked 1.33 m in mujoco (5 s)."
std::string summary(const WalkRun& run);
/// Says what came out in which engine, and how far those lie apart that came to the same. A second sentence
/// where the law decided and not the code: an engine did the same as another under its laws, and something
/// else under its own.
std::string summary(const Comparison& comparison);

/// Writes a line of every group: "A = mujoco, bullet:matched: walked 1.02 m, the same to 1.3e-10 m".
std::vector<std::string> describe_groups(const Comparison& comparison);
/// Says how parting is measured, and what engines of the same laws must keep; a line each.
std::vector<std::string> describe_parity(const Comparison& comparison);

/// Writes keys as in docs/schemas/compare.json, `groups`.
nlohmann::ordered_json groups_json(const Comparison& comparison);

}  // namespace crossgait
