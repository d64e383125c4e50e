// What somebody who mistyped a word may have meant.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

namespace crossgait::apps {

/// Insertions, deletions, replacements and swaps of neighbours that make one word of the other (optimal
/// string alignment).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The nearest of `known`, if it is near: at most a third of the letters differ. Empty otherwise.
std::string nearest(const std::string& word, const std::vector<std::string>& known);

/// "Did you mean walk?" for a command line that was refused; empty if nothing comes near.
std::string suggestion(const CLI::App& program);

/// `There is no command "wlak".` if that is what was refused; otherwise empty.
std::string unknown_command(const CLI::App& program);

}  // namespace crossgait::apps
