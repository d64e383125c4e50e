// crossgait completion: what shells complete, and the manual, from the table that help is made of.
#include <filesystem>
#include <map>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/command.h"
#include "apps/help.h"
#include "apps/manual.h"
#include "physics/core/atomic_file.h"
#include "physics/core/error.h"
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

std::string manual(const CLI::App& program, const std::string& command) {
  if (command.empty()) return manual_of_program(program);
  for (const CLI::App* known : commands_of(program))
    if (known->get_name() == command) return manual_of_command(*known);
  throw ConfigError("command line", "command",
                    fmt::format("one of {}", fmt::join(names_of(commands_of(program)), ", ")), command);
}

// Writes every page of the manual, as `man` finds them in a folder man1.
void write_manual(const CLI::App& program, const std::string& folder) {
  std::error_code error;  // which the first file has, too
  std::filesystem::create_directories(folder, error);
  std::vector<std::string> names = names_of(commands_of(program));
  names.emplace_back();  // of the program itself
  for (const std::string& name : names)
    write_file_atomically(fmt::format("{}/{}.1", folder, manual_name(name)), manual(program, name));
}

}  // namespace

void add_completion_command(CLI::App& program, Invocation& /*invocation*/) {
  CLI::App* command = program.add_subcommand("completion", "What a shell completes, or the manual page");
  command->footer(
      "\nExamples:\n"
      "  eval \"$(crossgait completion bash)\"          # or in ~/.bashrc\n"
      "  source <(crossgait completion zsh)\n"
      "  crossgait completion fish | source\n"
      "  crossgait completion man verdict | man -l -\n"
      "  crossgait completion man --out ~/.local/share/man/man1   # then: man crossgait-verdict");
  auto kind = std::make_shared<std::string>(), page = std::make_shared<std::string>(),
       folder = std::make_shared<std::string>();
  command->add_option("for", *kind, "What it is for")
      ->type_name("bash|zsh|fish|man")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish", "man"}));
  CLI::Option* one = command->add_option(
      "command", *page, "The command whose page of the manual is printed; none: crossgait(1)");
  command->add_option("--out", *folder, "Print nothing: write every page of the manual into this folder")
      ->type_name("FOLDER")
      ->excludes(one);
  on_run(*command, [kind, page, folder, &program] {
    if (*kind != "man" && !(page->empty() && folder->empty()))
      throw ConfigError("command line", page->empty() ? "--out" : "command", "man, whose pages they are of",
                        *kind);
    if (!folder->empty()) return write_manual(program, *folder);
    print_data(*kind == "bash"   ? bash(program)
               : *kind == "zsh"  ? zsh(program)
               : *kind == "fish" ? fish(program)
                                 : manual(program, *page));
  });
}

}  // namespace crossgait::apps
