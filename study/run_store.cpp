#include "study/run_store.h"

#include <filesystem>
#include <fstream>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/files_read.h"
#include "physics/core/hash.h"
#include "physics/core/text.h"

namespace crossgait {
namespace {

using nlohmann::ordered_json;  // statistics keep the order in which they are judged

RunResult result_of(const ordered_json& line) {
  RunResult result;
  for (const auto& [name, value] : line.at("result").items()) {
    result.names.push_back(name);
    result.values.push_back(value.get<double>());
  }
  return result;
}

}  // namespace

std::string stored_run(const nlohmann::json& run, const RunResult& result) {
  if (result.names.size() != result.values.size()) {
    throw ConfigError("run", "result", fmt::format("{} numbers, one per name", result.names.size()),
                      fmt::format("{}", result.values.size()));
  }
  ordered_json line{{"hash", fnv1a_hex(run.dump())}, {"run", run}};
  for (std::size_t i = 0; i < result.names.size(); ++i) line["result"][result.names[i]] = result.values[i];
  return line.dump();
}

RunStore::RunStore(std::string path) : path_(std::move(path)) {
  std::error_code error;
  if (!std::filesystem::exists(path_, error)) return;
  const FilesRead apart(FilesRead::Scope::kApart);  // a store saves work; it makes no result
  const std::string text = read_text_file(path_, kRunStoreBudget);
  std::size_t begin = 0, number = 0;
  check_json_budget(text, kRunStoreBudget, path_);
  for (std::size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n', begin)) {
    ++number;
    try {
      const std::string_view run = std::string_view(text).substr(begin, end - begin);
      check_json_budget(run, kRunBudget, path_, static_cast<int>(number));
      const auto line = ordered_json::parse(run);
      if (!line.contains("error")) runs_[line.at("hash").get<std::string>()] = result_of(line);
    } catch (const ordered_json::exception& problem) {
      throw ConfigError(path_, fmt::format("line {}", number), "a stored run", problem.what());
    }
    begin = end + 1;
  }
  whole_bytes_ = begin;
}

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
  const std::string bytes = stored_run(run, result) + "\n";
  const std::scoped_lock lock(mutex_);
  std::error_code error;
  if (std::filesystem::exists(path_, error)) std::filesystem::resize_file(path_, whole_bytes_, error);
  std::ofstream file(path_, std::ios::app | std::ios::binary);
  file << bytes << std::flush;
  if (error || !file) throw ConfigError(path_, "file", "a file that can be written", "one that cannot");
  whole_bytes_ += bytes.size();
  runs_[hash] = result;
}

Behaviour with_store(Behaviour behaviour, const LoadedBehaviour& loaded, std::shared_ptr<RunStore> store) {
  std::vector<std::string> names;
  for (const Statistic& s : behaviour.statistics) names.push_back(s.name);
  behaviour.run = [make = std::move(behaviour.run), names, described = loaded.described,
                   store = std::move(store)](const Engine& engine, const Variation& variation,
                                             std::size_t start) {
    const nlohmann::json run = describe_run(described, engine.info, variation, start);
    if (const auto stored = store->find(run); stored && stored->names == names) return stored->values;
    std::vector<double> values = make(engine, variation, start);
    store->add(run, {names, values});
    return values;
  };
  return behaviour;
}

}  // namespace crossgait
