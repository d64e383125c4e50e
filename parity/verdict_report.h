// Verdicts and attributions as JSON for programs and as tables for people.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "crossgait/parity/verdict.h"

namespace crossgait {

/// Keys as documented in docs/command-line.md.
nlohmann::ordered_json to_json(const Verdict& verdict);
/// A table with one line per statistic, and the rule in words.
std::string describe(const Verdict& verdict);

}  // namespace crossgait
