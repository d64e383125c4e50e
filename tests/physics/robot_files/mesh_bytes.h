// Small mesh files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "physics/core/math.h"

namespace crossgait {

/// @param corners  three per triangle
inline std::string binary_stl(const std::vector<Vector3>& corners) {
  const auto append = [](std::string& bytes, const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  std::string bytes(80, ' ');
  append(bytes, static_cast<std::uint32_t>(corners.size() / 3));
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (i % 3 == 0) bytes.append(12, '\0');  // the normal
    for (const double coordinate : corners[i]) append(bytes, static_cast<float>(coordinate));
    if (i % 3 == 2) bytes.append(2, '\0');
  }
  return bytes;
}

inline std::string text_stl(const std::vector<Vector3>& corners) {
  std::string text = "solid mesh\n";
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector3& v = corners[i];
    if (i % 3 == 0) text += "  facet normal 0 0 1\n    outer loop\n";
    text += "      vertex " + std::to_string(v.x()) + " " + std::to_string(v.y()) + " " +
            std::to_string(v.z()) + "\n";
    if (i % 3 == 2) text += "    endloop\n  endfacet\n";
  }
  return text + "endsolid mesh\n";
}

/// Replaces each line feed.
inline std::string with_line_ends(const std::string& text, const std::string& end) {
  std::string result;
  for (const char c : text) result += c == '\n' ? end : std::string(1, c);
  return result;
}

/// Writes corners of a box of these edges around the origin, as an OBJ.
inline std::string box_obj(const Vector3& edges) {
  std::string text;
  for (int corner = 0; corner < 8; ++corner) {
    text += "v";
    for (int i = 0; i < 3; ++i) text += " " + std::to_string(((corner >> i) % 2 - 0.5) * edges[i]);
    text += "\n";
  }
  return text;
}

}  // namespace crossgait
