// Verdicts and attributions as JSON for programs and as tables for people.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "parity/attribution.h"
#include "parity/model_audit.h"
#include "parity/verdict.h"

namespace crossgait {

nlohmann::ordered_json to_json(const Interval& interval);
/// Returns the label "slip, m"; the name alone where there is no unit.
std::string label(const Statistic& statistic);
/// Returns "-0.113 m": with its sign and unit.
std::string signed_amount(double amount, const Statistic& statistic);

/// Writes an entry of `pairs` in docs/schemas/verdict.json.
nlohmann::ordered_json to_json(const Verdict& verdict);
/// Returns {"walked": 9, "fell": 15}: of those that came about.
nlohmann::ordered_json to_json(const OutcomeCounts& outcomes);
/// Says "walked 9, fell 15".
std::string describe(const OutcomeCounts& outcomes);
/// Describes a verdict by a table with one line per statistic, the reasons of words that are not definite,
/// and what each engine changes by itself where the engines do not agree.
std::string describe(const Verdict& verdict);
/// Says how the words were reached, in a few lines.
std::string describe_rule(const Verdicts& verdicts);

/// Returns a list, empty where the models are the same.
nlohmann::ordered_json to_json(const std::vector<AuditFinding>& findings);

nlohmann::ordered_json to_json(const Attribution& attribution);
/// Says what each factor does to each statistic, the way from one engine to the other, and what to blame.
std::string describe(const Attribution& attribution);

}  // namespace crossgait
