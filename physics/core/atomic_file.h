// Files that appear whole or not at all.
#pragma once

#include <string>
#include <string_view>

namespace crossgait {

/// Follows a symbolic link, and the links that it leads to, to the place where a file written to `path` is
/// put; `path` itself if it is none. @throws ConfigError if they lead round in a circle
std::string place_of_output(const std::string& path);

/// Removes temporaries from a folder, of AtomicFile and of the Python package, whose writers are gone: those
/// hold the lock as long as they live. Where a file system has no locks, nothing is removed.
void remove_left_over(const std::string& folder);

/// Writes a file piece by piece into a temporary in the same folder, renamed to `path` when it is whole:
/// readers, and a program killed half-way, see the old file or the new one. A symbolic link stays; what it
/// leads to is replaced. Where `path` exists and is no regular file (a pipe, /dev/null), it is written to
/// directly; a pipe that nobody reads is waited for, as shells do, until a signal ends that
/// (`interruption_is_asked`): then it throws Interrupted.
///
/// Never replaced are a file whose lock somebody holds (`LockedFile`: a store that is being written), and one
/// that the command has read (`InputGuard`): both are looked for here, and again when the file is put in its
/// place.
///
/// A program that was killed leaves its temporary, NAME.crossgait-PID-NUMBER.tmp. The next that is made in
/// the folder removes those whose lock (`flock`) nobody holds, and those of the Python package likewise.
class AtomicFile {
 public:
  /// @throws ConfigError if the path is empty, the folder does not exist or is not writable, or the file may
  /// not be replaced
  explicit AtomicFile(std::string path);
  /// Removes what was not committed.
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// @throws ConfigError if the device is full, Interrupted of a pipe that takes nothing
  void write(std::string_view bytes);
  /// Puts the whole file in its place. @throws ConfigError if it cannot; nothing is left then
  void commit();

 private:
  void open_special();
  void open_temporary();
  void check_replaced() const;
  void flush();
  [[noreturn]] void fail(int code);

  std::string path_, place_, target_, buffer_;  // as asked for, behind links, what is open, not yet written
  int file_ = -1;
  bool special_ = false;
};

/// Writes the whole file at once. @throws ConfigError as AtomicFile does
void write_file_atomically(const std::string& path, std::string_view bytes);

/// Checks that a file could be written there, before the work that it is for. Leaves nothing behind.
/// @throws ConfigError if it could not
void check_writable(const std::string& path);

}  // namespace crossgait
