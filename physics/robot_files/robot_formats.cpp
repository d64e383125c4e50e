#include "physics/robot_files/robot_formats.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/robot_files/file_extension.h"
#include "physics/robot_files/mjcf/mjcf_reader.h"
#include "physics/robot_files/sdf/sdf_reader.h"
#include "physics/robot_files/urdf/urdf_reader.h"
#include "physics/robot_files/xacro/xacro_reader.h"

namespace crossgait {
namespace {

/// A reader of files that are told nothing.
template <ParsedRobot (*read)(const std::string&)>
ParsedRobot told_nothing(const std::string& path, const FileArguments& /*none*/) {
  return read(path);
}

bool has(std::string_view beginning, std::string_view word) {
  return beginning.find(word) != std::string_view::npos;
}

bool is_any(std::string_view /*beginning*/) { return true; }
/// A MuJoCo model with bodies of its own, and no scene, which includes another.
bool is_mjcf(std::string_view beginning) {
  return has(beginning, "<mujoco") && !has(beginning, "<include") && has(beginning, "body");
}
bool is_sdf(std::string_view beginning) { return has(beginning, "<sdf") && has(beginning, "<model"); }
/// What has a name is expanded by itself; files of macros alone, which others include, have none.
bool is_xacro(std::string_view beginning) {
  const std::size_t root = beginning.find("<robot");
  return root != std::string_view::npos &&
         has(beginning.substr(root, beginning.find('>', root) - root), " name=");
}

constexpr std::array kRobotFormats{
    RobotFormat{"URDF", "urdf", {".urdf"}, true, false, is_any, told_nothing<read_urdf>},
    RobotFormat{"MJCF", "mjcf", {".xml", ".mjcf"}, false, false, is_mjcf, told_nothing<read_mjcf>},
    RobotFormat{"SDF", "sdf", {".sdf", ".world"}, false, false, is_sdf, told_nothing<read_sdf>},
    RobotFormat{"xacro", "xacro", {".xacro"}, false, true, is_xacro, read_xacro},
};

FileArguments& given() noexcept {
  static FileArguments arguments;
  return arguments;
}

}  // namespace

std::span<const RobotFormat> robot_formats() { return kRobotFormats; }

const RobotFormat* robot_format_of(std::string_view path) {
  const std::string extension = lower_extension(path);
  if (extension.empty()) return nullptr;
  for (const RobotFormat& format : kRobotFormats) {
    if (std::find(format.extensions.begin(), format.extensions.end(), extension) != format.extensions.end())
      return &format;
  }
  return nullptr;
}

const RobotFormat& robot_format_of_any(std::string_view path) {
  const RobotFormat* const format = robot_format_of(path);
  return format != nullptr ? *format : *std::ranges::find_if(kRobotFormats, &RobotFormat::any_name);
}

ParsedRobot read_robot_file(const std::string& path, const FileArguments& arguments) {
  const RobotFormat& format = robot_format_of_any(path);
  if (!format.has_arguments && !arguments.empty())
    throw ConfigError(path, "arguments", "a file that takes them, a xacro",
                      fmt::format("{} with '{}'", format.name, arguments.begin()->first));
  return format.read(path, arguments);
}

const FileArguments& given_file_arguments() noexcept { return given(); }
void set_given_file_arguments(FileArguments arguments) { given() = std::move(arguments); }

std::string name_of_robot_file(std::string_view path) {
  std::filesystem::path name = std::filesystem::path(path).filename();
  for (int i = 0; i < 2 && robot_format_of(name.string()) != nullptr; ++i) name = name.stem();
  return name.string();
}

std::string extensions_in_words(const RobotFormat& format) {
  const auto& [usual, other] = format.extensions;
  return other.empty() ? std::string(usual) : fmt::format("{} or {}", usual, other);
}

std::string robot_files_in_words() {
  std::string words = ".yaml";
  for (const RobotFormat& format : kRobotFormats) {
    words += &format == &kRobotFormats.back() ? " or " : ", ";
    words += format.extensions.front();
    // Of an extension that is not its key people are told the format's name.
    if (format.extensions.front().substr(1) != format.key) words += fmt::format(" ({})", format.name);
  }
  return words;
}

}  // namespace crossgait
