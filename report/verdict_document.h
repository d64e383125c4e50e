// A verdict as a page shows it, from a stored result.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "report/page.h"

namespace crossgait {

/// What a page needs of a verdict (docs/schemas/verdict.json), checked to be there: `behaviour`, `a`, `b`,
/// `word`, `starts`, `limit`, `confidence`, `statistics`, `variations`, `left_out`, `models` and
/// `attribution` (null if there is none).
/// @throws ConfigError naming `file` and what is missing or of another kind
nlohmann::ordered_json verdict_document(const nlohmann::json& verdict, const std::string& file);

/// Holds the verdicts of many engines, as a page shows them.
struct VerdictsDocument {
  Table words;                                   ///< of all pairs, engine by engine
  std::vector<std::string> sentences;            ///< clusters, and the outlier or why none is named
  std::vector<nlohmann::ordered_json> verdicts;  ///< `verdict_document` of every pair

  /// Onto the end of what a page has of each.
  void add_to(ReportPage& page) &&;
};

/// What a page needs of docs/schemas/verdicts.json. @throws ConfigError likewise
VerdictsDocument verdicts_document(const nlohmann::json& verdicts, const std::string& file);

}  // namespace crossgait
