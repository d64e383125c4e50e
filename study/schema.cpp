#include "crossgait/study/schema.h"

#include <array>
#include <stdexcept>
#include <string>

namespace crossgait {
namespace {

struct Row {
  std::string_view name;
  int version;
};

constexpr std::array kSchemas{
    Row{"bench", 1},    Row{"compare", 1}, Row{"engines", 1}, Row{"env", 1},     Row{"gait", 1},
    Row{"ik", 1},       Row{"plot", 1},    Row{"robots", 1},  Row{"rollout", 1}, Row{"terrain", 1},
    Row{"transfer", 1}, Row{"tune", 1},    Row{"verdict", 1}, Row{"walk", 1},    Row{"workspace", 1},
};

}  // namespace

nlohmann::ordered_json with_schema(std::string_view name, const nlohmann::ordered_json& json) {
  for (const Row& row : kSchemas) {
    if (row.name != name) continue;
    nlohmann::ordered_json result{{"schema", {{"name", row.name}, {"version", row.version}}}};
    result.update(json);
    return result;
  }
  throw std::logic_error("no schema " + std::string(name));
}

}  // namespace crossgait
