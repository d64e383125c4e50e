// Runs gnuplot (Debian package gnuplot-nox), which draws the pictures.
#pragma once

#include <string>
#include <string_view>

namespace crossgait::apps {

/// `text` as a string of a gnuplot script. Nothing in it is special there; control characters become spaces.
std::string gnuplot_quoted(std::string_view text);

/// Runs `script`, without the user's gnuplot settings, and returns what its terminal writes to standard
/// output.
/// @throws ConfigError if there is no gnuplot
/// @throws std::runtime_error with gnuplot's own words if it fails
std::string run_gnuplot(const std::string& script);

}  // namespace crossgait::apps
