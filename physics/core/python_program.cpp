#include "physics/core/python_program.h"

#include <cstdlib>

namespace crossgait {
namespace {

std::string& stated() {
  static std::string executable;
  return executable;
}

// Before anything is imported that is not built in.
constexpr const char* kNoCurrentFolder =
    "import sys; sys.path[:] = [folder for folder in sys.path if folder]; ";

}  // namespace

std::string python_program() {
  const char* chosen = std::getenv("CROSSGAIT_PYTHON");
  if (chosen != nullptr && *chosen != '\0') return chosen;
  return stated().empty() ? "python3" : stated();
}

std::vector<std::string> python_module_command(const std::string& module) {
  return {python_program(), "-c",
          std::string(kNoCurrentFolder) +
              "import runpy; runpy.run_module(sys.argv.pop(1), run_name='__main__', alter_sys=True)",
          module};
}

std::vector<std::string> python_import_command(const std::string& module) {
  return {python_program(), "-c", kNoCurrentFolder + ("import " + module)};
}

void set_python_program(const std::string& executable) { stated() = executable; }

}  // namespace crossgait
