#include "policy/bundled_policies.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/yaml_reader.h"
#include "physics/robot_files/data_path.h"

namespace crossgait {
namespace fs = std::filesystem;
namespace {

fs::path policies_folder() { return fs::path(models_dir()) / "policies"; }

constexpr const char* kBest = "best.safetensors";  // in the folder of a training

// The file of a policy's folder; empty if there is none.
fs::path file_in(const fs::path& folder) {
  const fs::path name = folder.filename();
  std::error_code error;
  for (const fs::path& file :
       {fs::path(name).concat(".safetensors"), fs::path(name).concat(".yaml"), fs::path(kBest)}) {
    if (fs::is_regular_file(folder / file, error)) return folder / file;
  }
  return {};
}

bool is_name(const std::string& text) {
  if (fs::path(text).has_extension()) return false;  // a path, wherever models are
  const std::vector<std::string> names = policy_names();
  return std::find(names.begin(), names.end(), text) != names.end();
}

// The folder of a policy: one that is there, or that of a policy that comes with Crossgait; empty for other
// texts.
fs::path folder_of(const std::string& text) {
  std::error_code error;
  if (fs::is_directory(text, error)) {
    // Named as it is called, also where it is given as "." or with a slash at its end.
    const fs::path folder = fs::absolute(text, error).lexically_normal();
    return folder.has_filename() ? folder : folder.parent_path();
  }
  return is_name(text) ? policies_folder() / text : fs::path();
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
  const fs::path folder = folder_of(text);
  if (folder.empty()) return text;
  fs::path file = file_in(folder);
  if (file.empty())
    throw ConfigError("policy", text,
                      fmt::format("a folder with {0}.safetensors or {0}.yaml, or of a training, with {1}",
                                  folder.filename().string(), kBest),
                      "one without");
  return file.string();
}

std::optional<std::string> environment_of_policy(const std::string& text) {
  const fs::path folder = folder_of(text);
  if (folder.empty() || file_in(folder).empty()) return std::nullopt;  // any other folder of that name
  return (folder / "environment.yaml").string();
}

std::vector<std::string> engines_of_training(const std::string& text) {
  std::vector<std::string> engines;
  const fs::path folder = folder_of(text), plan = folder / "config.yaml";
  if (folder.empty()) return engines;
  std::error_code error;
  // Any other folder may have a config.yaml of its own.
  if (!fs::is_regular_file(folder / kBest, error) || !fs::is_regular_file(plan, error)) return engines;
  for (const auto& [engine, share] : YamlValue::load(plan.string()).at("engines").entries()) {
    if (share.number() > 0) engines.push_back(engine);
  }
  return engines;
}

std::string environment_file(const std::string& given, const std::string& policy) {
  return given.empty() ? environment_of_policy(policy).value_or("")
                       : environment_of_policy(given).value_or(given);
}

}  // namespace crossgait
