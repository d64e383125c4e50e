// crossgait import: a published policy, made into a folder that runs, by the Python package.
#include <filesystem>

#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/python_module.h"
#include "physics/core/folder.h"
#include "physics/core/schema.h"

namespace crossgait::apps {
namespace {

struct ImportCommand {
  std::string policy, robot, out, joint_order, config_class;
  std::vector<std::string> sources, settings;
  JsonOption json;
};

void run(const ImportCommand& options) {
  constexpr const char* kModule = "crossgait.importing";
  require_python_module("import", kModule, "import");
  std::vector<std::string> arguments{"--robot=" + options.robot, "--out=" + options.out, "--document"};
  const auto add = [&arguments](const std::string& option, const std::string& value) {
    if (!value.empty()) arguments.push_back("--" + option + "=" + value);
  };
  for (const std::string& source : options.sources) add("from", source);
  for (const std::string& setting : options.settings) add("set", setting);
  add("joint-order", options.joint_order);
  add("class", options.config_class);
  arguments.insert(arguments.end(), {"--", options.policy});
  const auto said = nlohmann::ordered_json::parse(run_python_module(kModule, arguments).out);
  options.json.emit(said.at("text").get<std::string>(), with_schema("import", said.at("document")));
}

// What the package writes into the folder, by its rules (python/crossgait/importing/imported.py).
std::vector<DerivedOutput> files_of_import(const std::string& out) {
  const std::filesystem::path folder = absolute_path(out).lexically_normal();
  const std::string name = (folder.has_filename() ? folder : folder.parent_path()).filename().string();
  std::vector<DerivedOutput> files;
  for (const char* ending : {".onnx", ".yaml", ".safetensors"})
    files.push_back({"--out", (folder / (name + ending)).string()});
  for (const char* file : {"environment.yaml", "import.json", "actuator.safetensors"})
    files.push_back({"--out", (folder / file).string()});
  return files;
}

}  // namespace

void add_import_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command = program.add_subcommand(
      "import", "A published policy with the files that came with it, as a folder that --policy takes");
  command->footer(
      "\nEvery field of the environment is listed with where it comes from, and what nobody said.\n"
      "Done by Crossgait's Python package (crossgait[import]), which python3 or CROSSGAIT_PYTHON has to "
      "have.\n"
      "\nExamples:\n"
      "  crossgait import policy.onnx --from deploy.yaml --robot go2.xml --out go2_walk\n"
      "  crossgait import model_1500.pt --from env.yaml --from agent.yaml --robot robot.urdf --out walk\n"
      "  crossgait rollout --policy go2_walk");
  auto options = std::make_shared<ImportCommand>();
  command->add_option("policy", options->policy, "The network")
      ->type_name("FILE.onnx|pt|safetensors")
      ->required()
      ->check(CLI::ExistingFile);
  command
      ->add_option(
          "--from", options->sources,
          "What came with it: deploy.yaml, env.yaml, agent.yaml, config.yaml, a class of legged_gym; may "
          "be repeated. Metadata of ONNX files is read by itself")
      ->type_name("FILE.yaml|py")
      ->check(CLI::ExistingFile);
  command->add_option("--robot", options->robot, "A bundled robot's name (see `crossgait robots`) or a file")
      ->required();
  command->add_option("--out", options->out, "The folder; its name becomes the policy's")
      ->type_name("NAME")
      ->required()
      ->group(kOutputs);
  command->add_option("--set", options->settings, "Say a field in the place of the files; may be repeated")
      ->type_name("FIELD=VALUE");
  command->add_option("--joint-order", options->joint_order, "The convention of joints without names")
      ->type_name("NAME");
  command->add_option("--class", options->config_class, "Which class of Python files")->type_name("NAME");
  add_trust_option(*command);
  options->json.add_to(*command, invocation);
  on_run(*command, [options, command] {
    check_outputs_apart(*command, files_of_import(options->out));
    run(*options);
  });
}

}  // namespace crossgait::apps
