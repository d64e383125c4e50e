// What urdfdom lets pass: it ignores misspelt elements, takes the last of two parents, and names no line.
#pragma once

#include <string>

namespace crossgait {

/// Checks that `text` is well-formed XML holding a URDF whose links and joints have only known elements and
/// attributes, finite numbers, supported joint types and shapes, unique names, and form one tree. Elements of
/// <robot> other than <link> and <joint> are other programs' business and are skipped, as are visuals.
/// @throws ConfigError naming `source`, the line and the link or joint
void check_urdf(const std::string& text, const std::string& source);

}  // namespace crossgait
