// How the program explains itself: one table of what belongs together, for help, completions and the manual.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace crossgait::apps {

/// Sets how options are written in help; call it before commands are added.
void set_help_style(CLI::App& program);
/// Puts commands and options into groups; call it once all commands are added.
void group_help(CLI::App& program);

/// Returns what stands for an option's value: "N", "X", "NAME=VALUE"; empty for a flag.
std::string metavar(const CLI::Option& option);
/// Explains what an option is for, with the range of its value and its default.
std::string explanation(const CLI::Option& option);

/// Lists commands in the order of help, and the options of one that may be typed.
std::vector<const CLI::App*> commands_of(const CLI::App& program);
std::vector<const CLI::Option*> options_of(const CLI::App& command);
/// Lists values that an option takes, where they come from a list; empty for others.
std::vector<std::string> values_of(const CLI::Option& option);

}  // namespace crossgait::apps
