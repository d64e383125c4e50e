// A library that is loaded in front of a program (LD_PRELOAD) and makes calls of the system fail, one at a
// time.
//
//     CROSSGAIT_FAULT=KIND:N[:ERRNO]  CROSSGAIT_FAULT_FOLDER=/folder  LD_PRELOAD=... crossgait ...
//
// KIND is what fails the N-th time: `open` (of a file to be written), `read` (opening to read), `write`,
// `fsync`, `rename`, `truncate`, `lock`, all of files in the folder alone; `thread` (pthread_create) or
// `memory` (malloc). `short`: the N-th write takes half. `full`: the disk has room for N more bytes. `kill`:
// the process is killed before the N-th of open, write, fsync and rename. `count` changes nothing; with
// CROSSGAIT_FAULT_COUNTS=FILE, how often each was called is written there at the end.
#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

extern "C" void* __libc_malloc(std::size_t size);  // NOLINT(bugprone-reserved-identifier)

namespace {

enum Kind {
  kOpen,
  kRead,
  kWrite,
  kFsync,
  kRename,
  kTruncate,
  kLock,
  kThread,
  kMemory,
  kShort,
  kFull,
  kKill,
  kKinds
};
constexpr std::array<const char*, kKinds> kNames{"open", "read",   "write",  "fsync", "rename", "truncate",
                                                 "lock", "thread", "memory", "short", "full",   "kill"};

struct Fault {
  int kind = -1;
  long when = 0;
  int error = EIO;
};
Fault fault;
std::array<std::atomic<long>, kKinds> counts;
std::array<char, PATH_MAX> folder{};
std::atomic<bool> ready{false};

template <typename Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

// Whether this call is the one that fails. Every kill counts the calls of several kinds.
bool fails(Kind kind) {
  if (!ready) return false;
  const long count = ++counts[kind];
  return fault.kind == kind && count == fault.when;
}
void kill_when_due() {
  if (ready && ++counts[kKill] == fault.when && fault.kind == kKill) ::kill(::getpid(), SIGKILL);
}
int failed() {
  errno = fault.error;
  return -1;
}

bool is_in_folder(const char* path) {
  const std::size_t size = std::strlen(folder.data());
  if (size == 0 || path == nullptr) return false;
  if (path[0] == '/') return std::strncmp(path, folder.data(), size) == 0;
  std::array<char, PATH_MAX> here{};
  return ::getcwd(here.data(), here.size()) != nullptr && std::strncmp(here.data(), folder.data(), size) == 0;
}
bool is_in_folder(int file) {
  std::array<char, 64> link{};
  std::array<char, PATH_MAX> path{};
  std::snprintf(link.data(), link.size(), "/proc/self/fd/%d", file);
  return ::readlink(link.data(), path.data(), path.size() - 1) > 0 && path[0] == '/' &&
         is_in_folder(path.data());
}

/// Of an opening: whether it fails.
bool opening_fails(const char* path, int flags) {
  if (!is_in_folder(path) || (flags & O_DIRECTORY) != 0) return false;
  const bool writes = (flags & O_ACCMODE) != O_RDONLY;
  if (writes) kill_when_due();
  return fails(writes ? kOpen : kRead);
}

/// How much of a write of `size` bytes is done; -1 if none, with errno.
ssize_t room_for(int file, std::size_t size) {
  if (!is_in_folder(file)) return static_cast<ssize_t>(size);
  kill_when_due();
  if (fails(kWrite)) return failed();
  if (fails(kShort) && size > 1) return static_cast<ssize_t>(size / 2);
  const long before = counts[kFull].fetch_add(static_cast<long>(size));
  if (fault.kind != kFull) return static_cast<ssize_t>(size);
  if (before >= fault.when) {
    errno = ENOSPC;
    return -1;
  }
  return std::min(static_cast<ssize_t>(size), static_cast<ssize_t>(fault.when - before));
}

__attribute__((constructor)) void begin() {
  if (const char* const text = std::getenv("CROSSGAIT_FAULT_FOLDER"))
    std::strncpy(folder.data(), text, folder.size() - 1);
  const char* const text = std::getenv("CROSSGAIT_FAULT");
  if (text == nullptr) return;
  for (int kind = 0; kind < kKinds; ++kind) {
    const std::size_t size = std::strlen(kNames[kind]);
    if (std::strncmp(text, kNames[kind], size) != 0 || text[size] != ':') continue;
    fault.kind = kind;
    char* rest = nullptr;
    fault.when = std::strtol(text + size + 1, &rest, 10);
    if (*rest == ':') fault.error = std::atoi(rest + 1);
  }
  ready = true;
}

__attribute__((destructor)) void end() {
  ready = false;
  const char* const file = std::getenv("CROSSGAIT_FAULT_COUNTS");
  if (file == nullptr) return;
  std::array<char, 1024> text{};
  int at = 0;
  for (int kind = 0; kind < kKinds; ++kind)
    at += std::snprintf(text.data() + at, text.size() - at, "%s %ld\n", kNames[kind], counts[kind].load());
  const int out = static_cast<int>(::syscall(SYS_openat, AT_FDCWD, file, O_WRONLY | O_CREAT | O_TRUNC, 0666));
  ::syscall(SYS_write, out, text.data(), at);
  ::syscall(SYS_close, out);
}

mode_t mode_of(int flags, va_list rest) {
  return (flags & (O_CREAT | O_TMPFILE)) != 0 ? static_cast<mode_t>(va_arg(rest, int)) : 0;
}

}  // namespace

// The C library calls them by names of its own.
// NOLINTBEGIN(readability-inconsistent-declaration-parameter-name)
extern "C" {

int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = mode_of(flags, rest);
  va_end(rest);
  if (opening_fails(path, flags)) return failed();
  return static_cast<int>(::syscall(SYS_openat, AT_FDCWD, path, flags, mode));
}
int open64(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = mode_of(flags, rest);
  va_end(rest);
  if (opening_fails(path, flags)) return failed();
  return static_cast<int>(::syscall(SYS_openat, AT_FDCWD, path, flags | O_LARGEFILE, mode));
}
ssize_t write(int file, const void* bytes, std::size_t size) {
  const ssize_t room = room_for(file, size);
  return room < 0 ? room : ::syscall(SYS_write, file, bytes, static_cast<std::size_t>(room));
}
int fsync(int file) {
  if (is_in_folder(file)) {
    kill_when_due();
    if (fails(kFsync)) return failed();
  }
  return static_cast<int>(::syscall(SYS_fsync, file));
}
int rename(const char* from, const char* to) {
  if (is_in_folder(to)) {
    kill_when_due();
    if (fails(kRename)) return failed();
  }
  return static_cast<int>(::syscall(SYS_rename, from, to));
}
int ftruncate(int file, off_t size) {
  if (is_in_folder(file) && fails(kTruncate)) return failed();
  return static_cast<int>(::syscall(SYS_ftruncate, file, size));
}
int ftruncate64(int file, off64_t size) { return ftruncate(file, size); }
int flock(int file, int operation) {
  if (is_in_folder(file) && fails(kLock)) return failed();
  return static_cast<int>(::syscall(SYS_flock, file, operation));
}
int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*start)(void*),
                   void* argument) {
  if (fails(kThread)) return EAGAIN;
  static const auto real = next<decltype(&pthread_create)>("pthread_create");
  return real(thread, attributes, start, argument);
}
void* malloc(std::size_t size) {
  if (fails(kMemory)) {
    errno = ENOMEM;
    return nullptr;
  }
  return __libc_malloc(size);
}
}
// NOLINTEND(readability-inconsistent-declaration-parameter-name)
