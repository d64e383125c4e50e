// crossgait completion: what shells complete, and the manual, from the table that help is made of.
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/command.h"
#include "apps/help.h"
#include "study/version.h"

namespace crossgait::apps {
namespace {

std::vector<std::string> names_of(const std::vector<const CLI::App*>& commands) {
  std::vector<std::string> names;
  for (const CLI::App* command : commands) names.push_back(command->get_name());
  return names;
}

std::vector<std::string> spellings(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

// Of every option whose values come from a list: they are the same in every command.
std::map<std::string, std::vector<std::string>> values(const CLI::App& program) {
  std::map<std::string, std::vector<std::string>> all;
  for (const CLI::App* command : commands_of(program)) {
    for (const CLI::Option* option : options_of(*command)) {
      const std::vector<std::string> known = values_of(*option);
      if (known.empty()) continue;
      for (const std::string& name : spellings(*option)) all[name] = known;
    }
  }
  return all;
}

std::string bash(const CLI::App& program) {
  std::string text = fmt::format(
      "# bash completion of crossgait {}: eval \"$(crossgait completion bash)\"\n"
      "COMP_WORDBREAKS=${{COMP_WORDBREAKS//:/}}  # engines have colons\n"
      "_crossgait() {{\n"
      "  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}} words= list=\n"
      "  COMPREPLY=()\n"
      "  if ((COMP_CWORD == 1)); then\n"
      "    mapfile -t COMPREPLY < <(compgen -W '{} help --help --version' -- \"$word\")\n"
      "    return\n"
      "  fi\n"
      "  case $before in\n",
      crossgait_version(), fmt::join(names_of(commands_of(program)), " "));
  for (const auto& [option, known] : values(program))
    text += fmt::format("    {}) words='{}' ;;\n", option, fmt::join(known, " "));
  text +=
      "  esac\n"
      "  if [[ -n $words ]]; then\n"
      "    [[ $word != *,* ]] || list=${word%,*},\n"
      "    mapfile -t COMPREPLY < <(compgen -P \"$list\" -W \"$words\" -- \"${word##*,}\")\n"
      "    return\n"
      "  fi\n"
      "  [[ $word == -* ]] || return 0\n"
      "  case ${COMP_WORDS[1]} in\n";
  for (const CLI::App* command : commands_of(program)) {
    std::vector<std::string> options;
    for (const CLI::Option* option : options_of(*command)) {
      for (const std::string& name : spellings(*option)) options.push_back(name);
    }
    text += fmt::format("    {}) words='{}' ;;\n", command->get_name(), fmt::join(options, " "));
  }
  return text +
         "  esac\n"
         "  mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\")\n"
         "}\n"
         "complete -o default -F _crossgait crossgait\n";
}

std::string zsh(const CLI::App& program) {
  return "#compdef crossgait\n# zsh takes bash's way: source <(crossgait completion zsh)\n"
         "autoload -U +X compinit && compinit\nautoload -U +X bashcompinit && bashcompinit\n"
         "mapfile() { shift 2; COMPREPLY=(${(f)\"$(cat)\"}); }\n" +
         bash(program);
}

// A text between single quotes of fish.
std::string quoted(std::string text) {
  for (std::size_t at = 0; (at = text.find_first_of("'\\", at)) != std::string::npos; at += 2)
    text.insert(at, "\\");
  return "'" + text + "'";
}

std::string fish(const CLI::App& program) {
  std::string text = "# fish completion: crossgait completion fish | source\n";
  for (const CLI::App* command : commands_of(program)) {
    text += fmt::format("complete -c crossgait -n __fish_use_subcommand -f -a {} -d {}\n",
                        command->get_name(), quoted(command->get_description()));
    for (const CLI::Option* option : options_of(*command)) {
      const std::vector<std::string> known = values_of(*option);
      const std::string takes =
          metavar(*option).empty() ? ""
          : known.empty()          ? " -r"
                          : fmt::format(" -x -a {}", quoted(fmt::format("{}", fmt::join(known, " "))));
      for (const std::string& name : option->get_lnames()) {
        text += fmt::format("complete -c crossgait -n '__fish_seen_subcommand_from {}' -l {}{} -d {}\n",
                            command->get_name(), name, takes, quoted(option->get_description()));
      }
    }
  }
  return text;
}

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

std::string manual(const CLI::App& program) {
  std::string text = fmt::format(
      ".TH CROSSGAIT 1 \"\" \"Crossgait {}\"\n.SH NAME\ncrossgait \\- one quadruped stack over several "
      "physics "
      "engines\n.SH SYNOPSIS\n.B crossgait\n.I COMMAND\n[\\fIOPTIONS\\fR]\n.SH DESCRIPTION\n{}\n.SH "
      "COMMANDS\n",
      crossgait_version(), roff(program.get_description()));
  for (const CLI::App* command : commands_of(program)) {
    text += fmt::format(".SS crossgait {}\n{}\n", command->get_name(), roff(command->get_description()));
    for (const CLI::Option* option : options_of(*command)) {
      const std::string value = metavar(*option);
      text += fmt::format(".TP\n\\fB{}\\fR{}\n{}\n", roff(option->get_name(false, true)),
                          value.empty() ? "" : fmt::format(" \\fI{}\\fR", roff(value)),
                          roff(explanation(*option)));
    }
  }
  return text + ".SH EXIT STATUS\n0 done, 1 failed, 2 bad input, 130 interrupted.\n";
}

}  // namespace

void add_completion_command(CLI::App& program, Invocation& /*invocation*/) {
  CLI::App* command = program.add_subcommand("completion", "What a shell completes, or the manual page");
  command->footer(
      "\nExamples:\n"
      "  eval \"$(crossgait completion bash)\"          # or in ~/.bashrc\n"
      "  source <(crossgait completion zsh)\n"
      "  crossgait completion fish | source\n"
      "  crossgait completion man > crossgait.1 && man ./crossgait.1");
  auto kind = std::make_shared<std::string>();
  command->add_option("for", *kind, "What it is for")
      ->type_name("bash|zsh|fish|man")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish", "man"}));
  on_run(*command, [kind, &program] {
    print_data(*kind == "bash"   ? bash(program)
               : *kind == "zsh"  ? zsh(program)
               : *kind == "fish" ? fish(program)
                                 : manual(program));
  });
}

}  // namespace crossgait::apps
