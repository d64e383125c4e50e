// Where results go: whether they can, what is written there, and what a terminal is shown of it.
#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "apps/command.h"
#include "apps/results.h"
#include "apps/terminal.h"
#include "physics/core/atomic_file.h"
#include "physics/core/error.h"
#include "physics/core/files_read.h"
#include "physics/core/fit_text.h"
#include "physics/core/folder.h"
#include "physics/core/locked_file.h"

namespace crossgait::apps {
namespace {

namespace fs = std::filesystem;

/// A file that an option names, and which file that is.
struct NamedFile {
  std::string option, path;
  fs::path place;  ///< whole, without links
};

// Type names of outputs that are files; others are folders or say how they are written.
bool names_file(const CLI::Option& option) { return option.get_type_name().starts_with("FILE"); }

NamedFile named_file(const std::string& option, const std::string& path) {
  std::error_code error;
  const fs::path place = fs::weakly_canonical(absolute_path(place_of_output(path)), error);
  return {option, path, error ? fs::path(path) : place};
}

bool is_same(const NamedFile& a, const NamedFile& b) {
  std::error_code error;
  return a.place == b.place || fs::equivalent(a.place, b.place, error);
}

// Devices and pipes take what several write.
bool is_replaced(const std::string& path) {
  std::error_code error;
  return !fs::exists(path, error) || fs::is_regular_file(path, error);
}

/// Tells whether a file is what standard output leads to, by whatever name: /dev/stdout, or where a shell has
/// it go. Of devices only a terminal: everybody may write to /dev/null.
bool is_standard_output(const std::string& path) {
  struct stat file {};
  struct stat out {};
  if (::stat(path.c_str(), &file) != 0 || ::fstat(STDOUT_FILENO, &out) != 0) return false;
  if (file.st_dev != out.st_dev || file.st_ino != out.st_ino) return false;
  return !S_ISCHR(out.st_mode) || ::isatty(STDOUT_FILENO) == 1;
}

// Of options whose type says so, "-" is standard output.
bool takes_standard_output(const CLI::Option& option) { return option.get_type_name().ends_with("|-"); }

std::vector<NamedFile> outputs_of(const CLI::App& command) {
  std::vector<NamedFile> outputs;
  bool to_standard_output = false;
  const auto take_standard_output = [&to_standard_output](const CLI::Option& option) {
    if (std::exchange(to_standard_output, true))
      throw ConfigError("command line", option.get_name(), "one output on standard output", "a second");
  };
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_group() != kOutputs || !names_file(*option)) continue;
    for (const std::string& path : option->results()) {
      if (path == "-" && takes_standard_output(*option)) {
        take_standard_output(*option);
        continue;
      }
      if (path == "-")
        throw ConfigError("command line", option->get_name(), "the name of a file (./- is one)", "\"-\"");
      if (path.empty()) throw ConfigError("command line", option->get_name(), "the name of a file", "\"\"");
      if (is_standard_output(path)) {
        if (is_replaced(path))  // what is printed would go into a file that has no name any more
          throw ConfigError("command line", option->get_name(), "a file of its own",
                            fmt::format("\"{}\", where standard output goes", path));
        take_standard_output(*option);
      }
      if (is_replaced(path)) outputs.push_back(named_file(option->get_name(), path));
    }
  }
  return outputs;
}

// Every value that is the name of a file, whatever its option means; settings may stand behind a colon.
std::vector<NamedFile> inputs_of(const CLI::App& command) {
  std::vector<NamedFile> inputs;
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_group() == kOutputs) continue;
    for (const std::string& value : option->results()) {
      for (const std::string& path : {value, value.substr(0, value.find(':'))}) {
        std::error_code error;
        if (fs::is_regular_file(path, error)) inputs.push_back(named_file(option->get_name(), path));
      }
    }
  }
  return inputs;
}

void check_each_its_own(const std::vector<NamedFile>& outputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (!is_same(outputs[i], outputs[k])) continue;
      throw ConfigError("command line", outputs[i].option, "a file of its own",
                        fmt::format("\"{}\" again, of {}", outputs[i].path, outputs[k].option));
    }
  }
}

void check_apart(const std::vector<NamedFile>& outputs, const NamedFile& input) {
  for (const NamedFile& output : outputs) {
    if (!is_same(output, input)) continue;
    throw ConfigError("command line", output.option, "a file that is not read",
                      fmt::format("\"{}\", which is {} of {}", output.path, input.path, input.option));
  }
}

[[noreturn]] void fail_on_standard_output(int code) {
  throw std::runtime_error(fmt::format("standard output: {}; the result is not complete there",
                                       std::generic_category().message(code)));
}

void write_to_standard_output(const std::string& bytes) {
  clear_progress();
  if (std::fwrite(bytes.data(), 1, bytes.size(), stdout) != bytes.size()) fail_on_standard_output(errno);
}

}  // namespace

CLI::Option* add_output_option(CLI::App& command, const std::string& name, std::string& value,
                               const std::string& help) {
  return command.add_option(name, value, help)->type_name("FILE")->group(kOutputs);
}

std::vector<InputGuard::Output> files_written(const CLI::App& command) {
  std::vector<InputGuard::Output> files;
  for (const NamedFile& output : outputs_of(command)) files.push_back({output.option, output.path});
  return files;
}

void check_values(const CLI::App& command) {
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& value : option->results()) {
      std::string word = value.substr(value.starts_with('-') || value.starts_with('+') ? 1 : 0);
      std::ranges::transform(word, word.begin(), [](unsigned char c) { return std::tolower(c); });
      if (value.empty() || word == "nan" || word.starts_with("nan("))
        throw ConfigError("command line", option->get_name(), "a value", value.empty() ? "\"\"" : value);
    }
  }
}

void check_outputs(const CLI::App& command) {
  const std::vector<NamedFile> outputs = outputs_of(command);
  check_each_its_own(outputs);
  for (const NamedFile& input : inputs_of(command)) check_apart(outputs, input);
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_group() != kOutputs || !names_file(*option)) continue;
    for (const std::string& path : option->results()) {
      if (path == "-") continue;
      // What a store holds stays; its writer is another, with words of its own.
      option->get_type_name() == kStoreType ? check_appendable(path) : check_writable(path);
    }
  }
}

void check_outputs_apart(const CLI::App& command, const std::vector<DerivedOutput>& derived) {
  std::vector<NamedFile> outputs = outputs_of(command);
  for (const auto& [option, path] : derived) {
    if (is_replaced(path)) outputs.push_back(named_file(option, path));
  }
  if (outputs.empty()) return;
  check_each_its_own(outputs);
  for (const NamedFile& input : inputs_of(command)) check_apart(outputs, input);
  if (const FilesRead* const read = FilesRead::current(); read != nullptr) {
    for (const FileRead& file : read->list()) check_apart(outputs, named_file("what is read", file.path));
  }
}

void print(const std::string& text) {
  std::string shown = printable_text(text, std::string::npos);
  if (const std::optional<std::size_t> width = terminal_width()) shown = fit_text(shown, *width);
  write_to_standard_output(takes_colours(STDOUT_FILENO) ? with_colours(shown) : shown);
}

void print_data(const std::string& bytes) {
  ::isatty(STDOUT_FILENO) == 1 ? write_to_standard_output(printable_text(bytes, std::string::npos))
                               : write_to_standard_output(bytes);
}

void print_written(const std::string& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return;
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) return;
  const auto bytes = static_cast<double>(size);
  const std::string text = bytes < 1e3   ? fmt::format("{} bytes", size)
                           : bytes < 1e6 ? fmt::format("{:.1f} kB", bytes / 1e3)
                                         : fmt::format("{:.1f} MB", bytes / 1e6);
  print_error(fmt::format("wrote {} ({})\n", path, text));
}

void print_error(const std::string& text) {
  clear_progress();
  // Standard error may be closed, and there is nowhere left to say so.
  const std::string shown = printable_text(text, std::string::npos);
  std::fputs((takes_colours(STDERR_FILENO) ? message_with_colours(shown) : shown).c_str(), stderr);
}

void flush_standard_output() {
  if (std::fflush(stdout) != 0) fail_on_standard_output(errno);
  if (std::ferror(stdout) != 0) fail_on_standard_output(EIO);
}

}  // namespace crossgait::apps
