// crossgait rerun: a stored result once more.
#include <filesystem>

#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/recorded_command.h"
#include "physics/core/error.h"

namespace crossgait::apps {
void add_rerun_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command =
      program.add_subcommand("rerun", "Make a stored result again, and say whether it is the same");
  command->footer(
      "\nThe file's `provenance` says how it was made. What it was made with has to be there: this version "
      "of\n"
      "Crossgait and its engines, and files with the same contents. Options behind the file say where the "
      "new\n"
      "result goes; without any, it is printed as the command prints it. Exit code 1 if it came out "
      "otherwise\n"
      "(times aside).\n"
      "\nExamples:\n"
      "  crossgait walk --terrain rough --json walk.json && crossgait rerun walk.json\n"
      "  crossgait rerun verdict.json --json again.json");
  auto file = std::make_shared<std::string>();
  command->add_option("result", *file, "What a command's --json wrote")->type_name("FILE.json")->required();
  command->allow_extras();
  command->callback([command, file, &program, &invocation] {
    Recorded recorded = read_recorded(*file);
    std::vector<std::string> again = recorded_command(program, recorded);
    for (const std::string& word : command->remaining()) {
      std::error_code error;
      if (std::filesystem::equivalent(word.substr(word.find('=') + 1), *file, error))
        throw ConfigError("command line", word, "a file that is not read", *file);
      again.push_back(word);
    }
    invocation = {{{"", std::move(again)}}, std::move(recorded)};
  });
}

}  // namespace crossgait::apps
