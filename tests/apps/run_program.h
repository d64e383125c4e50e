// Runs the `crossgait` program as a person would, and keeps what it printed.
#pragma once

#include <string>

namespace crossgait {

struct ProgramResult {
  int exit_code = -1;
  std::string out, err;
};

/// @param arguments as typed behind `crossgait`, through the shell
ProgramResult run_program(const std::string& arguments);

}  // namespace crossgait
