#include "physics/core/text.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "physics/core/error.h"
#include "physics/core/files_read.h"
#include "physics/core/folder.h"
#include "physics/core/input_guard.h"

namespace crossgait {
namespace {

char small_letter(char c) noexcept { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

std::string kind_of(mode_t mode) {
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISFIFO(mode)) return "a pipe";
  if (S_ISSOCK(mode)) return "a socket";
  return "a device";
}

/// An open file, closed at the end.
class OpenFile {
 public:
  explicit OpenFile(const std::string& path) : path_(path) {
    check_file_name(path);
    // Not waiting for somebody to write to a pipe.
    descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor_ < 0) fail(errno == ENOENT ? "none" : std::generic_category().message(errno));
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode)) {
      ::close(descriptor_);
      fail(kind_of(status.st_mode));
    }
    size_ = static_cast<std::size_t>(status.st_size);
  }
  ~OpenFile() { ::close(descriptor_); }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  OpenFile(OpenFile&&) = delete;
  OpenFile& operator=(OpenFile&&) = delete;

  /// As the file system says; a file may grow, and some (of /proc) do not know theirs.
  std::size_t size() const { return size_; }

  /// Fills `text` from `from` on as far as there is something. @returns how much there was
  std::size_t read(std::string& text, std::size_t from) const {
    std::size_t at = from;
    while (at < text.size()) {
      const ssize_t count = ::read(descriptor_, text.data() + at, text.size() - at);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) fail(std::generic_category().message(errno));
      if (count == 0) break;
      at += static_cast<std::size_t>(count);
    }
    return at - from;
  }

 private:
  [[noreturn]] void fail(const std::string& found) const {
    throw ConfigError(path_, "file", "a readable file", found);
  }

  const std::string& path_;
  int descriptor_ = -1;
  std::size_t size_ = 0;
};

}  // namespace

std::string read_text_file(const std::string& path, const ReadBudget& budget) {
  const OpenFile file(path);
  const auto check = [&](std::size_t size, const std::string& found) {
    if (size > budget.bytes) {
      throw ConfigError(path, "file", fmt::format("at most {}", size_in_words(budget.bytes)), found);
    }
  };
  check(file.size(), size_in_words(file.size()));
  std::string text;
  std::size_t used = 0;
  constexpr std::size_t kStep = 4096;
  while (used == text.size()) {
    // One byte more than the file has tells its end.
    text.resize(used == 0 ? std::max(file.size() + 1, kStep) : 2 * used);
    used += file.read(text, used);
    check(used, "more");
  }
  text.resize(used);
  FilesRead::note(path, text);
  InputGuard::note_read(path);
  return text;
}

std::size_t width_of(std::string_view utf8) noexcept {
  return static_cast<std::size_t>(std::count_if(utf8.begin(), utf8.end(), begins_character));
}

std::vector<std::string_view> parts_of(std::string_view text, std::string_view separators) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t end = text.find_first_of(separators);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

std::optional<double> parse_number(std::string_view text) noexcept {
  if (text.starts_with('+')) {
    text.remove_prefix(1);
    if (text.starts_with('-')) return std::nullopt;
  }
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<std::uint64_t> parse_seed(std::string_view text) noexcept {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string_view json_error_text(const std::exception& error) noexcept {
  constexpr std::string_view kName = "[json.exception.", kEnd = "] ";
  const std::string_view text = error.what();
  const std::size_t end = text.find(kEnd);
  return text.starts_with(kName) && end != std::string_view::npos ? text.substr(end + kEnd.size()) : text;
}

std::string in_small_letters(std::string_view text) {
  std::string out(text);
  std::ranges::transform(out, out.begin(), small_letter);
  return out;
}

bool equals_ignoring_case(std::string_view a, std::string_view b) noexcept {
  return std::ranges::equal(a, b, {}, small_letter, small_letter);
}

}  // namespace crossgait
