#include "apps/child_process.h"

#include <array>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <system_error>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace crossgait::apps {
namespace {

struct CloseFile {
  void operator()(FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<FILE, CloseFile>;

[[noreturn]] void fail(const char* what, int code) {
  throw std::system_error(code, std::generic_category(), what);
}

/// A file without a name, gone when closed: unlike a pipe it never makes a writer wait.
File nameless_file() {
  File file(std::tmpfile());
  if (!file) fail("temporary file", errno);
  return file;
}

std::string read_all(FILE* file) {
  std::rewind(file);
  std::string text;
  std::array<char, 65536> buffer{};
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), file)) {
    text.append(buffer.data(), count);
  }
  return text;
}

class SpawnActions {
 public:
  SpawnActions() {
    if (const int code = posix_spawn_file_actions_init(&actions_); code != 0) fail("a child process", code);
  }
  ~SpawnActions() { posix_spawn_file_actions_destroy(&actions_); }
  SpawnActions(const SpawnActions&) = delete;
  SpawnActions& operator=(const SpawnActions&) = delete;

  void connect(FILE* file, int descriptor) {
    const int code = posix_spawn_file_actions_adddup2(&actions_, fileno(file), descriptor);
    if (code != 0) fail("a child process", code);
  }
  const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

}  // namespace

std::optional<ChildResult> run_child(const std::vector<std::string>& command, ChildErrors errors) {
  const File in = nameless_file(), out = nameless_file(), complaints = nameless_file();
  SpawnActions actions;
  actions.connect(in.get(), STDIN_FILENO);
  actions.connect(out.get(), STDOUT_FILENO);
  if (errors == ChildErrors::kKept) actions.connect(complaints.get(), STDERR_FILENO);

  std::vector<std::string> words = command;
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  const int code =
      posix_spawnp(&child, words.front().c_str(), actions.get(), nullptr, arguments.data(), environ);
  if (code == ENOENT) return std::nullopt;
  if (code != 0) fail(words.front().c_str(), code);
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) fail(words.front().c_str(), errno);
  }
  return ChildResult{WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_all(out.get()),
                     read_all(complaints.get())};
}

}  // namespace crossgait::apps
