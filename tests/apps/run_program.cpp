#include "tests/apps/run_program.h"

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace crossgait {

ProgramResult run_program(const std::string& arguments, const std::string& before) {
  ProgramResult result;
  const std::string errors = "stderr." + std::to_string(getpid());
  const std::string command = before + std::string(CROSSGAIT_PROGRAM) + " " + arguments + " 2>" + errors;
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

namespace {

std::string about(pid_t process, const char* file) { return "/proc/" + std::to_string(process) + "/" + file; }

// Whether the process is the program, not the shell that becomes it, and has a handler for the signal.
bool listens(pid_t process, int signal) {
  std::error_code gone;
  if (!std::filesystem::equivalent(about(process, "exe"), CROSSGAIT_PROGRAM, gone)) return false;
  std::ifstream status(about(process, "status"));
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("SigCgt:"))
      return (std::stoull(line.substr(7), nullptr, 16) >> (signal - 1)) % 2 == 1;
  }
  return false;
}

// What the process has had of the processors, s; 0 if it is gone.
double work_of(pid_t process) {
  clockid_t clock{};
  timespec time{};
  if (clock_getcpuclockid(process, &clock) != 0 || clock_gettime(clock, &time) != 0) return 0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Until the process has worked for so long, which on a busy machine takes longer; on an idle process no more
// than twenty times that.
void wait_for_work(pid_t process, double seconds) {
  using Clock = std::chrono::steady_clock;
  const auto limit = Clock::now() + std::chrono::duration<double>(20 * seconds);
  const double begin = work_of(process);
  while (work_of(process) - begin < seconds && Clock::now() < limit)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

}  // namespace

ProgramResult run_watched(const std::string& arguments, int signal, double after) {
  using namespace std::chrono_literals;
  const std::string out = "watched_out." + std::to_string(getpid()),
                    err = "watched_err." + std::to_string(getpid());
  const std::string command =
      std::string("exec ") + CROSSGAIT_PROGRAM + " " + arguments + " >" + out + " 2>" + err;
  const pid_t child = fork();
  if (child == 0) {
    // Tests run in the background, where SIGINT is ignored, and children would ignore it too.
    for (const int each : {SIGINT, SIGTERM, SIGHUP}) std::signal(each, SIG_DFL);
    execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    _exit(127);
  }
  ProgramResult result;
  int status = 0;
  struct rusage usage {};
  if (signal != 0) {
    while (!listens(child, signal) && waitpid(child, &status, WNOHANG) == 0) std::this_thread::sleep_for(5ms);
    wait_for_work(child, after);
    kill(child, signal);
  }
  if (wait4(child, &status, 0, &usage) == child) {
    result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
    result.peak_kb = usage.ru_maxrss;
  }
  result.out = read_file(out);
  result.err = read_file(err);
  std::remove(out.c_str());
  std::remove(err.c_str());
  return result;
}

std::string read_file(const std::string& name) {
  std::ifstream file(name, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

nlohmann::json without_times(nlohmann::json result) {
  if (result.is_object()) result.erase("wall_seconds");
  if (result.is_structured()) {
    for (nlohmann::json& inner : result) inner = without_times(std::move(inner));
  }
  return result;
}

nlohmann::json document_of(const std::string& page) {
  const std::string text = read_file(page), before = "<script id=\"document\" type=\"application/json\">";
  const std::size_t begin = text.find(before) + before.size();
  return nlohmann::json::parse(text.substr(begin, text.find("</script>", begin) - begin));
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
