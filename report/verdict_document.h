// A verdict as a page shows it, from a stored result.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace crossgait {

/// What a page needs of a verdict (docs/schemas/verdict.json), checked to be there: `behaviour`, `a`, `b`,
/// `word`, `starts`, `limit`, `confidence`, `statistics`, `variations`, `left_out`, `models` and
/// `attribution` (null if there is none).
/// @throws ConfigError naming `file` and what is missing or of another kind
nlohmann::ordered_json verdict_document(const nlohmann::json& verdict, const std::string& file);

}  // namespace crossgait
