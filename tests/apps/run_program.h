// Runs the `crossgait` program as a person would, and keeps what it printed.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace crossgait {

struct ProgramResult {
  int exit_code = -1;
  std::string out, err;
  long peak_kb = 0;  ///< largest resident memory, where `run_watched` ran it
};

/// @param arguments as typed behind `crossgait`, through the shell
/// @param before    what the shell does first, such as "ulimit -f 100; "
ProgramResult run_program(const std::string& arguments, const std::string& before = {});

/// Runs the same, watched: `signal`, if any, is sent `after` seconds of the processor's work behind the
/// moment in which the program begins to listen for it; twenty times that if it does not work.
ProgramResult run_watched(const std::string& arguments, int signal = 0, double after = 0);

/// Returns the contents of a file, "" if there is none.
std::string read_file(const std::string& name);

/// Returns the document of a page that the program wrote, as the page's script finds it.
nlohmann::json document_of(const std::string& page);

/// Returns a result without what differs from run to run: times of the clock.
nlohmann::json without_times(nlohmann::json result);

/// Returns the object that the program prints with `--json -`; expects exit code 0.
nlohmann::json run_json(const std::string& arguments);

/// Writes a file into the scratch folder that tests run in. @returns `name`
std::string write_file(const std::string& name, const std::string& text);

/// Expects exit code 2, nothing on standard output, and an error that contains all of `words`.
void expect_bad_input(const std::string& arguments, const std::vector<std::string>& words);

}  // namespace crossgait
