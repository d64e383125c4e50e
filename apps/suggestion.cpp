#include "apps/suggestion.h"

#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/nearest.h"

namespace crossgait::apps {
namespace {

std::vector<std::string> command_names(const CLI::App& program) {
  std::vector<std::string> names;
  for (const CLI::App* command : program.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
    names.insert(names.end(), command->get_aliases().begin(), command->get_aliases().end());
  }
  return names;
}

std::string command_near(const std::string& word, const CLI::App& program) {
  // What people ask for by another word, however far its letters are from the command's.
  if (word == "plot" || word == "draw") return "report";
  return nearest(word, command_names(program));
}

std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

}  // namespace

std::string suggestion(const CLI::App& program) {
  const auto parsed = program.get_subcommands();
  const CLI::App& place = parsed.empty() ? program : *parsed.front();
  for (const std::string& word : place.remaining()) {
    const bool option = word.starts_with("-");
    const std::string near = option           ? nearest(word.substr(0, word.find('=')), option_names(place))
                             : parsed.empty() ? command_near(word, program)
                                              : "";
    if (!near.empty()) return fmt::format("Did you mean {}?", near);
  }
  return "";
}

std::string unexpected(const CLI::App& program) {
  const auto parsed = program.get_subcommands();
  return fmt::format("{}", fmt::join((parsed.empty() ? program : *parsed.front()).remaining(), " "));
}

std::string unknown_command(const CLI::App& program) {
  if (!program.get_subcommands().empty()) return "";
  for (const std::string& word : program.remaining()) {
    if (!word.starts_with("-")) return fmt::format("There is no command \"{}\".", word);
  }
  return "";
}

}  // namespace crossgait::apps
