// The table of formats that robots' files may have.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>

#include "physics/robot_files/file_arguments.h"
#include "physics/robot_files/parsed_robot.h"

namespace crossgait {

/// A row says how a file of the format is known, and who reads it.
struct RobotFormat {
  std::string_view name;  ///< for people
  std::string_view key;   ///< of a robot.yaml that names such a file
  std::array<std::string_view, 2>
      extensions;      ///< of its files, the usual one first; empty: there is no other
  bool any_name;       ///< that key may also name a file with an extension of no format
  bool has_arguments;  ///< what it says depends on FileArguments
  /// Whether a file is a robot's, by its first kBeginning bytes: neither a part of one nor a scene around it.
  bool (*is_robot)(std::string_view beginning);
  ParsedRobot (*read)(const std::string& path, const FileArguments& arguments);
};

inline constexpr std::size_t kBeginning = 4096;

/// Returns the table. A robot.yaml without any of the keys is asked for the first.
std::span<const RobotFormat> robot_formats();

/// Finds the format of a file by its extension; null if it has none of theirs.
const RobotFormat* robot_format_of(std::string_view path);

/// Finds a format; with an extension of none, the one that takes any name.
const RobotFormat& robot_format_of_any(std::string_view path);

/// Reads a robot's file by the reader of its format. @throws ConfigError naming file and element; for
/// arguments of a format that takes none, too
ParsedRobot read_robot_file(const std::string& path, const FileArguments& arguments);

/// Returns a file's name without the extensions of formats, at most two: "go2.urdf.xacro" is go2.
std::string name_of_robot_file(std::string_view path);

/// Says ".xml or .mjcf".
std::string extensions_in_words(const RobotFormat& format);
/// Says ".yaml, .urdf or .xml (MJCF)": the files that a robot is loaded from.
std::string robot_files_in_words();

}  // namespace crossgait
