// Files that appear whole or not at all.
#pragma once

#include <string>
#include <string_view>

namespace crossgait {

/// A file that is written piece by piece into a temporary in the same folder, and renamed to `path` when it
/// is whole: readers, and a program killed half-way, see the old file or the new one. Where `path` exists and
/// is no regular file (a pipe, /dev/null), it is written to directly.
class AtomicFile {
 public:
  /// @throws ConfigError if the folder does not exist or is not writable
  explicit AtomicFile(std::string path);
  /// Removes what was not committed.
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// @throws ConfigError if the device is full
  void write(std::string_view bytes);
  /// The file is whole: it takes its place. @throws ConfigError if it cannot; nothing is left then
  void commit();

 private:
  void flush();
  [[noreturn]] void fail(int code);

  std::string path_, target_, buffer_;
  int file_ = -1;
  bool special_ = false;
};

/// The whole file at once. @throws ConfigError as AtomicFile does
void write_file_atomically(const std::string& path, std::string_view bytes);

/// Whether a file could be written there, before the work that it is for. Leaves nothing behind.
/// @throws ConfigError if it could not
void check_writable(const std::string& path);

}  // namespace crossgait
