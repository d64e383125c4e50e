#include "diagnosis/import_table.h"

#include <filesystem>

#include <nlohmann/json.hpp>

#include "physics/core/error.h"
#include "physics/core/read_budget.h"
#include "physics/core/text.h"
#include "policy/bundled_policies.h"

namespace crossgait {

std::vector<std::string> unstated_fields(const std::string& policy) {
  const std::filesystem::path file =
      std::filesystem::path(find_policy_file(policy)).parent_path() / "import.json";
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return {};
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
