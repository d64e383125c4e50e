// A file that grows by whole pieces, and that one process at a time may write.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace crossgait {

/// Holds a regular file open for appending, under a lock (`flock`) that ends with this object, or with its
/// process, however that ends. Whoever comes meanwhile is refused, not kept waiting: other objects of this
/// process too. `python -m crossgait.sweep` takes the same lock.
class LockedFile {
 public:
  /// Opens and locks it; makes it if it is not there.
  /// @throws ConfigError if it cannot be written or is no regular file, if another holds its lock (naming the
  /// process, if this one may know it), or if its file system has no locks
  explicit LockedFile(std::string path);
  /// Sees that what was appended outlives a power cut, and lets go of the lock.
  ~LockedFile();
  LockedFile(const LockedFile&) = delete;
  LockedFile& operator=(const LockedFile&) = delete;
  LockedFile(LockedFile&&) = delete;
  LockedFile& operator=(LockedFile&&) = delete;

  const std::string& path() const noexcept { return path_; }

  /// Appends all of `bytes` or nothing. Once it returns, the bytes outlive this process; within two seconds
  /// of further pieces, a power cut. @returns where they begin, bytes from the file's beginning
  /// @throws ConfigError if there is no room, the file cannot be written, or as `check_place`
  std::size_t append(std::string_view bytes);

  /// Checks that the file is at its path still: programs that ask for no lock remove or replace it, and what
  /// is appended then is nowhere. @throws ConfigError if it is not
  void check_place() const;

  /// Cuts off what stands behind the first `size` bytes, of `expected`.
  /// @throws ConfigError if the file has another size than `expected`: then somebody writes it without asking
  void cut(std::size_t size, std::size_t expected);
  /// Sees that what was appended outlives a power cut. @throws ConfigError if it cannot be written
  void sync();

 private:
  std::size_t size() const;
  [[noreturn]] void fail(int code) const;

  std::string path_;
  int file_ = -1;
  bool dirty_ = false;
  std::chrono::steady_clock::time_point synced_ = std::chrono::steady_clock::now();
};

/// Checks, before the work, that a LockedFile could be opened there. Leaves nothing behind, and a file as it
/// is.
/// @throws ConfigError as it does
void check_appendable(const std::string& path);

/// Says in words who holds the lock of a regular file (`LockedFile`); nothing if nobody does, there is none,
/// or it cannot be told.
std::optional<std::string> writer_of(const std::string& path);

}  // namespace crossgait
