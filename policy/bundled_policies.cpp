#include "policy/bundled_policies.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>

#include "physics/robot_files/data_path.h"

namespace crossgait {
namespace fs = std::filesystem;
namespace {

fs::path policies_folder() { return fs::path(models_dir()) / "policies"; }

// The file of a policy's folder; empty if there is none.
fs::path file_in(const fs::path& folder) {
  std::error_code error;
  for (const char* extension : {".safetensors", ".yaml"}) {
    fs::path file = folder / folder.filename().concat(extension);
    if (fs::is_regular_file(file, error)) return file;
  }
  return {};
}

bool is_name(const std::string& text) {
  if (fs::path(text).has_extension()) return false;  // a path, wherever models are
  const std::vector<std::string> names = policy_names();
  return std::find(names.begin(), names.end(), text) != names.end();
}

}  // namespace

std::vector<std::string> policy_names() {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(policies_folder(), error))
    if (!file_in(entry.path()).empty()) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string find_policy_file(const std::string& text) {
  return is_name(text) ? file_in(policies_folder() / text).string() : text;
}

std::optional<std::string> environment_of_policy(const std::string& text) {
  if (!is_name(text)) return std::nullopt;
  return (policies_folder() / text / "environment.yaml").string();
}

std::string environment_file(const std::string& given, const std::string& policy) {
  return given.empty() ? environment_of_policy(policy).value_or("") : given;
}

}  // namespace crossgait
