#include "crossgait/tests/apps/run_program.h"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include <sys/wait.h>
#include <unistd.h>

namespace crossgait {

ProgramResult run_program(const std::string& arguments) {
  ProgramResult result;
  const std::string errors = "stderr." + std::to_string(getpid());
  const std::string command = std::string(CROSSGAIT_PROGRAM) + " " + arguments + " 2>" + errors;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return result;
  char buffer[4096];
  while (const std::size_t count = std::fread(buffer, 1, sizeof buffer, pipe))
    result.out.append(buffer, count);
  const int status = pclose(pipe);
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  std::ifstream file(errors);
  result.err.assign(std::istreambuf_iterator<char>(file), {});
  std::remove(errors.c_str());
  return result;
}

}  // namespace crossgait
