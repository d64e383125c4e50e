#include "apps/python_module.h"

#include <fmt/format.h>

#include "apps/interruption.h"
#include "physics/core/error.h"
#include "physics/core/python_program.h"

namespace crossgait::apps {

void require_python_module(const std::string& command, const std::string& module, const std::string& extra) {
  const auto found = run_child(python_import_command(module));
  if (found && found->exit_code == 0) return;
  std::string why = found ? found->errors : "no such program";
  why.erase(why.find_last_not_of('\n') + 1);
  throw ConfigError(
      command, python_program(),
      fmt::format(
          "a Python with Crossgait's package: pip install 'crossgait[{}]' (CROSSGAIT_PYTHON names it)",
          extra),
      why.substr(why.rfind('\n') + 1));
}

ChildResult run_python_module(const std::string& module, const std::vector<std::string>& arguments) {
  std::vector<std::string> command = python_module_command(module);
  command.insert(command.end(), arguments.begin(), arguments.end());
  listen_for_interruption();
  auto done = run_child(command, ChildErrors::kShown, std::nullopt, ChildSignals::kHandedOn);
  check_interruption();
  if (!done || done->exit_code != 0) throw ChildFailed{done ? done->exit_code : -1};
  return *std::move(done);
}

}  // namespace crossgait::apps
