// Policies in folders of their own, with the environment that they were made for: those that come with
// Crossgait, in `models_dir()`/policies (models/policies/README.md), and those that `crossgait import` and
// trainings write.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace crossgait {

/// Lists the policies' names, sorted: of folders NAME that hold NAME.safetensors or NAME.yaml.
std::vector<std::string> policy_names();

/// Finds the file of a folder NAME, by its path or as the name of a policy that comes with Crossgait:
/// NAME.safetensors or NAME.yaml, or what a training left as best.safetensors. Any other text itself, as it
/// may be a file's path.
/// @throws ConfigError for a folder without such a file
std::string find_policy_file(const std::string& text);

/// Returns the environment.yaml of that folder; nothing for any other text.
std::optional<std::string> environment_of_policy(const std::string& text);
/// Lists the engines of the training that wrote that folder, of its config.yaml; none of any other text.
/// @throws ConfigError for a file that no training wrote
std::vector<std::string> engines_of_training(const std::string& text);
/// Returns `given`, which is a file or a policy whose environment is meant; without one that of `policy`,
/// empty if it has none.
std::string environment_file(const std::string& given, const std::string& policy);

}  // namespace crossgait
