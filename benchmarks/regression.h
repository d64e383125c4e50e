// Two results of the benchmark side by side: what got worse.
//
// Times are compared as ratios to the first engine of the same run, so that a faster machine or a busy one
// cancels; errors as they are, because they do not depend on the machine.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace crossgait::benchmarks {

/// Holds one figure of a result. The smaller, the better.
struct Figure {
  std::string name;  ///< with all settings that it depends on, e.g. "speed, trot_flat: bullet over mujoco"
  double value = 0;  ///< infinite where the engine did not get through
  double floor = 0;  ///< smaller values count as this: rounding errors are neither better nor worse
};

/// Lists all figures that can be compared. @throws nlohmann::json::exception for one that lacks a key
std::vector<Figure> comparable_figures(const nlohmann::ordered_json& result);

/// Holds one figure in both results.
struct Change {
  std::string name;
  double before = 0, after = 0;
  double factor = 1;  ///< after over before, beyond the floor
};

struct Regression {
  double worse_than = 1;
  int compared = 0;
  std::vector<Change> worse, better;  ///< by more than `worse_than` either way, the largest first
  std::vector<std::string> missing;   ///< in the stored result and in none of this run, of sections in both
};

/// @throws ConfigError unless it is a number above 1
void check_worse_than(double factor);

/// @param worse_than  factor above which a figure counts as worse
/// @throws ConfigError as check_worse_than, or if the two results have no figure in common
Regression compare_results(const nlohmann::ordered_json& before, const nlohmann::ordered_json& after,
                           double worse_than);

std::string describe(const Regression& regression);
nlohmann::ordered_json to_json(const Regression& regression);

}  // namespace crossgait::benchmarks
