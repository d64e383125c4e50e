#include "apps/open_address.h"

#include <array>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "apps/command.h"
#include "physics/core/atomic_file.h"

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

}  // namespace

OpenedAddress::OpenedAddress(const std::string& address) {
  std::string folder = (std::filesystem::temp_directory_path() / "crossgait-view.XXXXXX").string();
  bool opened = false;
  if (::mkdtemp(folder.data()) != nullptr) {  // for its owner alone
    folder_ = folder;
    file_ = folder + "/open.html";
    write_file_atomically(
        file_, fmt::format("<!doctype html><meta http-equiv=\"refresh\" content=\"0; url={}\">\n", address));
    opened = open_file(file_);
  }
  if (!opened) print_notes({"xdg-open could not open the address: do it by hand"});
}

OpenedAddress::~OpenedAddress() {
  std::error_code nothing_to_be_done;
  if (!folder_.empty()) std::filesystem::remove_all(folder_, nothing_to_be_done);
}

}  // namespace crossgait::apps
