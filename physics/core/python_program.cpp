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

void set_python_program(const std::string& executable) { stated() = executable; }

}  // namespace crossgait
