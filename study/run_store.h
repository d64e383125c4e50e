// Runs on disk: a line of JSON each, found again by their hash. A verdict that was stopped goes on where it
// was, and one of stored runs alone costs nothing.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "study/run_spec.h"

namespace crossgait {

/// A line of a store, without its end: {"hash", "run", "result": {statistic: value}}.
/// @param run  `to_json(RunSpec)`  @throws ConfigError if names and values differ in number
std::string stored_run(const nlohmann::json& run, const RunResult& result);

/// A file that only grows, a `stored_run` on each line; a last line that was cut off is made again. Runs that
/// a sweep could not make have an "error" for a result, and count as not stored. One process at a time.
class RunStore {
 public:
  /// Reads what is there; a file that is not there is made with the first run.
  /// @throws ConfigError naming file and line for what is no stored run
  explicit RunStore(std::string path);

  std::size_t size() const;
  /// @param run  `to_json(RunSpec)` or `describe_run`
  std::optional<RunResult> find(const nlohmann::json& run) const;
  /// Appends it. May be called from several threads. @throws ConfigError if it cannot be written, and as
  /// `stored_run`
  void add(const nlohmann::json& run, const RunResult& result);

 private:
  std::string path_;
  mutable std::mutex mutex_;
  std::map<std::string, RunResult> runs_;
  std::size_t whole_bytes_ = 0;  ///< up to the end of the last whole line
};

/// `behaviour`, made of `loaded`, that looks a run up before it makes it, and stores what it made.
Behaviour with_store(Behaviour behaviour, const LoadedBehaviour& loaded, std::shared_ptr<RunStore> store);

}  // namespace crossgait
