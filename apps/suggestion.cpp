#include "apps/suggestion.h"

#include <algorithm>

#include <fmt/format.h>

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

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t k = 0; k <= b.size(); ++k) {
      if (i == 0 || k == 0) {
        d[i][k] = i + k;
        continue;
      }
      const std::size_t replaced = d[i - 1][k - 1] + (a[i - 1] == b[k - 1] ? 0 : 1);
      d[i][k] = std::min({replaced, d[i - 1][k] + 1, d[i][k - 1] + 1});
      if (i > 1 && k > 1 && a[i - 1] == b[k - 2] && a[i - 2] == b[k - 1])
        d[i][k] = std::min(d[i][k], d[i - 2][k - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

std::string nearest(const std::string& word, const std::vector<std::string>& known) {
  const auto best = std::min_element(known.begin(), known.end(), [&word](const auto& a, const auto& b) {
    return edit_distance(word, a) < edit_distance(word, b);
  });
  const std::size_t letters = word.size() - std::min(word.size(), word.find_first_not_of('-'));
  const std::size_t most = std::max<std::size_t>(1, letters / 3);
  return best != known.end() && edit_distance(word, *best) <= most ? *best : "";
}

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

std::string unknown_command(const CLI::App& program) {
  if (!program.get_subcommands().empty()) return "";
  for (const std::string& word : program.remaining()) {
    if (!word.starts_with("-")) return fmt::format("There is no command \"{}\".", word);
  }
  return "";
}

}  // namespace crossgait::apps
