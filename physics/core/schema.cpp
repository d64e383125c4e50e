#include "physics/core/schema.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

namespace crossgait {
namespace {

// All are drafts until the first release freezes them: a reader refuses any other version.
constexpr std::string_view kVersion = "draft";

constexpr auto kSchemas = std::to_array<std::string_view>({
    "bench",   "compare",  "conformance", "course",  "diagnose", "engines",   "env",   "gait",
    "ik",      "import",   "matrix",      "robots",  "report",   "rollout",   "score", "stand",
    "terrain", "transfer", "tune",        "verdict", "walk",     "workspace",
});

}  // namespace

nlohmann::ordered_json with_schema(std::string_view name, const nlohmann::ordered_json& json) {
  nlohmann::ordered_json result{{"schema", schema(name)}};
  result.update(json);
  return result;
}

nlohmann::ordered_json schema(std::string_view name) {
  if (std::find(kSchemas.begin(), kSchemas.end(), name) != kSchemas.end())
    return {{"name", name}, {"version", kVersion}};
  throw std::logic_error("no schema " + std::string(name));
}

}  // namespace crossgait
