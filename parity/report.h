// Runs and comparisons as JSON for programs and as tables for people.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "parity/comparison.h"
#include "physics/core/table.h"

namespace crossgait {

/// Writes keys as in docs/command-line-engines.md; numbers in SI units.
nlohmann::ordered_json to_json(const MotionSummary& motion);
nlohmann::ordered_json to_json(const WalkRun& run);
nlohmann::ordered_json to_json(const Comparison& comparison);

/// Writes every setting by its name.
nlohmann::ordered_json to_json(const ContactSpec& contact);
/// Says "Contact: impratio=100; impratio is not of the law of bullet.", and a line's end; of settings that
/// are not as by default. Empty if all are.
std::string describe_contact(const ContactSpec& contact, const std::vector<EngineInfo>& engines);

/// Says "walked", "fell at 1.23 s".
std::string outcome_in_words(const MotionSummary& motion);
/// Tabulates what the texts below hold: a row per statistic, its label (with the unit) and then a cell per
/// run, which the header names behind `heading`.
Table statistics_table(const std::string& heading, const std::vector<WalkRun>& runs);
/// Describes one run: what it comes to (answer.h), then its statistics.
std::string describe(const WalkRun& run);
/// Describes what a comparison comes to (answer.h), groups of engines that did the same, their statistics
/// side by side, and what engines of the same laws kept.
std::string describe(const Comparison& comparison);
/// Describes a comparison without statistics and parity.
std::string describe_briefly(const Comparison& comparison);

}  // namespace crossgait
