#include "physics/core/consent.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "physics/core/error.h"
#include "physics/core/folder.h"
#include "physics/core/text.h"

namespace crossgait {
namespace {

namespace fs = std::filesystem;

struct Notice {
  std::mutex mutex;
  std::function<void(const std::string&)> say = [](const std::string& sentence) {
    fmt::print(stderr, "crossgait: note: {}\n", sentence);
  };
  std::set<std::string> said;
};

Notice& notice() {
  static Notice one;
  return one;
}

/// The way from a folder to a file in it or below it; empty if it is not there.
std::optional<fs::path> below(const fs::path& file, const fs::path& folder) {
  const auto [at, rest] = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
  if (at != folder.end()) return std::nullopt;
  fs::path way;
  for (auto part = rest; part != file.end(); ++part) way /= *part;
  return way;
}

bool is_trusted(const fs::path& file) {
  const std::string list = trusted_folders();
  return std::ranges::any_of(parts_of(list, ":"), [&](std::string_view folder) {
    std::error_code error;
    const fs::path trusted = fs::canonical(folder, error);
    return !error && below(file, trusted).has_value();
  });
}

/// Why a file is not the user's own; empty if it is.
std::string why_foreign(const fs::path& file) {
  std::error_code error;
  const fs::path here = fs::canonical(fs::current_path(error), error);
  const std::optional<fs::path> way = error ? std::nullopt : below(file, here);
  if (!way) return "a file outside the current folder";
  if (here == here.root_path()) return "a file anywhere, with / as the current folder";
  for (const fs::path& folder : way->parent_path()) {
    const std::string name = folder.string();
    if (name.starts_with('.') || name == "site-packages" || name == "dist-packages")
      return fmt::format("a file in {}, which programs fill", name);
  }
  struct stat status {};
  if (stat(file.c_str(), &status) != 0 || (status.st_uid != geteuid() && status.st_uid != 0))
    return "another user's file";
  return "";
}

}  // namespace

std::string trusted_folders() {
  const char* list = std::getenv(kTrustVariable);
  return list == nullptr ? "" : list;
}

void require_consent(const std::string& file, std::string_view runs) {
  check_file_name(file);
  std::error_code error;
  const fs::path real = fs::canonical(file, error);
  if (error) throw ConfigError(file, "file", "a readable file", error.message());
  if (!is_trusted(real)) {
    if (const std::string why = why_foreign(real); !why.empty()) {
      throw ConfigError(
          file, "code",
          fmt::format("consent, for {}: --trust FOLDER, crossgait.trust(FOLDER) or the environment variable "
                      "{}, FOLDER being '{}' or one above it",
                      runs, kTrustVariable, real.parent_path().string()),
          why);
    }
  }
  const std::string sentence = fmt::format("{} runs code: {}", file, runs);
  const std::lock_guard lock(notice().mutex);
  if (notice().said.insert(sentence).second) notice().say(sentence);
}

void trust_folder(const std::string& folder, const std::string& source) {
  check_file_name(folder);
  std::error_code error;
  const fs::path real = fs::canonical(folder, error);
  if (error || !fs::is_directory(real, error))
    throw ConfigError(source, "trust", "a folder", fmt::format("'{}'", folder));
  if (real.string().find(':') != std::string::npos)
    throw ConfigError(source, "trust",
                      fmt::format("a folder without ':', which parts them in {}", kTrustVariable),
                      fmt::format("'{}'", folder));
  const std::string list = trusted_folders();
  setenv(kTrustVariable, (list.empty() ? real.string() : list + ":" + real.string()).c_str(), 1);
}

void set_consent_notice(std::function<void(const std::string& sentence)> say) {
  const std::lock_guard lock(notice().mutex);
  notice().say = std::move(say);
}

}  // namespace crossgait
