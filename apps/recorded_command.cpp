#include "apps/recorded_command.h"

#include <algorithm>

#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait::apps {
namespace {

bool makes_results(const CLI::App& command) {
  const CLI::Option* json = command.get_option_no_throw("--json");
  return json != nullptr && json->get_group() == kOutputs;
}

bool is_about_the_result(const CLI::Option& option) {
  return option.get_group() != kOutputs && option.get_group() != kExecution;
}

const CLI::App& find_command(const CLI::App& program, const std::string& name, const std::string& file) {
  for (const CLI::App* command : program.get_subcommands([](const CLI::App*) { return true; })) {
    if (command->get_name() == name && makes_results(*command)) return *command;
  }
  throw ConfigError(file, "provenance.command", "a command that makes results", name);
}

void check_argument(const CLI::App& command, const std::string& word, const std::string& file) {
  const auto require = [&](bool ok, const std::string& expected) {
    if (!ok) throw ConfigError(file, "provenance.arguments", expected, word);
  };
  if (word.starts_with('-')) {
    const CLI::Option* option = command.get_option_no_throw(word.substr(0, word.find('=')));
    require(option != nullptr, fmt::format("options of `{}`", command.get_name()));
    require(is_about_the_result(*option), "what makes the result, not where it goes or how it is worked at");
    return;
  }
  const std::vector<const CLI::Option*> options = command.get_options();
  require(std::all_of(options.begin(), options.end(),
                      [](const CLI::Option* o) { return !o->get_positional() || is_about_the_result(*o); }),
          "what makes the result, not where it goes");
}

}  // namespace

std::vector<std::string> recorded_command(const CLI::App& program, const Recorded& recorded) {
  std::vector<std::string> words = command_of(recorded.result, recorded.file);
  const CLI::App& command = find_command(program, words.front(), recorded.file);
  for (auto word = words.begin() + 1; word != words.end(); ++word)
    check_argument(command, *word, recorded.file);
  return words;
}

}  // namespace crossgait::apps
