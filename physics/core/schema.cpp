#include "physics/core/schema.h"

#include <array>
#include <stdexcept>
#include <string>

namespace crossgait {
namespace {

struct SchemaRow {
  std::string_view name;
  int version;
};

constexpr std::array kSchemas{
    SchemaRow{"bench", 1},    SchemaRow{"compare", 1}, SchemaRow{"conformance", 1},
    SchemaRow{"course", 1},   SchemaRow{"engines", 1}, SchemaRow{"env", 1},
    SchemaRow{"gait", 1},     SchemaRow{"ik", 2},      SchemaRow{"robots", 1},
    SchemaRow{"report", 2},   SchemaRow{"rollout", 1}, SchemaRow{"terrain", 1},
    SchemaRow{"transfer", 1}, SchemaRow{"tune", 1},    SchemaRow{"verdict", 1},
    SchemaRow{"verdicts", 1}, SchemaRow{"walk", 1},    SchemaRow{"workspace", 2},
};

}  // namespace

nlohmann::ordered_json with_schema(std::string_view name, const nlohmann::ordered_json& json) {
  nlohmann::ordered_json result{{"schema", schema(name)}};
  result.update(json);
  return result;
}

nlohmann::ordered_json schema(std::string_view name) {
  for (const SchemaRow& row : kSchemas) {
    if (row.name == name) return {{"name", row.name}, {"version", row.version}};
  }
  throw std::logic_error("no schema " + std::string(name));
}

}  // namespace crossgait
