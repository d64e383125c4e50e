#include "apps/checkpoint.h"

#include <filesystem>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/python_module.h"
#include "physics/core/error.h"
#include "physics/core/files_read.h"
#include "physics/core/temporary_folder.h"
#include "physics/core/text.h"

namespace crossgait::apps {
namespace {

/// Says what a result is of: the files that were given, and not what was made of them on the way.
void note_files(const std::string& checkpoint, const std::string& agent) {
  constexpr ReadBudget kCheckpoint{256 * kMebibyte};
  read_text_file(checkpoint, kCheckpoint);
  if (!agent.empty()) read_text_file(agent, kYamlBudget);
}

std::string agent_beside(const std::string& checkpoint) {
  const std::filesystem::path folder = std::filesystem::path(checkpoint).parent_path();
  for (const char* place : {"agent.yaml", "params/agent.yaml"}) {
    const std::filesystem::path file = folder / place;
    if (std::filesystem::exists(file)) return file.string();
  }
  return {};
}

}  // namespace

bool is_checkpoint(const std::string& policy) {
  const std::string ending = in_small_letters(std::filesystem::path(policy).extension().string());
  return ending == ".pt" || ending == ".pth" || ending == ".onnx";
}

RelabelledPolicy read_checkpoint(const std::string& checkpoint, const std::string& environment,
                                 const std::string& agent) {
  constexpr const char* kModule = "crossgait.importing.checkpoint";
  const std::string stated = agent.empty() ? agent_beside(checkpoint) : agent;
  note_files(checkpoint, stated);
  require_python_module(checkpoint, kModule, "import");
  const TemporaryFolder folder("checkpoint");
  std::vector<std::string> arguments{"--env=" + environment, "--out=" + folder.file("")};
  if (!stated.empty()) arguments.push_back("--agent=" + stated);
  arguments.insert(arguments.end(), {"--", checkpoint});
  const auto said = nlohmann::json::parse(run_python_module(kModule, arguments).out);
  if (const auto error = said.find("error"); error != said.end())
    throw ConfigError(error->at("source").get<std::string>(), error->at("element").get<std::string>(),
                      error->at("expected").get<std::string>(), error->at("found").get<std::string>());
  const FilesRead apart(FilesRead::Scope::kApart);
  return read_relabelled_policy(said.at("policy").get<std::string>());
}

}  // namespace crossgait::apps
