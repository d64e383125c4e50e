// What the commands of `crossgait` share: progress and common options; results.h has where results go.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "apps/results.h"
#include "physics/robot/robot.h"

namespace crossgait::apps {

/// Lists every command, in the order of `crossgait --help`; add_NAME_command is in apps/NAME_command.cpp.
#define CROSSGAIT_COMMANDS(COMMAND) \
  COMMAND(walk)                     \
  COMMAND(compare)                  \
  COMMAND(demo)                     \
  COMMAND(view)                     \
  COMMAND(bench)                    \
  COMMAND(verdict)                  \
  COMMAND(engines)                  \
  COMMAND(conformance)              \
  COMMAND(robots)                   \
  COMMAND(stand)                    \
  COMMAND(terrain)                  \
  COMMAND(ik)                       \
  COMMAND(gait)                     \
  COMMAND(workspace)                \
  COMMAND(report)                   \
  COMMAND(video)                    \
  COMMAND(env)                      \
  COMMAND(rollout)                  \
  COMMAND(transfer)                 \
  COMMAND(import)                   \
  COMMAND(diagnose)                 \
  COMMAND(score)                    \
  COMMAND(matrix)                   \
  COMMAND(course)                   \
  COMMAND(tune)                     \
  COMMAND(rerun)                    \
  COMMAND(completion)

/// Declares what adds a command to the program: its options, its help and what it does.
#define CROSSGAIT_DECLARE_COMMAND(NAME) void add_##NAME##_command(CLI::App& program, Invocation& invocation);
CROSSGAIT_COMMANDS(CROSSGAIT_DECLARE_COMMAND)
#undef CROSSGAIT_DECLARE_COMMAND

/// Ends the program with an exit code of its own, and a line on standard error.
struct RequirementMissed : std::runtime_error {
  RequirementMissed(int code, const std::string& what) : std::runtime_error(what), exit_code(code) {}
  int exit_code;
};

/// Takes numbers above 0. (CLI11's own writes out the largest of its range, in 309 digits.)
CLI::Validator above_zero();

/// Says on standard error what the user may want to know of what was asked for.
void print_notes(const std::vector<std::string>& notes);

/// Returns what `--engines` named, all that are available if it named none.
std::vector<std::string> engines_or_all(const std::vector<std::string>& named);

/// Reads the robot of a name or file, and notes on standard error if its file holds what is doubtful.
/// @throws ConfigError
RobotDescription load_robot_with_warnings(const std::string& robot);

/// Adds `--robot`, a bundled robot's name or a file, and the options below.
void add_robot_option(CLI::App& command, std::string& robot);
/// Adds what is said of robots that are read from then on: `--servos`, where they have their gains from,
/// `--xacro-arg`, what their files are told, and `--trust`. Part of `add_robot_option`.
void add_robot_file_options(CLI::App& command);
/// Adds `--trust`: folders whose files may run code (`require_consent`).
void add_trust_option(CLI::App& command);
/// Says what is wrong with a seed; empty if nothing is.
std::string problem_with_seed(const std::string& text);
/// Adds an option for a whole number from 0 to 2^64 - 1; others are refused, instead of wrapping around.
/// @param seed  of type std::uint64_t, or an optional one
template <typename Seed>
CLI::Option* add_seed_option(CLI::App& command, const std::string& name, Seed& seed,
                             const std::string& help) {
  return command.add_option(name, seed, help)->check(problem_with_seed)->type_name("UINT64");
}

/// Parses `X,Y,Z` as exactly `count` finite numbers. @throws ConfigError naming `option`
std::vector<double> parse_numbers(const std::string& text, std::size_t count, const std::string& option,
                                  const std::string& expected);

/// Takes the line of progress away, if there is one: before anything else is said.
void clear_progress() noexcept;

/// Shows on one line of standard error how far a long job is. Silent unless that is a terminal, and for the
/// first two seconds. From its making on, a signal ends the job: `update` throws Interrupted then.
class ProgressLine {
 public:
  explicit ProgressLine(std::string label);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  void update(double share);

 private:
  std::string label_;
  bool terminal_;
  std::chrono::steady_clock::time_point begin_;
};

/// Shows a ProgressLine per stage of a job that has several.
class Stages {
 public:
  std::function<void(const std::string& stage, double share)> progress();

 private:
  std::string stage_;
  std::unique_ptr<ProgressLine> line_;
};

}  // namespace crossgait::apps
