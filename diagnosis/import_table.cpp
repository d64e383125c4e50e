#include "diagnosis/import_table.h"

#include <filesystem>

#include <nlohmann/json.hpp>

#include "physics/core/error.h"
#include "physics/core/read_budget.h"
#include "physics/core/text.h"
#include "policy/bundled_policies.h"

namespace crossgait {
namespace {

std::filesystem::path table_of(const std::string& policy) {
  return std::filesystem::path(find_policy_file(policy)).parent_path() / "import.json";
}

}  // namespace

bool is_imported(const std::string& policy) {
  std::error_code error;
  return std::filesystem::is_regular_file(table_of(policy), error);
}

std::vector<std::string> unstated_fields(const std::string& policy) {
  if (!is_imported(policy)) return {};
  const std::filesystem::path file = table_of(policy);
  const std::string text = read_text_file(file.string(), kResultBudget);
  check_json_budget(text, kResultBudget, file.string());
  try {
    const nlohmann::json table = nlohmann::json::parse(text);
    return table.at("unstated").get<std::vector<std::string>>();
  } catch (const nlohmann::json::exception&) {
    throw ConfigError(file.string(), "unstated", "names of fields, as `crossgait import` lists them",
                      "something else");
  }
}

}  // namespace crossgait
