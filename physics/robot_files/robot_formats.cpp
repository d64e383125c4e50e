#include "physics/robot_files/robot_formats.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "physics/robot_files/mjcf/mjcf_reader.h"
#include "physics/robot_files/sdf/sdf_reader.h"
#include "physics/robot_files/urdf/urdf_reader.h"

namespace crossgait {
namespace {

constexpr std::array kRobotFormats{
    RobotFormat{"URDF", "urdf", {".urdf"}, true, read_urdf},
    RobotFormat{"MJCF", "mjcf", {".xml", ".mjcf"}, false, read_mjcf},
    RobotFormat{"SDF", "sdf", {".sdf", ".world"}, false, read_sdf},
};

}  // namespace

std::span<const RobotFormat> robot_formats() { return kRobotFormats; }

const RobotFormat* robot_format_of(std::string_view path) {
  const std::string extension = std::filesystem::path(path).extension();
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

ParsedRobot read_robot_file(const std::string& path) { return robot_format_of_any(path).read(path); }

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
