#include "apps/results.h"

#include <array>
#include <cerrno>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "backends/registry.h"
#include "physics/core/atomic_file.h"
#include "physics/core/error.h"
#include "physics/core/files_read.h"
#include "physics/core/text.h"
#include "physics/robot_files/xacro/xacro_reader.h"
#include "study/run_spec.h"

namespace crossgait::apps {
namespace {

using Json = nlohmann::json;
using nlohmann::ordered_json;

bool is_file(const std::string& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error);
}

std::string long_name(const CLI::Option& option) {
  return option.nonpositional() ? option.get_name() : option.get_name(true);
}

bool makes_the_result(const CLI::Option& option) {
  return option.count() > 0 && option.get_group() != kOutputs && option.get_group() != kExecution;
}

// As they can be typed again: "--name=value" for each value, since values may begin with a dash.
std::vector<std::string> arguments_of(const CLI::App& command, const ResultInputs& inputs) {
  std::vector<std::string> arguments;
  for (const CLI::Option* option : command.get_options()) {
    const auto chosen = inputs.chosen.find(option->get_name());
    if (option->count() == 0 && chosen != inputs.chosen.end()) {
      for (const std::string& value : chosen->second)
        arguments.push_back(fmt::format("{}={}", long_name(*option), value));
    }
    if (!makes_the_result(*option)) continue;
    const bool flag = option->get_items_expected_max() == 0;
    for (const std::string& value : option->results()) {
      arguments.push_back(flag                      ? long_name(*option)
                          : option->nonpositional() ? fmt::format("{}={}", long_name(*option), value)
                                                    : value);
    }
  }
  return arguments;
}

// What is in the files now that a recorded result was made of; nothing of one that is not there.
std::map<std::string, std::string> files_now(const Json& recorded) {
  const FilesRead apart(FilesRead::Scope::kApart);
  std::map<std::string, std::string> files;
  const Json before = recorded.value("files", Json::object());
  for (const auto& [shown, hash] : before.items()) {
    const std::string path = path_of_shown(shown);
    if (is_file(path)) files[shown] = file_sha256(path);
    // Known once it is expanded again; another robot has another identity then.
    if (shown.ends_with(kExpanded)) files[shown] = hash.get<std::string>();
  }
  return files;
}

// What differs from run to run, and what says how a result was made.
void drop_times(Json& value) {
  if (value.is_object()) {
    value.erase("wall_seconds");
    value.erase("provenance");
  }
  if (value.is_structured()) {
    for (Json& inner : value) drop_times(inner);
  }
}

void compare_with_recorded(const Recorded& recorded, const ordered_json& now) {
  Json before = recorded.result, after = Json::parse(now.dump());
  drop_times(before);
  drop_times(after);
  if (before == after) {
    print_error(fmt::format("crossgait: the same result as in {}\n", recorded.file));
    return;
  }
  const Json difference = Json::diff(before, after);
  throw std::runtime_error(fmt::format("another result than in {}: {} differ, the first is {}", recorded.file,
                                       difference.size(), difference.front().at("path").get<std::string>()));
}

}  // namespace

ResultInputs of_robot(const RobotDescription& robot) {
  ResultInputs inputs;
  inputs.subject["robot"] = identity_of_robot(robot);
  return inputs;
}

ResultInputs of_gait(std::shared_ptr<const RobotDescription> robot, const GaitChoice& gait) {
  WalkConfig walk;
  walk.gait = gait;
  const Json behaviour = LoadedBehaviour({walk, std::move(robot)}, {}, 0).described.at("behaviour");
  ResultInputs inputs;
  inputs.subject["robot"] = behaviour.at("robot");
  inputs.subject["behaviour"] = {{"gait", behaviour.at("gait")}, {"parameters", behaviour.at("parameters")}};
  return inputs;
}

void JsonOption::add_to(CLI::App& command, const Invocation& invocation) {
  command_ = &command;
  invocation_ = &invocation;
  add_output_option(command, "--json", path, "Write the result as JSON to FILE, or to standard output with -")
      ->type_name("FILE|-");
}

Provenance JsonOption::provenance(const ResultInputs& inputs) const {
  check_outputs_apart(*command_, inputs.derived_outputs);
  Provenance p;
  p.command = command_->get_name();
  p.arguments = arguments_of(*command_, inputs);
  for (const std::string& engine : inputs.engines) p.engines.push_back(find_engine(engine).info);
  p.subject = inputs.subject;
  if (const std::optional<Recorded>& recorded = invocation_->recorded) {
    // Before anything is made: what it was made of has to be there still.
    const Json& before = recorded->result.at("provenance");
    p.files = files_now(before);
    check_same(before, p, recorded->file);
  }
  // A name that JSON cannot say is found out now, not when the work is done.
  static_cast<void>(to_json(with_files_read(p)));
  return p;
}

void JsonOption::emit(const std::string& text, ordered_json json, const Provenance& provenance) const {
  json["provenance"] = to_json(with_files_read(provenance));
  const std::string bytes = json.dump(2) + "\n";
  if (!path.empty() && !to_stdout()) write_file_atomically(path, bytes);
  to_stdout() ? print_data(bytes) : print(text);
  if (!path.empty() && !to_stdout()) print_written(path);
  if (const std::optional<Recorded>& recorded = invocation_->recorded) {
    flush_standard_output();
    compare_with_recorded(*recorded, json);
  }
}

void JsonOption::emit(const std::string& text, ordered_json json) const {
  emit(text, std::move(json), provenance());
}

Recorded read_recorded(const std::string& file) { return {file, read_result(file)}; }

void keep_standard_streams() {
  // The lowest free number is the one that is closed. Opened the wrong way round, it takes and gives nothing.
  const std::array<int, 3> modes{O_WRONLY, O_RDONLY, O_RDONLY};
  for (int stream = 0; stream < 3; ++stream) {
    if (::fcntl(stream, F_GETFD) < 0 && errno == EBADF)
      static_cast<void>(::open("/dev/null", modes[static_cast<std::size_t>(stream)]));
  }
}

}  // namespace crossgait::apps
