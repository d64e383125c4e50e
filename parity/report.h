// Runs and comparisons as JSON for programs and as tables for people.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "crossgait/parity/comparison.h"

namespace crossgait {

/// Keys as documented in docs/command-line.md; numbers in SI units.
nlohmann::ordered_json to_json(const MotionSummary& motion);
nlohmann::ordered_json to_json(const WalkRun& run);
nlohmann::ordered_json to_json(const Comparison& comparison);

/// "walked", "fell at 1.23 s".
std::string outcome_in_words(const MotionSummary& motion);
/// A table of one run's statistics.
std::string describe(const WalkRun& run);
/// Statistics of all runs side by side, then how far each pair lies apart, in words.
std::string describe(const Comparison& comparison);

}  // namespace crossgait
