// What somebody who mistyped a word may have meant.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace crossgait {

/// Counts the insertions, deletions, replacements and swaps of neighbours that make one word of the other
/// (optimal string alignment).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// Finds the nearest of `known`, if it is near: at most a third of the letters differ; or else the only one
/// that begins with `word`, of three letters or more. Empty otherwise.
std::string nearest(std::string_view word, const std::vector<std::string>& known);

}  // namespace crossgait
