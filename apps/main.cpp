// crossgait: one quadruped gait stack over several physics engines, on the command line.
#include <algorithm>
#include <csignal>
#include <exception>
#include <new>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/help.h"
#include "apps/interruption.h"
#include "apps/python_module.h"
#include "apps/suggestion.h"
#include "physics/core/consent.h"
#include "physics/core/error.h"
#include "physics/core/progress.h"
#include "physics/core/utf8.h"
#include "study/version.h"

namespace crossgait::apps {
namespace {

constexpr int kFailure = 1;
constexpr int kBadInput = 2;

int report_error(const std::string& what, int code) {
  print_error("crossgait: " + what + "\n");
  return code;
}

// Results name what they were made of, in JSON, which is UTF-8; better said now than when the work is done.
void check_text(const std::vector<std::string>& arguments) {
  for (const std::string& argument : arguments) {
    if (utf8_length(argument) < argument.size())
      throw ConfigError("command line", "arguments", "text and names of files in UTF-8", argument);
  }
}

/// Prints what CLI11 has to say, of an error or as help. @returns its exit code
int tell(const CLI::App& program, const CLI::Error& said) {
  std::ostringstream out, errors;
  const int code = program.exit(said, out, errors);
  print(out.str());
  print_error(errors.str());
  return code;
}

constexpr const char* kDescription =
    "Runs the same quadruped gait in several physics engines and says how far they agree.\n"
    "Start with:  crossgait demo\n";
constexpr const char* kFooter =
    "\nUnits are SI, angles radians unless a name says otherwise.\n"
    "Exit codes: 0 done, 1 failed, 2 bad input, 130 interrupted.\n"
    "`crossgait COMMAND --help` explains each command.";

/// What people type for help and versions, as the program has it: nothing at all, `help COMMAND`, and
/// `COMMAND --version`.
std::vector<std::string> usual_spelling(std::vector<std::string> arguments) {
  if (arguments.empty()) return {"--help"};
  if (arguments.front() == "help") {
    arguments.erase(arguments.begin());
    arguments.emplace_back("--help");
  }
  if (arguments.size() == 2 && (arguments[1] == "--version" || arguments[1] == "-V")) return {"--version"};
  return arguments;
}

/// Does what the arguments say. @returns the exit code
int run(std::vector<std::string> arguments, Invocation& invocation) {
  CLI::App program(kDescription, "crossgait");
  set_help_style(program);
  program.footer(kFooter);
  program.set_version_flag("-V,--version", std::string(crossgait_version()));
  program.require_subcommand(1);
#define CROSSGAIT_ADD_COMMAND(NAME) add_##NAME##_command(program, invocation);
  CROSSGAIT_COMMANDS(CROSSGAIT_ADD_COMMAND)
#undef CROSSGAIT_ADD_COMMAND
  group_help(program);
  std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
  try {
    program.parse(std::move(arguments));
  } catch (const CLI::Success& help) {
    const std::string unknown = unknown_command(program);
    return unknown.empty() ? tell(program, help) : report_error(unknown, kBadInput);
  } catch (const CLI::ParseError& error) {
    const std::string hint = suggestion(program), unknown = unknown_command(program);
    if (!unknown.empty())
      return report_error(
          fmt::format("{} {}", unknown, hint.empty() ? "`crossgait --help` lists them." : hint), kBadInput);
    if (const std::string extra = unexpected(program); !extra.empty())
      return report_error(
          fmt::format("not expected: {}. {}", extra, hint.empty() ? "`--help` lists what is." : hint),
          kBadInput);
    report_error(error.what(), kBadInput);
    return hint.empty() ? kBadInput : report_error(hint, kBadInput);
  }
  return 0;
}

int main_of(const std::vector<std::string>& arguments) {
  try {
    keep_standard_streams();
    set_consent_notice([](const std::string& sentence) { print_notes({sentence}); });
    // Writing beyond a limit (`ulimit -f`) is an error like others, after which what is half written is
    // removed.
    std::signal(SIGXFSZ, SIG_IGN);
    check_text(arguments);
    Invocation first;
    int code = run(usual_spelling(arguments), first);
    for (const NextCommand& next : first.next) {
      if (code != 0) break;
      if (!next.words.empty())
        print(fmt::format("\n{}\n$ crossgait {}\n\n", next.words, fmt::join(next.arguments, " ")));
      flush_standard_output();
      Invocation following{{}, first.recorded};
      code = run(next.arguments, following);
    }
    flush_standard_output();
    return code;
  } catch (const ConfigError& error) {
    return report_error(error.what(), kBadInput);
  } catch (const RequirementMissed& missed) {
    return report_error(missed.what(), missed.exit_code);
  } catch (const nlohmann::json::type_error& error) {
    constexpr int kNoUtf8 = 316;  // of a name that a file holds, which a result would have to say
    if (error.id != kNoUtf8) return report_error(error.what(), kFailure);
    return report_error(
        ConfigError("what was read", "names", "text and names of files in UTF-8", error.what()).what(),
        kBadInput);
  } catch (const ChildFailed& child) {
    return child.exit_code > 0 ? child.exit_code : kFailure;
  } catch (const EndedEarly& error) {
    return report_error(error.what(), kInterruptedExit);
  } catch (const Interrupted&) {
    return report_error("interrupted: nothing is kept", kInterruptedExit);
  } catch (const std::bad_alloc&) {
    return report_error("there is not enough memory", kFailure);
  } catch (const std::system_error& error) {
    const bool is_thread = error.code() == std::errc::resource_unavailable_try_again;
    return report_error((is_thread ? "a thread could not be started: " : "") + std::string(error.what()),
                        kFailure);
  } catch (const std::exception& error) {
    return report_error(error.what(), kFailure);
  }
}

}  // namespace
}  // namespace crossgait::apps

int main(int argc, char** argv) { return crossgait::apps::main_of({argv + 1, argv + argc}); }
