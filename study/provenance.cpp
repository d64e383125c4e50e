#include "study/provenance.h"

#include <filesystem>
#include <string_view>

#include "physics/core/error.h"
#include "physics/core/files_read.h"
#include "physics/core/hash.h"
#include "physics/core/json_once.h"
#include "physics/core/read_budget.h"
#include "physics/core/text.h"
#include "physics/robot_files/data_path.h"

namespace crossgait {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

Json without_hash(const Provenance& p) {
  Json result{{"crossgait", p.crossgait}, {"command", p.command}, {"arguments", p.arguments}};
  result["files"] = Json::object();
  for (const auto& [name, hash] : p.files) result["files"][name] = hash;
  result["engines"] = Json::array();
  for (const EngineInfo& e : p.engines)
    result["engines"].push_back({{"name", e.name}, {"library", e.library}, {"version", e.version}});
  if (p.subject.is_object()) result.update(p.subject);
  return result;
}

Json parse_result(const std::string& text, const std::string& file) {
  check_json_budget(text, kResultBudget, file);
  Json result;
  try {
    result = parse_json_once<Json>(text, [&file](const std::string& key) {
      throw ConfigError(file, key, "each key once in an object", "twice");
    });
  } catch (const Json::exception&) {
  }
  if (!result.is_object())
    throw ConfigError(file, "file", "a result as `--json` writes it", "no JSON object");
  return result;
}

constexpr std::string_view kModels = "<models>/";

// What comes with Crossgait lies elsewhere on another machine.
std::string shown_path(const std::string& path) {
  const fs::path normal = fs::path(path).lexically_normal();
  const fs::path inside = normal.lexically_relative(fs::path(models_dir()).lexically_normal());
  const bool is_inside = !inside.empty() && *inside.begin() != "..";
  return is_inside ? std::string(kModels) + inside.string() : normal.string();
}

// The innermost place in which two values differ, and what stands there.
struct Difference {
  std::string place, recorded, now;
};

Difference first_difference(const Json& recorded, const Json& now, const std::string& place) {
  if (recorded.is_object() && now.is_object()) {
    for (const auto& [key, value] : recorded.items()) {
      const Json other = now.value(key, Json());
      if (other != value) return first_difference(value, other, place + "." + key);
    }
    for (const auto& [key, value] : now.items()) {
      if (!recorded.contains(key)) return {place + "." + key, "nothing", value.dump()};
    }
  }
  if (recorded.is_array() && now.is_array() && recorded.size() == now.size()) {
    for (std::size_t i = 0; i < recorded.size(); ++i) {
      if (recorded[i] != now[i])
        return first_difference(recorded[i], now[i], place + "." + std::to_string(i));
    }
  }
  return {place, recorded.dump(), now.dump()};
}

}  // namespace

Provenance with_files_read(Provenance provenance) {
  provenance.files.clear();
  const FilesRead* const read = FilesRead::current();
  if (read == nullptr) return provenance;
  for (const FileRead& file : read->list()) {
    const auto [it, is_new] = provenance.files.emplace(shown_path(file.path), file.sha256);
    if (!is_new && it->second != file.sha256)
      throw ConfigError(file.path, "file", "the same bytes whenever it is read",
                        "others: it was changed meanwhile");
  }
  return provenance;
}

std::string path_of_shown(const std::string& shown) {
  if (!shown.starts_with(kModels)) return shown;
  return (fs::path(models_dir()) / shown.substr(kModels.size())).string();
}

nlohmann::ordered_json to_json(const Provenance& p) {
  const Json all = without_hash(p);
  nlohmann::ordered_json result{{"crossgait", p.crossgait}, {"command", p.command}};
  for (const auto& [key, value] : all.items()) result[key] = value;
  result["hash"] = fnv1a_hex(all.dump());
  return result;
}

std::string read_result_text(const std::string& file) {
  std::string text = read_text_file(file, kResultBudget);
  static_cast<void>(parse_result(text, file));
  return text;
}

Json read_result(const std::string& file) { return parse_result(read_text_file(file, kResultBudget), file); }

std::vector<std::string> command_of(const Json& result, const std::string& file) {
  try {
    const Json& provenance = result.at("provenance");
    std::vector<std::string> words{provenance.at("command").get<std::string>()};
    for (const Json& word : provenance.at("arguments")) words.push_back(word.get<std::string>());
    return words;
  } catch (const Json::exception& problem) {
    throw ConfigError(file, "provenance", "the command that a result was made with, as `--json` writes it",
                      problem.what());
  }
}

void check_same(const Json& recorded, const Provenance& now, const std::string& file) {
  Json before = recorded;
  const Json hash = before.value("hash", Json());
  before.erase("hash");
  const Json after = without_hash(now);
  if (before == after) {
    if (const std::string expected = fnv1a_hex(after.dump()); hash != expected)
      throw ConfigError(file, "provenance.hash", expected + ", of the rest of it", hash.dump());
    return;
  }
  // What a person can do something about comes first.
  for (const char* key : {"crossgait", "engines", "files", "command", "arguments"}) {
    const Json one = before.value(key, Json());
    const Json& other = after.at(key);
    if (one == other) continue;
    const Difference d = first_difference(one, other, std::string("provenance.") + key);
    throw ConfigError(file, d.place, d.recorded, d.now);
  }
  const Difference d = first_difference(before, after, "provenance");
  throw ConfigError(file, d.place, d.recorded, d.now);
}

}  // namespace crossgait
