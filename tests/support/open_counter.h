// Counts how often a folder's files are opened, by whatever program.
#pragma once

#include <array>
#include <map>
#include <string>

#include <gtest/gtest.h>
#include <sys/inotify.h>
#include <unistd.h>

namespace crossgait {

/// Watches a folder from its making on.
class OpenCounter {
 public:
  explicit OpenCounter(const std::string& folder) : watch_(::inotify_init1(IN_NONBLOCK)) {
    // The kernel merges equal events that follow each other: closing stands between two openings.
    EXPECT_GE(::inotify_add_watch(watch_, folder.c_str(), IN_OPEN | IN_CLOSE), 0) << folder;
  }
  ~OpenCounter() { ::close(watch_); }
  OpenCounter(const OpenCounter&) = delete;
  OpenCounter& operator=(const OpenCounter&) = delete;

  /// Returns how often each file has been opened since the last call.
  std::map<std::string, int> take() const {
    std::map<std::string, int> opened;
    alignas(inotify_event) std::array<char, 1 << 14> bytes{};
    for (ssize_t got = 0; (got = ::read(watch_, bytes.data(), bytes.size())) > 0;) {
      for (ssize_t at = 0; at < got;) {
        const auto* event = reinterpret_cast<const inotify_event*>(bytes.data() + at);
        if ((event->mask & IN_OPEN) != 0 && event->len > 0) ++opened[event->name];
        at += static_cast<ssize_t>(sizeof(inotify_event) + event->len);
      }
    }
    return opened;
  }

 private:
  int watch_;
};

}  // namespace crossgait
