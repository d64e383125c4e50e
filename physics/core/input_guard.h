// No file that a command has read is written by it, by whatever name and in whatever order.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <sys/types.h>

namespace crossgait {

/// Refuses, while it lives, to have a file written (`AtomicFile`) that any thread of this process has read
/// (`read_text_file`) since, or one read that is an output. A command makes one before it reads anything;
/// where there is none, as in a program that reads a file, changes it and writes it again, nothing is
/// refused. Of several, the first counts.
class InputGuard {
 public:
  /// Names a file that is going to be written, and what asked for it: an option.
  struct Output {
    std::string option, path;
  };

  /// @param outputs  files that are going to be written: one of them is refused when it is read, before the
  /// work, and not only when it is written
  explicit InputGuard(const std::vector<Output>& outputs = {});
  ~InputGuard();
  InputGuard(const InputGuard&) = delete;
  InputGuard& operator=(const InputGuard&) = delete;
  InputGuard(InputGuard&&) = delete;
  InputGuard& operator=(InputGuard&&) = delete;

  /// Remembers a file that is read. @throws ConfigError naming the option whose output it is
  static void note_read(const std::string& path);
  /// @throws ConfigError naming `output` if it is a file that was read
  static void check_output(const std::string& output);

 private:
  using Identity = std::pair<dev_t, ino_t>;

  std::mutex mutex_;
  std::map<Identity, Output> outputs_;
  std::map<Identity, std::string> files_;      ///< their paths as they were opened
  std::map<std::string, std::string> places_;  ///< of files, without links
};

}  // namespace crossgait
