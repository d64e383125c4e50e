#include "study/run_store.h"

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/hash.h"

namespace crossgait {

std::string stored_run(const nlohmann::json& run, const RunResult& result) {
  const BehaviourRun& came = result.run;
  if (result.keys.size() != came.values.size()) {
    throw ConfigError("run", "result", fmt::format("{} numbers, one per key", result.keys.size()),
                      fmt::format("{}", came.values.size()));
  }
  using nlohmann::ordered_json;  // statistics keep the order in which they are judged
  ordered_json line{{"hash", fnv1a_hex(run.dump())}, {"run", run}};
  line["result"] = {{"outcome", name(came.outcome)}, {"seconds", came.seconds}};
  for (std::size_t i = 0; i < result.keys.size(); ++i)
    line["result"][result.keys[i]] = came.values[i] ? ordered_json(*came.values[i]) : ordered_json(nullptr);
  return line.dump();
}

RunStore::RunStore(std::string path) : file_(std::move(path)), index_(file_.path()) {
  torn_bytes_ = index_.torn_bytes();
  lacks_line_end_ = index_.lacks_line_end();
}

RunStore::~RunStore() { index_.save(); }

std::size_t count_stored_runs(const std::string& path) { return RunIndex(path).size(); }

std::size_t RunStore::size() const {
  const std::scoped_lock lock(mutex_);
  return index_.size();
}

std::optional<RunResult> RunStore::find(const nlohmann::json& run) const {
  const std::uint64_t hash = Fnv1a().add(run.dump()).value();
  const std::scoped_lock lock(mutex_);
  return look_up(hash);
}

std::optional<RunResult> RunStore::look_up(std::uint64_t hash) const {
  try {
    return index_.find(hash);
  } catch (const ConfigError&) {
    // The index is of a store that was changed since, at another place than its end.
    index_ = RunIndex(file_.path(), RunIndex::Begin::kAnew);
    return index_.find(hash);
  }
}

void RunStore::add(const nlohmann::json& run, const RunResult& result) {
  const std::uint64_t hash = Fnv1a().add(run.dump()).value();
  const std::string row = stored_run(run, result);
  const std::scoped_lock lock(mutex_);
  // Several threads may have made it, each because it was not there.
  if (const auto there = look_up(hash); there && there->keys == result.keys) return;
  append(row, hash, false);
}

std::pair<std::uint64_t, bool> RunStore::add_row(std::string_view row) {
  const StoredRow read = read_stored_row(row, "row", 1);
  if (row.find('\n') != std::string_view::npos) throw ConfigError("row", "line 1", "one line", "several");
  const std::scoped_lock lock(mutex_);
  append(row, read.hash, !read.result);
  return {read.hash, !read.result};
}

std::optional<bool> RunStore::has_failed(std::uint64_t hash) const {
  const std::scoped_lock lock(mutex_);
  return index_.has_failed(hash);
}

void RunStore::sync() {
  const std::scoped_lock lock(mutex_);
  file_.sync();
}

void RunStore::append(std::string_view row, std::uint64_t hash, bool failed) {
  if (torn_bytes_ > 0) file_.cut(index_.bytes() - torn_bytes_, index_.bytes());
  torn_bytes_ = 0;
  const std::size_t line_end = lacks_line_end_ ? 1 : 0;
  const std::size_t begin = file_.append(fmt::format("{}{}\n", lacks_line_end_ ? "\n" : "", row)) + line_end;
  lacks_line_end_ = false;
  index_.add(hash, begin, begin + row.size() + 1, failed);
}

Behaviour with_store(Behaviour behaviour, const LoadedBehaviour& loaded, std::shared_ptr<RunStore> store) {
  behaviour.run = [make = std::move(behaviour.run), keys = keys_of(behaviour), described = loaded.described,
                   store = std::move(store)](const Engine& engine, const Variation& variation,
                                             std::size_t start, double horizon) {
    const nlohmann::json run = describe_run(described, engine.info, variation, start, horizon);
    if (const auto stored = store->find(run); stored && stored->keys == keys) return stored->run;
    BehaviourRun made = make(engine, variation, start, horizon);
    store->add(run, {keys, made});
    return made;
  };
  return behaviour;
}

}  // namespace crossgait
