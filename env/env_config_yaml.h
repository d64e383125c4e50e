// What the readers of an environment's YAML share.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "env/env_config.h"
#include "physics/core/yaml_reader.h"

namespace crossgait::env_yaml {

// Each reads a key into a value, which stays where there is no such key.
inline void read(const YamlValue& root, std::string_view key, double& value) {
  if (const auto found = root.find(key)) value = found->number();
}
inline void read(const YamlValue& root, std::string_view key, bool& value) {
  if (const auto found = root.find(key)) value = found->boolean();
}
inline void read(const YamlValue& root, std::string_view key, std::string& value) {
  if (const auto found = root.find(key)) value = found->text();
}

inline std::vector<std::string> read_names(const YamlValue& list) {
  std::vector<std::string> names;
  for (const YamlValue& item : list.items()) names.push_back(item.text());
  return names;
}

inline std::vector<double> read_numbers(const YamlValue& list) {
  std::vector<double> numbers;
  for (const YamlValue& item : list.items()) numbers.push_back(item.number());
  return numbers;
}

inline void read(const YamlValue& root, std::string_view key, Vector3& value) {
  const auto found = root.find(key);
  if (!found) return;
  const std::vector<double> numbers = read_numbers(*found);
  if (numbers.size() != 3) found->fail("3 numbers", fmt::format("{}", numbers.size()));
  value = {numbers[0], numbers[1], numbers[2]};
}

/// Finds a file from the folder of the file that names it; anything else as it is.
inline std::string resolved(const std::string& text, const std::string& from, bool is_file) {
  const std::filesystem::path path(text);
  if (!is_file || path.is_absolute()) return text;
  return (std::filesystem::path(from).parent_path() / path).lexically_normal().string();
}

/// Reads one of a few values by its name.
template <typename Choice>
void read_choice(const YamlValue& mapping, std::string_view key, Choice& choice,
                 std::initializer_list<Choice> known) {
  const auto found = mapping.find(key);
  if (!found) return;
  std::vector<std::string_view> names;
  for (const Choice one : known) {
    if (found->text() == name(one)) {
      choice = one;
      return;
    }
    names.push_back(name(one));
  }
  found->fail(fmt::format("one of {}", fmt::join(names, ", ")), fmt::format("'{}'", found->text()));
}

/// Reads one number for every servo, or numbers by joint.
void read(const YamlValue& root, std::string_view key, ServoNumbers& numbers);
/// Reads the keys `servos` and `joints`.
void read_servos(const YamlValue& root, EnvConfig& config);
void read_joints(const YamlValue& root, EnvConfig& config);

}  // namespace crossgait::env_yaml
