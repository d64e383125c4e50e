// crossgait: one quadruped gait stack over several physics engines, on the command line.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/child_process.h"
#include "apps/command.h"
#include "apps/interruption.h"
#include "apps/suggestion.h"
#include "physics/core/error.h"
#include "physics/core/progress.h"
#include "study/version.h"

namespace crossgait::apps {
namespace {

constexpr int kFailure = 1;
constexpr int kBadInput = 2;

// Not through fmt: standard error may be closed, and there is nowhere left to say so.
int report_error(const std::string& what, int code) {
  std::fputs(("crossgait: " + what + "\n").c_str(), stderr);
  return code;
}

constexpr const char* kDescription =
    "Runs the same quadruped gait in several physics engines and says how far they agree.\n"
    "Start with:  crossgait compare --terrain rough\n";
constexpr const char* kFooter =
    "\nUnits are SI, angles radians unless a name says otherwise. Exit codes: 0 done, 1 failed, 2 bad "
    "input,\n130 interrupted.\n"
    "`crossgait COMMAND --help` explains each command.";

/// Does what the arguments say. @returns the exit code
int run(std::vector<std::string> arguments, Invocation& invocation) {
  CLI::App program(kDescription, "crossgait");
  program.footer(kFooter);
  program.set_version_flag("--version", std::string(crossgait_version()));
  program.require_subcommand(1);
#define CROSSGAIT_ADD_COMMAND(NAME) add_##NAME##_command(program, invocation);
  CROSSGAIT_COMMANDS(CROSSGAIT_ADD_COMMAND)
#undef CROSSGAIT_ADD_COMMAND
  std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
  try {
    program.parse(std::move(arguments));
  } catch (const CLI::Success& help) {
    return program.exit(help);
  } catch (const CLI::ParseError& error) {
    const std::string hint = suggestion(program), unknown = unknown_command(program);
    if (!unknown.empty())
      return report_error(
          fmt::format("{} {}", unknown, hint.empty() ? "`crossgait --help` lists them." : hint), kBadInput);
    program.exit(error);
    return hint.empty() ? kBadInput : report_error(hint, kBadInput);
  }
  return 0;
}

int main_of(const std::vector<std::string>& arguments) {
  try {
    keep_standard_streams();
    Invocation first;
    int code = run(arguments, first);
    if (!first.next.empty()) {
      Invocation second{{}, std::move(first.recorded)};
      code = run(first.next, second);
    }
    flush_standard_output();
    return code;
  } catch (const ConfigError& error) {
    return report_error(error.what(), kBadInput);
  } catch (const ChildFailed& child) {
    return child.exit_code > 0 ? child.exit_code : kFailure;
  } catch (const EndedEarly& error) {
    return report_error(error.what(), kInterruptedExit);
  } catch (const Interrupted&) {
    return report_error("interrupted: nothing is kept", kInterruptedExit);
  } catch (const std::exception& error) {
    return report_error(error.what(), kFailure);
  }
}

}  // namespace
}  // namespace crossgait::apps

int main(int argc, char** argv) { return crossgait::apps::main_of({argv + 1, argv + argc}); }
