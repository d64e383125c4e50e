#include "study/run_store.h"

#include <sstream>
#include <string_view>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/files_read.h"
#include "physics/core/find_row.h"
#include "physics/core/hash.h"
#include "physics/core/text.h"

namespace crossgait {
namespace {

using nlohmann::ordered_json;  // statistics keep the order in which they are judged

RunResult result_of(const ordered_json& line, const std::string& path, int number) {
  RunResult result;
  const ordered_json& stored = line.at("result");
  result.run.seconds = stored.at("seconds").get<double>();
  const std::string outcome = stored.at("outcome").get<std::string>();
  result.run.outcome =
      find_row(outcome_rows(), outcome, path, fmt::format("line {}, result.outcome", number)).outcome;
  for (const auto& [key, value] : stored.items()) {
    if (key == "outcome" || key == "seconds") continue;
    result.keys.push_back(key);
    result.run.values.push_back(value.is_null() ? std::nullopt : std::optional(value.get<double>()));
  }
  return result;
}

struct StoreContents {
  std::map<std::string, RunResult> runs;
  std::size_t bytes = 0, torn_bytes = 0;
  bool lacks_line_end = false;
};

// Whether a last line without end is what the writer of a row leaves that is stopped on its way: the
// beginning of a row, as `stored_run` writes it, and no whole value behind which something else stands.
bool is_torn_row(std::string_view line) {
  constexpr std::string_view kBegin = R"({"hash":")";
  if (line.substr(0, kBegin.size()) != kBegin.substr(0, line.size())) return false;
  std::istringstream text{std::string(line)};
  ordered_json value;
  try {
    text >> value;  // takes one value, and leaves what is behind it
    return false;
  } catch (const ordered_json::exception&) {
    return true;
  }
}

void add_line(StoreContents& contents, std::string_view text, const std::string& path, int number) {
  check_json_budget(text, kRunBudget, path, number);
  try {
    const auto line = ordered_json::parse(text);
    const std::string hash = line.at("hash").get<std::string>();
    if (!line.contains("error")) contents.runs[hash] = result_of(line, path, number);
  } catch (const ordered_json::exception& problem) {
    throw ConfigError(path, fmt::format("line {}", number), "a stored run", problem.what());
  }
}

StoreContents read_store(const std::string& path) {
  const FilesRead apart(FilesRead::Scope::kApart);  // a store saves work; it makes no result
  const std::string text = read_text_file(path, kRunStoreBudget);
  check_json_budget(text, kRunStoreBudget, path);
  StoreContents contents;
  contents.bytes = text.size();
  std::string_view rest = text;
  for (int number = 1; !rest.empty(); ++number) {
    const std::size_t end = rest.find('\n');
    const std::string_view line = rest.substr(0, end);
    if (end == std::string_view::npos && is_torn_row(line)) {
      contents.torn_bytes = line.size();
      break;
    }
    add_line(contents, line, path, number);
    contents.lacks_line_end = end == std::string_view::npos;
    rest.remove_prefix(contents.lacks_line_end ? line.size() : end + 1);
  }
  return contents;
}

}  // namespace

std::string stored_run(const nlohmann::json& run, const RunResult& result) {
  const BehaviourRun& came = result.run;
  if (result.keys.size() != came.values.size()) {
    throw ConfigError("run", "result", fmt::format("{} numbers, one per key", result.keys.size()),
                      fmt::format("{}", came.values.size()));
  }
  ordered_json line{{"hash", fnv1a_hex(run.dump())}, {"run", run}};
  line["result"] = {{"outcome", name(came.outcome)}, {"seconds", came.seconds}};
  for (std::size_t i = 0; i < result.keys.size(); ++i)
    line["result"][result.keys[i]] = came.values[i] ? ordered_json(*came.values[i]) : ordered_json(nullptr);
  return line.dump();
}

RunStore::RunStore(std::string path) : file_(std::move(path)) {
  StoreContents contents = read_store(file_.path());
  runs_ = std::move(contents.runs);
  bytes_ = contents.bytes;
  torn_bytes_ = contents.torn_bytes;
  lacks_line_end_ = contents.lacks_line_end;
}

std::size_t count_stored_runs(const std::string& path) { return read_store(path).runs.size(); }

std::size_t RunStore::size() const {
  const std::scoped_lock lock(mutex_);
  return runs_.size();
}

std::optional<RunResult> RunStore::find(const nlohmann::json& run) const {
  const std::string hash = fnv1a_hex(run.dump());
  const std::scoped_lock lock(mutex_);
  const auto it = runs_.find(hash);
  return it == runs_.end() ? std::nullopt : std::optional(it->second);
}

void RunStore::add(const nlohmann::json& run, const RunResult& result) {
  const std::string hash = fnv1a_hex(run.dump());
  const std::string row = stored_run(run, result);
  const std::scoped_lock lock(mutex_);
  // Several threads may have made it, each because it was not there.
  if (const auto it = runs_.find(hash); it != runs_.end() && it->second.keys == result.keys) return;
  if (torn_bytes_ > 0) file_.cut(bytes_ - torn_bytes_, bytes_);
  torn_bytes_ = 0;
  file_.append(fmt::format("{}{}\n", lacks_line_end_ ? "\n" : "", row));
  lacks_line_end_ = false;
  runs_[hash] = result;
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
