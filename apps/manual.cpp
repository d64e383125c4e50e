#include "apps/manual.h"

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "apps/help.h"
#include "study/version.h"

namespace crossgait::apps {
namespace {

// As troff takes it: a backslash and a leading dot or quote mean something there, and a hyphen is not a
// minus.
std::string roff(const std::string& text) {
  std::string result;
  bool begins = true;
  for (const char c : text) {
    if (begins && (c == '.' || c == '\'')) result += "\\&";
    if (c == '\\') {
      result += "\\e";
    } else if (c == '-') {
      result += "\\-";
    } else {
      result += c;
    }
    begins = c == '\n';
  }
  return result;
}

std::string heading(const std::string& page, const std::string& what) {
  return fmt::format(".TH {} 1 \"\" \"Crossgait {}\" \"Crossgait\"\n.SH NAME\n{} \\- {}\n", roff(page),
                     crossgait_version(), roff(page), roff(what));
}

std::string upper(std::string text) {
  for (char& c : text)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return text;
}

// One of the entries of a list: what is typed, what stands for its value, what it is for.
std::string entry(const std::string& typed, const std::string& value, const std::string& meaning) {
  return fmt::format(".TP\n\\fB{}\\fR{}\n{}\n", roff(typed),
                     value.empty() ? "" : fmt::format(" \\fI{}\\fR", roff(value)), roff(meaning));
}

std::vector<const CLI::Option*> arguments_of(const CLI::App& command) {
  std::vector<const CLI::Option*> arguments;
  for (const CLI::Option* option : command.get_options())
    if (!option->nonpositional()) arguments.push_back(option);
  return arguments;
}

std::string synopsis(const CLI::App& command) {
  std::string text = fmt::format(".SH SYNOPSIS\n.B crossgait {}\n", roff(command.get_name()));
  for (const CLI::Option* argument : arguments_of(command)) {
    const bool many = argument->get_expected_max() == CLI::detail::expected_max_vector_size;
    const std::string name =
        fmt::format("\\fI{}\\fR{}", roff(upper(argument->get_name())), many ? " ..." : "");
    text += argument->get_required() ? name + "\n" : fmt::format("[{}]\n", name);
  }
  return text + "[\\fIOPTIONS\\fR]\n";
}

// Options in the order of help: those of the command itself, then each group as it comes.
std::string options(const CLI::App& command) {
  std::vector<std::pair<std::string, std::string>> groups;
  for (const CLI::Option* option : options_of(command)) {
    const std::string group = option->get_group();
    if (group.empty()) continue;  // hidden
    auto at = groups.begin();
    while (at != groups.end() && at->first != group) ++at;
    if (at == groups.end()) at = groups.insert(at, {group, ""});
    at->second += entry(option->get_name(false, true), metavar(*option), explanation(*option));
  }
  std::string text;
  for (const auto& [group, entries] : groups) text += fmt::format(".SH {}\n{}", roff(upper(group)), entries);
  return text;
}

struct Footer {
  std::string words, examples;  // as the manual has them
};

// What stands below the options in help: words, and lines behind "Examples:", which are indented there.
Footer footer_of(const CLI::App& command) {
  std::string words, examples;
  bool in_examples = false;
  const std::string footer = command.get_footer();
  std::string_view rest = footer;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string line(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    in_examples = line == "Examples:" || (in_examples && line.starts_with("  "));
    if (line.empty() || line == "Examples:") continue;
    (in_examples ? examples : words) += roff(in_examples ? line.substr(2) : line) + "\n";
  }
  return {words.empty() ? "" : ".PP\n" + words,
          examples.empty() ? "" : ".SH EXAMPLES\n.nf\n" + examples + ".fi\n"};
}

constexpr const char* kExitStatus =
    ".SH EXIT STATUS\n0 done, 1 failed, 2 bad input, 130 interrupted; what a command has beside these its "
    "page "
    "says.\n";

constexpr const char* kEnvironment =
    ".SH ENVIRONMENT\n"
    ".TP\n\\fBCROSSGAIT_ENGINE_PATH\\fR\nFurther folders with engines, apart by colons.\n"
    ".TP\n\\fBCROSSGAIT_ROBOT_PATH\\fR\nFurther folders with robots, apart by colons.\n"
    ".TP\n\\fBCROSSGAIT_DATA\\fR\nThe folder of robots, terrains and policies, in the place of the installed "
    "one.\n"
    ".TP\n\\fBCROSSGAIT_PYTHON\\fR\nThe Python that has the package crossgait, for commands that it does; "
    "python3 unless said.\n"
    ".TP\n\\fBNO_COLOR\\fR\nIf set, no colours on a terminal.\n";

}  // namespace

std::string manual_name(const std::string& command) {
  return command.empty() ? "crossgait" : "crossgait-" + command;
}

std::string manual_of_program(const CLI::App& program) {
  std::string text = heading("crossgait", "one quadruped stack over several physics engines");
  text += fmt::format(".SH SYNOPSIS\n.B crossgait\n\\fICOMMAND\\fR [\\fIOPTIONS\\fR]\n.SH DESCRIPTION\n{}",
                      roff(program.get_description()));
  std::vector<std::string> groups;
  for (const CLI::App* command : commands_of(program)) {
    if (std::find(groups.begin(), groups.end(), command->get_group()) == groups.end())
      groups.push_back(command->get_group());
  }
  text += ".SH COMMANDS\n";
  for (const std::string& group : groups) {
    text += fmt::format(".SS {}\n", roff(group));
    for (const CLI::App* command : commands_of(program)) {
      if (command->get_group() == group)
        text += fmt::format(".TP\n.BR {} (1)\n{}\n", roff(manual_name(command->get_name())),
                            roff(command->get_description()));
    }
  }
  return text + kEnvironment + kExitStatus;
}

std::string manual_of_command(const CLI::App& command) {
  std::string text = heading(manual_name(command.get_name()), command.get_description()) + synopsis(command);
  const Footer footer = footer_of(command);
  text += fmt::format(".SH DESCRIPTION\n{}.\n{}", roff(command.get_description()), footer.words);
  const std::vector<const CLI::Option*> arguments = arguments_of(command);
  if (!arguments.empty()) text += ".SH ARGUMENTS\n";
  for (const CLI::Option* argument : arguments)
    text += entry(upper(argument->get_name()), metavar(*argument), explanation(*argument));
  return text + options(command) + footer.examples + kExitStatus + ".SH SEE ALSO\n.BR crossgait (1)\n";
}

}  // namespace crossgait::apps
