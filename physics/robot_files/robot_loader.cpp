// Which files a robot is made of: a robot.yaml and the file that it names, or a file with or without one.
#include <algorithm>
#include <array>
#include <atomic>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/undivided.h"
#include "physics/core/yaml_reader.h"
#include "physics/robot/robot.h"
#include "physics/robot_files/file_extension.h"
#include "physics/robot_files/robot_builder.h"
#include "physics/robot_files/robot_formats.h"
#include "physics/robot_files/robot_report.h"

namespace crossgait {
namespace {

namespace fs = std::filesystem;

/// The value of the one key of a robot.yaml that names the robot's file (RobotFormat::key).
YamlValue named_file(const YamlValue& root) {
  std::optional<YamlValue> named;
  std::string_view first_key;
  for (const RobotFormat& format : robot_formats()) {
    const auto value = root.find(format.key);
    if (!value) continue;
    if (named) value->fail(fmt::format("either `{}` or `{}`", first_key, format.key), "both");
    const std::string text = value->text();
    const RobotFormat* const of_name = robot_format_of(text);
    const bool may_be = of_name == &format || (of_name == nullptr && format.any_name);
    if (!may_be)
      value->fail(fmt::format("a {} file", extensions_in_words(format)), fmt::format("'{}'", text));
    named = value;
    first_key = format.key;
  }
  return named ? *named : root.at(robot_formats().front().key);
}

/// Whether a YAML is an environment's and no robot's: it names no robot's file, and has a key of its own.
bool is_environment(const YamlValue& root) {
  constexpr std::array kKeys{"robot", "action",    "observation", "reward",     "preset",         "engine",
                             "gait",  "policy_dt", "command",     "control_dt", "episode_seconds"};
  const auto has = [&](std::string_view key) { return root.find(key).has_value(); };
  return root.is_mapping() &&
         std::ranges::none_of(robot_formats(), [&](const RobotFormat& format) { return has(format.key); }) &&
         std::ranges::any_of(kKeys, has);
}

LoadedRobot load_yaml(const YamlValue& root, ServoSource servos) {
  if (is_environment(root))
    root.fail(fmt::format("a robot, which names its file by `{}`", robot_formats().front().key),
              "an environment");
  std::vector<std::string_view> keys{"name"};
  for (const RobotFormat& format : robot_formats()) keys.push_back(format.key);
  keys.insert(keys.end(), {"xacro_args", "frame", "locked", "armature", "servo", "drive", "joints", "contact",
                           "loop_softness", "friction_softness", "limit_softness", "legs", "loops",
                           "couplings", "home", "standing_height", "stance_offset"});
  root.allow_keys(keys);
  const fs::path file = fs::path(root.source()).parent_path() / named_file(root).text();
  return RobotBuilder(file.string(), root.source(), root, servos).load();
}

/// Finds the robot.yaml of a robot's file: of the same stem, or `robot.yaml` beside it, which has to name
/// this file. One that names a file of another format says nothing of this one, nor does an environment's.
std::optional<YamlValue> yaml_beside(const std::string& path) {
  fs::path yaml(path);
  yaml.replace_extension(".yaml");
  std::error_code missing;  // of a file that is not there, or that links lead round in a circle to
  if (!fs::exists(yaml, missing) || is_environment(YamlValue::load(yaml.string())))
    yaml.replace_filename("robot.yaml");
  if (!fs::exists(yaml, missing)) return std::nullopt;
  YamlValue root = YamlValue::load(yaml.string());
  if (is_environment(root)) return std::nullopt;
  const YamlValue file = named_file(root);
  if (&robot_format_of_any(file.text()) != &robot_format_of_any(path)) return std::nullopt;
  const fs::path named = yaml.parent_path() / file.text();
  // One that is not there is another one. By name too: what is no regular file is equivalent to nothing, and
  // the reader says so.
  if (named.lexically_normal() != fs::path(path).lexically_normal() &&
      !fs::equivalent(named, path, missing)) {
    file.fail(fmt::format("'{}'", fs::path(path).filename().string()), fmt::format("'{}'", file.text()));
  }
  return root;
}

std::atomic<ServoSource>& source_of_servos() {
  static std::atomic<ServoSource> source = ServoSource::kFile;
  return source;
}

}  // namespace

ServoSource servo_source() noexcept { return source_of_servos(); }
void set_servo_source(ServoSource source) noexcept { source_of_servos() = source; }

LoadedRobot load_robot_with_report(const std::string& path, ServoSource servos) {
  const Undivided alone;  // libraries make tables when they are first asked
  const fs::path file(path);
  const std::string extension = lower_extension(path);
  if (extension == ".yaml" || extension == ".yml") return load_yaml(YamlValue::load(path), servos);
  if (robot_format_of(path) == nullptr) {
    throw ConfigError(path, "file name", fmt::format("a {} file", robot_files_in_words()),
                      fmt::format("'{}'", file.filename().string()));
  }
  std::error_code error;
  if (!fs::exists(path, error))
    throw ConfigError(path, "file", "a readable file", error ? error.message() : "none");
  if (const auto yaml = yaml_beside(path)) return load_yaml(*yaml, servos);
  return RobotBuilder(path, path, std::nullopt, servos).load();
}

RobotDescription load_robot(const std::string& path) { return load_robot_with_report(path).robot; }

}  // namespace crossgait
