// Results say what they are: every JSON object that a command writes begins with its schema.
#pragma once

#include <string_view>

#include <nlohmann/json.hpp>

namespace crossgait {

/// Returns `json` with {"schema": {"name", "version"}} in front. The schema is docs/schemas/NAME.json; its
/// version is "draft" until the first release, and then a number that grows when a key goes, or changes its
/// meaning, unit or type; a key that is added leaves it as it is.
/// @throws std::logic_error for a name that has no schema
nlohmann::ordered_json with_schema(std::string_view name, const nlohmann::ordered_json& json);
/// Returns {"name", "version"} alone. @throws std::logic_error as above
nlohmann::ordered_json schema(std::string_view name);

}  // namespace crossgait
