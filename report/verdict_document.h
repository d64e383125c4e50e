// A verdict as a page shows it, from a stored result.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "report/page.h"

namespace crossgait {

/// Holds the verdict of two engines or more, as a page shows it.
struct VerdictDocument {
  std::vector<std::string> sentences;  ///< the summary first
  std::vector<std::string> groups;     ///< a line each; of more than two engines
  std::optional<Table> words;          ///< of all pairs, engine by engine; of more than two engines
  /// Every pair: `behaviour`, `starts`, `confidence`, `variations`, `left_out`, `engines`, `word`, `reason`,
  /// `outcomes`, `statistics`, `models` and `attribution` (null if there is none), checked to be there.
  std::vector<nlohmann::ordered_json> pairs;

  /// Adds the verdict onto the end of what a page has of each.
  void add_to(ReportPage& page) &&;
};

/// Reads what a page needs of a verdict (docs/schemas/verdict.json).
/// @throws ConfigError naming `file` and what is missing or of another kind
VerdictDocument verdict_document(const nlohmann::json& verdict, const std::string& file);

}  // namespace crossgait
