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

/// Every command adds itself to the program: its options, its help and what it does.
void add_walk_command(CLI::App& program);
void add_view_command(CLI::App& program);
void add_compare_command(CLI::App& program);
void add_bench_command(CLI::App& program);
void add_verdict_command(CLI::App& program);
void add_engines_command(CLI::App& program);
void add_conformance_command(CLI::App& program);
void add_robots_command(CLI::App& program);
void add_terrain_command(CLI::App& program);
void add_ik_command(CLI::App& program);
void add_gait_command(CLI::App& program);
void add_workspace_command(CLI::App& program);
/// @param again  set to the command line that is to be run next, by a callback
void add_report_command(CLI::App& program, std::vector<std::string>& again);
void add_video_command(CLI::App& program);
void add_env_command(CLI::App& program);
void add_rollout_command(CLI::App& program);
void add_transfer_command(CLI::App& program);
void add_course_command(CLI::App& program);
void add_tune_command(CLI::App& program);
/// @param again  set to the command line that is to be run next, by a callback
void add_rerun_command(CLI::App& program, std::vector<std::string>& again);

/// Ends the program with an exit code of its own, and a line on standard error.
struct RequirementMissed : std::runtime_error {
  RequirementMissed(int code, const std::string& what) : std::runtime_error(what), exit_code(code) {}
  int exit_code;
};

/// Says on standard error what the user may want to know of what was asked for.
void print_notes(const std::vector<std::string>& notes);

/// The robot of a name or file, and a note on standard error if its file holds what is doubtful.
/// @throws ConfigError
RobotDescription load_robot_with_warnings(const std::string& robot);

/// A name with `--robot`'s meaning: a bundled robot's name or a file. Adds the option alone.
void add_robot_option(CLI::App& command, std::string& robot);
/// What is wrong with a seed, empty if nothing is.
std::string problem_with_seed(const std::string& text);
/// A whole number from 0 to 2^64 - 1; anything else is refused, instead of wrapping around.
/// @param seed  of type std::uint64_t, or an optional one
template <typename Seed>
CLI::Option* add_seed_option(CLI::App& command, const std::string& name, Seed& seed,
                             const std::string& help) {
  return command.add_option(name, seed, help)->check(problem_with_seed)->type_name("UINT64");
}

/// `X,Y,Z` as exactly `count` finite numbers. @throws ConfigError naming `option`
std::vector<double> parse_numbers(const std::string& text, std::size_t count, const std::string& option,
                                  const std::string& expected);

/// One line on standard error that says how far a long job is. Silent unless that is a terminal, and for the
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
  bool shown_ = false;
  std::chrono::steady_clock::time_point begin_;
};

/// A ProgressLine per stage of a job that has several.
class Stages {
 public:
  std::function<void(const std::string& stage, double share)> progress();

 private:
  std::string stage_;
  std::unique_ptr<ProgressLine> line_;
};

}  // namespace crossgait::apps
