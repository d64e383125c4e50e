// Corners of one mesh file.
#pragma once

#include <string>
#include <string_view>

#include "physics/robot_files/mesh/mesh_vertices.h"

namespace crossgait {

/// Gathers vertices of one file, in its order and within their budget.
class MeshCorners {
 public:
  /// @param path  of the file, for messages
  explicit MeshCorners(const std::string& path) : path_(path) {}

  /// Adds one. @param line  of a text; 0 in others
  void add(const Vector3& vertex, std::size_t line);
  /// Reads three numbers off the text, and adds them.
  void read(std::string_view& text, std::size_t line);
  /// Takes them all; at least one.
  std::vector<Vector3> take();

  /// @throws ConfigError naming the file and the line, if it is not 0
  [[noreturn]] void fail(std::size_t line, std::string_view expected, std::string_view found) const;

 private:
  const std::string& path_;
  std::vector<Vector3> vertices_;
};

/// Remembers which parts a file names, for the message where one is not there.
class MeshPartNames {
 public:
  void add(std::string_view name);
  /// @throws ConfigError naming the file, the part, and those that are there
  [[noreturn]] void fail_without(const std::string& path, const std::string& part) const;

 private:
  std::string text_;
};

}  // namespace crossgait
