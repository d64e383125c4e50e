// What the commands of `crossgait` share: where results go, progress, common options.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json_fwd.hpp>

namespace crossgait::apps {

/// Every command adds itself to the program: its options, its help and what it does.
void add_walk_command(CLI::App& program);
void add_compare_command(CLI::App& program);
void add_bench_command(CLI::App& program);
void add_verdict_command(CLI::App& program);
void add_backends_command(CLI::App& program);
void add_robots_command(CLI::App& program);
void add_terrain_command(CLI::App& program);
void add_ik_command(CLI::App& program);
void add_gait_command(CLI::App& program);
void add_workspace_command(CLI::App& program);
void add_plot_command(CLI::App& program);
void add_env_command(CLI::App& program);
void add_rollout_command(CLI::App& program);
void add_transfer_command(CLI::App& program);
void add_tune_command(CLI::App& program);

/// `--json FILE|-`. With "-" the JSON is all that is written to standard output.
struct JsonOption {
  std::string path;

  void add_to(CLI::App& command);
  bool to_stdout() const { return path == "-"; }
  /// Prints `text` unless JSON goes to standard output, and writes `json` where it was asked for.
  /// @throws ConfigError if the file cannot be written
  void emit(const std::string& text, const nlohmann::ordered_json& json) const;
};

/// Says on standard error what the user may want to know of what was asked for.
void print_notes(const std::vector<std::string>& notes);

/// A name with `--robot`'s meaning: a bundled robot's name or a file. Adds the option alone.
void add_robot_option(CLI::App& command, std::string& robot);

/// `X,Y,Z` as exactly `count` finite numbers. @throws ConfigError naming `option`
std::vector<double> parse_numbers(const std::string& text, std::size_t count, const std::string& option,
                                  const std::string& expected);

/// One line on standard error that says how far a long job is. Silent unless that is a terminal, and for the
/// first two seconds.
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
