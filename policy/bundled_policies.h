// Policies that come with Crossgait: folders of `models_dir()`/policies (models/policies/README.md).
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace crossgait {

/// Their names, sorted: of folders NAME that hold NAME.safetensors or NAME.yaml.
std::vector<std::string> policy_names();

/// The file of the policy of that name; `text` itself if there is none, as it may be a path.
std::string find_policy_file(const std::string& text);

/// The environment.yaml that the policy of that name was made for; nothing for any other text.
std::optional<std::string> environment_of_policy(const std::string& text);
/// `given` if it names a file, else that environment; empty if there is neither.
std::string environment_file(const std::string& given, const std::string& policy);

}  // namespace crossgait
