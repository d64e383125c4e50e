// Where the results of a command go, what they are made of, and that none is lost in silence.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "motion/gait_source.h"
#include "physics/core/files_read.h"
#include "physics/core/input_guard.h"
#include "physics/robot/robot.h"
#include "study/provenance.h"

namespace crossgait::apps {

/// Adds an option that names a file to write, or "-" for standard output; no part of how a result is made.
/// @param value  of type std::string
CLI::Option* add_output_option(CLI::App& command, const std::string& name, std::string& value,
                               const std::string& help);

/// Whatever an option changes about how a command runs, but not about its result.
inline constexpr const char* kOutputs = "Outputs";
/// Type name of outputs that are added to, and not replaced.
inline constexpr const char* kStoreType = "FILE.jsonl";
inline constexpr const char* kExecution = "Execution";

/// Checks, before a command does anything, that every file that it is to write can be written, is another
/// than each further one by whatever name, and is none that an option names to be read. @throws ConfigError
/// naming the option
void check_outputs(const CLI::App& command);

/// Refuses values that are no numbers ("nan", which is in every range) and empty ones, which a variable of a
/// shell that is not set leaves. @throws ConfigError naming the option
void check_values(const CLI::App& command);
/// Lists the files that options name to be written.
std::vector<InputGuard::Output> files_written(const CLI::App& command);
/// Describes a file whose name a command makes of an option's value, one for each engine for example.
struct DerivedOutput {
  std::string option, path;
};
/// Checks derived outputs once inputs are read: of files that are derived, and of what was read, which files
/// that were named may have named themselves. @throws ConfigError naming the option
void check_outputs_apart(const CLI::App& command, const std::vector<DerivedOutput>& derived);

/// Sets what a command is to do, once its options are read and its outputs are known to be writable.
template <typename Run>
void on_run(CLI::App& command, Run run) {
  command.callback([&command, run] {
    check_outputs(command);
    check_values(command);
    const InputGuard guard(files_written(command));
    const FilesRead files;  // which `with_files_read` asks for
    run();
  });
}

/// Holds what a command knows of its result beside what its options say.
struct ResultInputs {
  nlohmann::json subject;            ///< Provenance::subject
  std::vector<std::string> engines;  ///< by name
  /// Values that the command chose for options that were not given.
  std::map<std::string, std::vector<std::string>> chosen;
  std::vector<DerivedOutput> derived_outputs = {};  ///< files that it writes beside those that options name
};

/// Returns the inputs of a result that is of a robot alone.
ResultInputs of_robot(const RobotDescription& robot);

/// Returns the inputs of a result of a robot and a gait with all its parameters. @throws ConfigError
ResultInputs of_gait(std::shared_ptr<const RobotDescription> robot, const GaitChoice& gait);

/// Holds a result that a command wrote.
struct Recorded {
  std::string file;
  nlohmann::json result;
};
/// @throws ConfigError as `read_result` does
Recorded read_recorded(const std::string& file);

/// Describes a command line that the program runs after another.
struct NextCommand {
  std::string words;  ///< what it is for; printed before it, with the command line. Empty: nothing is printed
  std::vector<std::string> arguments;
};

/// Describes one command line that the program runs, and what becomes of it.
struct Invocation {
  /// Command lines to be run after this one, by a callback; up to the first that does not end with 0.
  std::vector<NextCommand> next = {};
  std::optional<Recorded> recorded = {};  ///< the result that this one makes again, or those of `next` are to
};

/// Writes `--json FILE|-`. With "-" the JSON is all that is written to standard output.
struct JsonOption {
  std::string path;

  /// @param invocation  that the command is a part of; stays the caller's
  void add_to(CLI::App& command, const Invocation& invocation);
  bool to_stdout() const { return path == "-"; }
  /// Returns the provenance; call it before anything long, and before files change. @throws ConfigError if
  /// the result to be made again (`crossgait rerun`) was made of something else, or an engine is not there
  Provenance provenance(const ResultInputs& inputs = {}) const;
  /// Writes `json` with its provenance where it was asked for, then prints `text` unless JSON goes to
  /// standard output.
  /// @throws ConfigError if the file cannot be written
  void emit(const std::string& text, nlohmann::ordered_json json, const Provenance& provenance) const;
  void emit(const std::string& text, nlohmann::ordered_json json) const;

 private:
  const CLI::App* command_ = nullptr;
  const Invocation* invocation_ = nullptr;
};

/// Prints `text` for people: names come from files, so control characters stand as `\xNN`.
/// @throws std::runtime_error if standard output does not take it
void print(const std::string& text);
/// Prints for programs (JSON, CSV, YAML): bytes as they are, but on a terminal as `print`. @throws as `print`
void print_data(const std::string& bytes);
/// Says on standard error which file was written, and how large it is. Nothing of what is no regular file.
void print_written(const std::string& path);
/// Prints `text` on standard error, as `print`; says nothing if that is closed.
void print_error(const std::string& text);

/// Opens standard streams that are closed such that using them fails, so that no other file takes their
/// place; call it at the very beginning.
void keep_standard_streams();
/// Flushes standard output at the end. @throws std::runtime_error if it did not take all that was printed
void flush_standard_output();

}  // namespace crossgait::apps
