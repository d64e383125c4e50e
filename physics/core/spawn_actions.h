// What a program finds when it is started: its descriptors and its words.
#pragma once

#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <spawn.h>

namespace crossgait {

/// Throws what the system answered, an error of `errno`'s kind, about what was asked.
[[noreturn]] inline void throw_system_error(int code, std::string_view what) {
  throw std::system_error(code, std::generic_category(), std::string(what));
}

/// Collects descriptors of a program to be started, in the order in which it gets them. All functions throw
/// std::system_error.
class SpawnActions {
 public:
  SpawnActions() { check(posix_spawn_file_actions_init(&actions_)); }
  ~SpawnActions() { posix_spawn_file_actions_destroy(&actions_); }
  SpawnActions(const SpawnActions&) = delete;
  SpawnActions& operator=(const SpawnActions&) = delete;

  /// Has it find the file that is open here as `here` as `there`.
  void connect(int here, int there) { check(posix_spawn_file_actions_adddup2(&actions_, here, there)); }
  /// Has it open a file for reading.
  void open(const char* path, int there, int flags) {
    check(posix_spawn_file_actions_addopen(&actions_, there, path, flags, 0));
  }
  const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  static void check(int code) {
    if (code != 0) throw_system_error(code, "a child process");
  }

  posix_spawn_file_actions_t actions_{};
};

/// Returns pointers to texts, which have to outlive them, and the null behind them that programs look for.
inline std::vector<char*> spawn_words(std::vector<std::string>& texts) {
  std::vector<char*> words;
  for (std::string& text : texts) words.push_back(text.data());
  words.push_back(nullptr);
  return words;
}

}  // namespace crossgait
