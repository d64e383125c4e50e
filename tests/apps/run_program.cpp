#include "crossgait/tests/apps/run_program.h"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>
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

nlohmann::json run_json(const std::string& arguments) {
  const ProgramResult result = run_program(arguments + " --json -");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return nlohmann::json::parse(result.out, nullptr, false);
}

std::string write_file(const std::string& name, const std::string& text) {
  std::ofstream(name, std::ios::binary) << text;
  return name;
}

void expect_bad_input(const std::string& arguments, const std::vector<std::string>& words) {
  const ProgramResult result = run_program(arguments);
  EXPECT_EQ(result.exit_code, 2) << arguments << "\n" << result.out << result.err;
  EXPECT_EQ(result.out, "") << arguments;
  for (const std::string& word : words) {
    EXPECT_NE(result.err.find(word), std::string::npos)
        << arguments << ": \"" << word << "\" not in: " << result.err;
  }
}

}  // namespace crossgait
