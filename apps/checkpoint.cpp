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
bool is_checkpoint(const std::string& policy) {
  const std::string ending = in_small_letters(std::filesystem::path(policy).extension().string());
  return ending == ".pt" || ending == ".pth" || ending == ".onnx";
}

RelabelledPolicy read_checkpoint(const std::string& checkpoint, const std::string& environment,
                                 const std::string& agent) {
  constexpr const char* kModule = "crossgait.importing.checkpoint";
  // A result is of the files that were given, and not of what is made of them on the way.
  constexpr ReadBudget kCheckpoint{256 * kMebibyte};
  read_text_file(checkpoint, kCheckpoint);
  require_python_module(checkpoint, kModule, "import");
  const TemporaryFolder folder("checkpoint");
  std::vector<std::string> arguments{"--env=" + environment, "--out=" + folder.file("")};
  if (!agent.empty()) arguments.push_back("--agent=" + agent);
  arguments.insert(arguments.end(), {"--", checkpoint});
  const auto said = nlohmann::json::parse(run_python_module(kModule, arguments).out);
  if (const auto error = said.find("error"); error != said.end())
    throw ConfigError(error->at("source").get<std::string>(), error->at("element").get<std::string>(),
                      error->at("expected").get<std::string>(), error->at("found").get<std::string>());
  if (const auto& stated = said.at("agent"); !stated.is_null())
    read_text_file(stated.get<std::string>(), kYamlBudget);
  const FilesRead apart(FilesRead::Scope::kApart);
  return read_relabelled_policy(said.at("policy").get<std::string>());
}

}  // namespace crossgait::apps
