// Runs on disk: a line of JSON each, found again by their hash. A verdict that was stopped goes on where it
// was, and one of stored runs alone costs nothing.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "physics/core/locked_file.h"
#include "study/run_index.h"
#include "study/run_spec.h"

namespace crossgait {

/// Writes a line but its end: {"hash", "run", "result": {"outcome", "seconds", KEY: value or null}}.
/// @param run  `to_json(RunSpec)`  @throws ConfigError if keys and values differ in number
std::string stored_run(const nlohmann::json& run, const RunResult& result);

/// Keeps runs in a file that only grows, a `stored_run` on each line. Runs that a sweep could not make have
/// an "error" for a result, and count as not stored. It is one process's at a time, by the lock that sweeps
/// take (`LockedFile`): others are refused.
///
/// Opening it changes nothing in it. With the first run that is added, a last line that is the beginning of a
/// stored run and no more (its writer was killed, or lost power) is cut off, to be made again; a last line
/// that is whole and lacks only its end is ended. Anything else that is no stored run is an error, and stays.
class RunStore {
 public:
  /// Reads what is there; a file that is not there is made.
  /// @throws ConfigError naming file and line for what is no stored run, and as LockedFile
  explicit RunStore(std::string path);

  ~RunStore();
  RunStore(const RunStore&) = delete;
  RunStore& operator=(const RunStore&) = delete;
  RunStore(RunStore&&) = delete;
  RunStore& operator=(RunStore&&) = delete;

  std::size_t size() const;
  /// @param run  `to_json(RunSpec)` or `describe_run`
  std::optional<RunResult> find(const nlohmann::json& run) const;
  /// Appends it, unless it is there. May be called from several threads. Once it returns, the run is stored,
  /// whatever becomes of this process. @throws ConfigError if it cannot be written, and as `stored_run`
  void add(const nlohmann::json& run, const RunResult& result);
  /// Checks that what was added is at its path, as nobody does who only destroys it. @throws ConfigError if
  /// the file was removed or replaced
  void check_place() const { file_.check_place(); }
  /// Appends a row as it is, whatever is there: one that a sweep made, or of a run that failed.
  /// @returns its hash, and whether the run failed  @throws ConfigError as `read_stored_row`, or if it cannot
  /// be written
  std::pair<std::uint64_t, bool> add_row(std::string_view row);
  /// Tells whether the run of a row failed; none where no row is of it.
  std::optional<bool> has_failed(std::uint64_t hash) const;
  /// Sees that the rows outlive a power cut. @throws ConfigError if they cannot be written
  void sync();

 private:
  void append(std::string_view row, std::uint64_t hash, bool failed);
  std::optional<RunResult> look_up(std::uint64_t hash) const;

  LockedFile file_;
  mutable std::mutex mutex_;
  mutable RunIndex index_;       ///< made anew where it turns out to be of another file
  std::size_t torn_bytes_ = 0;   ///< of the file as it was read, a last line that was cut off
  bool lacks_line_end_ = false;  ///< of a last line that is whole
};

/// Counts the runs that a store holds, whoever writes it. @throws ConfigError as RunStore, but for its lock
std::size_t count_stored_runs(const std::string& path);

/// Returns `behaviour`, made of `loaded`, that looks a run up before it makes it, and stores what it made.
Behaviour with_store(Behaviour behaviour, const LoadedBehaviour& loaded, std::shared_ptr<RunStore> store);

}  // namespace crossgait
