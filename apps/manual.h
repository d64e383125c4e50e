// The manual: pages in troff's man macros, of the table that help and completions are made of.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace crossgait::apps {

/// Writes the page crossgait(1): what the program is, its commands by group, environment and exit status.
std::string manual_of_program(const CLI::App& program);
/// Writes the page crossgait-COMMAND(1): what it is for, its arguments, its options by group, and examples.
std::string manual_of_command(const CLI::App& command);

/// Names the page of a command, or of the program if that is empty: "crossgait-walk".
std::string manual_name(const std::string& command);

}  // namespace crossgait::apps
