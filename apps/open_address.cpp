#include "apps/open_address.h"

#include <array>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "apps/command.h"
#include "physics/core/atomic_file.h"
#include "physics/core/error.h"
#include "physics/core/folder.h"
#include "physics/core/temporary_folder.h"

namespace crossgait::apps {
namespace {

/// @returns whether xdg-open was found and was content
bool open_file(std::string file) {
  std::string program = "xdg-open";
  const std::array<char*, 3> arguments{program.data(), file.data(), nullptr};
  pid_t child = 0;
  if (::posix_spawnp(&child, program.c_str(), nullptr, nullptr, arguments.data(), environ) != 0) return false;
  int status = 0;
  return ::waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

bool is_set(const char* variable) {
  const char* const value = std::getenv(variable);
  return value != nullptr && *value != '\0';
}

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "HOST";
}

}  // namespace

std::string temporary_file(const std::string& name) {
  std::string folder = (temporary_root("--open") / "crossgait.XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr)  // for its owner alone
    throw std::runtime_error(
        fmt::format("{}: no folder can be made: {}", folder, std::generic_category().message(errno)));
  return folder + "/" + name;
}

void open_page(const std::string& path) {
  const std::string file = absolute_path(path).string();
  if (is_set("SSH_CONNECTION") || is_set("SSH_TTY")) {
    print_notes(
        {fmt::format("this is a session over SSH; where your browser is: scp {}:'{}' . and open the copy",
                     host_name(), file)});
  } else if (!is_set("DISPLAY") && !is_set("WAYLAND_DISPLAY")) {
    print_notes({fmt::format("there is no display here: open {} in a browser", file)});
  } else if (!open_file(file)) {
    print_notes({fmt::format("xdg-open could not open it: open {} in a browser", file)});
  }
}

OpenedAddress::OpenedAddress(const std::string& address) {
  bool opened = false;
  try {
    folder_.emplace("view");
  } catch (const ConfigError&) {  // whoever cannot have one is told to do it by hand
  }
  if (folder_) {
    const std::string file = folder_->file("open.html");
    write_file_atomically(
        file, fmt::format("<!doctype html><meta http-equiv=\"refresh\" content=\"0; url={}\">\n", address));
    opened = open_file(file);
  }
  if (!opened) print_notes({"xdg-open could not open the address: do it by hand"});
}

}  // namespace crossgait::apps
