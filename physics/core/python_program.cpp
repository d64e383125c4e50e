#include "physics/core/python_program.h"

#include <cstdlib>

namespace crossgait {
namespace {

std::string& stated() {
  static std::string executable;
  return executable;
}

}  // namespace

std::string python_program() {
  const char* chosen = std::getenv("CROSSGAIT_PYTHON");
  if (chosen != nullptr && *chosen != '\0') return chosen;
  return stated().empty() ? "python3" : stated();
}

std::vector<std::string> python_code_command(const std::string& code) {
  // Before anything is imported that is not built in.
  return {python_program(), "-c",
          "import sys; sys.path[:] = [folder for folder in sys.path if folder]\n" + code};
}

std::vector<std::string> python_module_command(const std::string& module) {
  std::vector<std::string> command = python_code_command(
      "import runpy; runpy.run_module(sys.argv.pop(1), run_name='__main__', alter_sys=True)");
  command.push_back(module);
  return command;
}

std::vector<std::string> python_file_command(const std::string& file) {
  std::vector<std::string> command = python_code_command(
      "import os, runpy; file = sys.argv.pop(1); sys.path.append(os.path.dirname(os.path.abspath(file)))\n"
      "sys.argv[0] = file; runpy.run_path(file, run_name='__main__')");
  command.push_back(file);
  return command;
}

std::vector<std::string> python_import_command(const std::string& module) {
  return python_code_command("import " + module);
}

void set_python_program(const std::string& executable) { stated() = executable; }

}  // namespace crossgait
