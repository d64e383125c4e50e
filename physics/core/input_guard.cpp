#include "physics/core/input_guard.h"

#include <atomic>
#include <filesystem>
#include <optional>
#include <system_error>

#include <fmt/format.h>
#include <sys/stat.h>

#include "physics/core/error.h"

namespace crossgait {
namespace {

std::atomic<InputGuard*> current = nullptr;

/// Which file stands at a path; none where there is no regular one: pipes and devices take and give.
std::optional<std::pair<dev_t, ino_t>> identity_of(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  return std::pair(status.st_dev, status.st_ino);
}

std::string place_of(const std::string& path) {
  std::error_code error;
  const std::filesystem::path place = std::filesystem::weakly_canonical(path, error);
  return error ? path : place.string();
}

[[noreturn]] void refuse(const std::string& source, const std::string& element, const std::string& input) {
  throw ConfigError(source, element, "a file that is not read", fmt::format("\"{}\", which is read", input));
}

}  // namespace

InputGuard::InputGuard(const std::vector<Output>& outputs) {
  for (const Output& output : outputs)
    if (const auto identity = identity_of(output.path)) outputs_.emplace(*identity, output);
  InputGuard* none = nullptr;
  current.compare_exchange_strong(none, this);
}

InputGuard::~InputGuard() {
  InputGuard* self = this;
  current.compare_exchange_strong(self, nullptr);
}

void InputGuard::note_read(const std::string& path) {
  InputGuard* const guard = current;
  const auto identity = guard != nullptr ? identity_of(path) : std::nullopt;
  if (!identity) return;
  const std::scoped_lock lock(guard->mutex_);
  guard->files_.insert_or_assign(*identity, path);
  guard->places_.emplace(place_of(path), path);
  if (const auto output = guard->outputs_.find(*identity); output != guard->outputs_.end())
    refuse("command line", output->second.option, path);
}

void InputGuard::check_output(const std::string& output) {
  InputGuard* const guard = current;
  if (guard == nullptr) return;
  const auto identity = identity_of(output);
  const std::scoped_lock lock(guard->mutex_);
  // What was read may have been moved since: then its place counts, and its number may be another file's.
  if (const auto file = identity ? guard->files_.find(*identity) : guard->files_.end();
      file != guard->files_.end() && identity_of(file->second) == identity)
    refuse(output, "output file", file->second);
  if (const auto place = guard->places_.find(place_of(output)); place != guard->places_.end())
    refuse(output, "output file", place->second);
}

}  // namespace crossgait
