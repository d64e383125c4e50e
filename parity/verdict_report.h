// Verdicts and attributions as JSON for programs and as tables for people.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "parity/attribution.h"
#include "parity/model_audit.h"
#include "parity/verdict.h"

namespace crossgait {

nlohmann::ordered_json to_json(const Interval& interval);
/// "slip, m"; the name alone where there is no unit.
std::string label(const Statistic& statistic);

/// Keys as documented in docs/command-line.md.
nlohmann::ordered_json to_json(const Verdict& verdict);
/// A table with one line per statistic, and the rule in words.
std::string describe(const Verdict& verdict);

/// A list, empty where the models are the same.
nlohmann::ordered_json to_json(const std::vector<AuditFinding>& findings);

nlohmann::ordered_json to_json(const Attribution& attribution);
/// What each factor does to each statistic, the way from one engine to the other, and what to blame.
std::string describe(const Attribution& attribution);

}  // namespace crossgait
