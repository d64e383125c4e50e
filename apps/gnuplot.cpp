#include "crossgait/apps/gnuplot.h"

#include <array>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "crossgait/physics/error.h"

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
  if (!file) fail("temporary file for gnuplot", errno);
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
    if (const int code = posix_spawn_file_actions_init(&actions_); code != 0) fail("gnuplot", code);
  }
  ~SpawnActions() { posix_spawn_file_actions_destroy(&actions_); }
  SpawnActions(const SpawnActions&) = delete;
  SpawnActions& operator=(const SpawnActions&) = delete;

  void connect(FILE* file, int descriptor) {
    const int code = posix_spawn_file_actions_adddup2(&actions_, fileno(file), descriptor);
    if (code != 0) fail("gnuplot", code);
  }
  const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

}  // namespace

std::string gnuplot_quoted(std::string_view text) {
  // Between single quotes only the single quote itself is special (between double quotes, gnuplot would run
  // what stands in backquotes).
  std::string quoted = "'";
  for (const char c : text) {
    if (c == '\'') quoted += '\'';
    quoted += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? ' ' : c;
  }
  return quoted + "'";
}

std::string run_gnuplot(const std::string& script) {
  const File in = nameless_file(), out = nameless_file(), errors = nameless_file();
  if (std::fwrite(script.data(), 1, script.size(), in.get()) != script.size() || std::fflush(in.get()) != 0) {
    fail("temporary file for gnuplot", errno);
  }
  std::rewind(in.get());
  SpawnActions actions;
  actions.connect(in.get(), STDIN_FILENO);
  actions.connect(out.get(), STDOUT_FILENO);
  actions.connect(errors.get(), STDERR_FILENO);

  std::string program = "gnuplot", no_settings = "--default-settings";
  std::array<char*, 3> arguments{program.data(), no_settings.data(), nullptr};
  pid_t child = 0;
  const int code = posix_spawnp(&child, program.c_str(), actions.get(), nullptr, arguments.data(), environ);
  if (code == ENOENT) {
    throw ConfigError("picture", "gnuplot", "the program that draws it (Debian package gnuplot-nox)",
                      "none installed");
  }
  if (code != 0) fail("gnuplot", code);
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) fail("gnuplot", errno);
  }
  std::string image = read_all(out.get());
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || image.empty()) {
    throw std::runtime_error(fmt::format("gnuplot could not draw: {}", read_all(errors.get())));
  }
  return image;
}

}  // namespace crossgait::apps
