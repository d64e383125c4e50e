// What somebody who mistyped a word may have meant.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace crossgait::apps {

/// Asks "Did you mean walk?" for a command line that was refused; empty if nothing comes near.
std::string suggestion(const CLI::App& program);

/// Lists arguments that the command does not take, in their order; empty if there is none.
std::string unexpected(const CLI::App& program);

/// Says `There is no command "wlak".` if that is what was refused; otherwise empty.
std::string unknown_command(const CLI::App& program);

}  // namespace crossgait::apps
