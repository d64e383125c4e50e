#include "physics/core/atomic_file.h"

#include <climits>
#include <csignal>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "physics/core/interruption.h"
#include "physics/core/locked_file.h"
#include "physics/core/progress.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"

namespace crossgait {
namespace {

class AtomicFile : public ScratchFolder {
 protected:
  std::ptrdiff_t entries() const {
    return std::distance(std::filesystem::directory_iterator(folder_), std::filesystem::directory_iterator());
  }
};

TEST_F(AtomicFile, WritesEveryByte) {
  std::string bytes("a\0b\r\n\xff", 6);
  bytes.append(1000000, 'x');
  write_file_atomically(path("file"), bytes);
  EXPECT_EQ(read(path("file")), bytes);
  EXPECT_EQ(entries(), 1) << "the temporary is gone";
}

TEST_F(AtomicFile, ReplacesTheOldFileByANewOne) {
  write("file", "old and longer");
  std::filesystem::create_hard_link(path("file"), path("link"));
  write_file_atomically(path("file"), "new");
  EXPECT_EQ(read(path("file")), "new");
  EXPECT_EQ(read(path("link")), "old and longer") << "whoever reads the old file keeps it whole";
}

TEST_F(AtomicFile, HonoursTheUmask) {
  const mode_t old = ::umask(027);
  write_file_atomically(path("file"), "");
  ::umask(old);
  EXPECT_EQ(std::filesystem::status(path("file")).permissions(), static_cast<std::filesystem::perms>(0640));
}

TEST_F(AtomicFile, IsReadByAsManyAsWhatItReplaces) {
  write_file_atomically(path("file"), "old");
  std::filesystem::permissions(path("file"), static_cast<std::filesystem::perms>(0600));
  write_file_atomically(path("file"), "new");
  EXPECT_EQ(std::filesystem::status(path("file")).permissions(), static_cast<std::filesystem::perms>(0600));
  if (::geteuid() == 0) return;  // who may write everything
  std::filesystem::permissions(path("file"), static_cast<std::filesystem::perms>(0400));
  EXPECT_EQ(config_error([&] { write_file_atomically(path("file"), "x"); }).found(), "Permission denied");
}

TEST_F(AtomicFile, SaysWhereItCannotWrite) {
  const std::string file = path("no-such-folder/file");
  EXPECT_EQ(std::string(config_error([&] { write_file_atomically(file, "x"); }).what()),
            file + ": output file: expected a place that can be written, found No such file or directory");
  EXPECT_EQ(config_error([&] { write_file_atomically(folder_.string(), "x"); }).found(), "Is a directory");
  EXPECT_EQ(entries(), 0);
}

TEST_F(AtomicFile, SaysWhenTheDiskIsFull) {
  // Through a link of its own, so that a writer which replaces what it should not replaces only the link.
  std::filesystem::create_symlink("/dev/full", path("full"));
  EXPECT_EQ(config_error([&] { write_file_atomically(path("full"), "x"); }).found(),
            "No space left on device");
}

TEST_F(AtomicFile, KeepsTheOldFileWhenTheNewOneDoesNotFit) {
  write("file", "old");
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit small{100, before.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const ConfigError error =
      config_error([&] { write_file_atomically(path("file"), std::string(1000, 'x')); });
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(error.found(), "File too large");
  EXPECT_EQ(read(path("file")), "old");
  EXPECT_EQ(entries(), 1) << "the temporary is gone";
}

TEST_F(AtomicFile, WritesIntoPipesInsteadOfReplacingThem) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  const int reader = ::open(path("pipe").c_str(), O_RDONLY | O_NONBLOCK);
  write_file_atomically(path("pipe"), "through");
  std::array<char, 20> bytes{};
  EXPECT_EQ(::read(reader, bytes.data(), bytes.size()), 7);
  ::close(reader);
  EXPECT_STREQ(bytes.data(), "through");
  EXPECT_TRUE(std::filesystem::is_fifo(path("pipe")));
}

TEST_F(AtomicFile, WritesIntoPipesWithoutAName) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  write_file_atomically("/proc/self/fd/" + std::to_string(ends[1]), "through");
  std::array<char, 20> bytes{};
  EXPECT_EQ(::read(ends[0], bytes.data(), bytes.size()), 7);
  EXPECT_STREQ(bytes.data(), "through");
  for (const int end : ends) ::close(end);
}

// A signal that has a handler ends no call of the system's by itself.
TEST_F(AtomicFile, WaitsForTheReaderOfAPipeUntilASignalSaysNo) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  std::thread reader([this] { EXPECT_EQ(read(path("pipe")), "through"); });
  write_file_atomically(path("pipe"), "through");
  reader.join();
  interruption_is_asked = true;
  EXPECT_THROW(write_file_atomically(path("pipe"), "x"), Interrupted) << "nobody reads";
  const int idle = ::open(path("pipe").c_str(), O_RDONLY | O_NONBLOCK);
  EXPECT_THROW(write_file_atomically(path("pipe"), std::string(1 << 20, 'x')), Interrupted) << "it is full";
  ::close(idle);
  interruption_is_asked = false;
}

TEST_F(AtomicFile, ReplacesNoFileThatSomebodyIsWriting) {
  const std::string us = "one that process " + std::to_string(::getpid()) + " is writing";
  crossgait::AtomicFile output(path("store"));
  output.write("page");
  LockedFile store(path("store"));
  store.append("row");
  for (const auto& write :
       {std::function([&] { write_file_atomically(path("store"), "page"); }),
        std::function([&] { check_writable(path("store")); }), std::function([&] { output.commit(); })}) {
    const ConfigError error = config_error(write);
    EXPECT_EQ(error.expected(), "a file that nobody is writing");
    EXPECT_EQ(error.found(), us);
  }
  store.append("s");
  EXPECT_EQ(read(path("store")), "rows");
}

// The system's lock is of the open file, which a fork has as well.
TEST_F(AtomicFile, AStoreThatIsClosedIsFreeThoughAForkOfItsProcessLives) {
  pid_t fork_of_it = -1;
  {
    LockedFile store(path("store"));
    store.append("row");
    fork_of_it = ::fork();
    if (fork_of_it == 0) {
      ::pause();
      ::_exit(0);
    }
    ASSERT_GT(fork_of_it, 0);
    EXPECT_THROW(LockedFile(path("store")), ConfigError) << "it is being written";
  }
  EXPECT_NO_THROW(LockedFile(path("store")).append("s"));
  ::kill(fork_of_it, SIGKILL);
  ::waitpid(fork_of_it, nullptr, 0);
  EXPECT_EQ(read(path("store")), "rows");
}

TEST_F(AtomicFile, WritesWhatALinkLeadsTo) {
  std::filesystem::create_directory(path("folder"));
  write("folder/file", "old");
  std::filesystem::create_symlink("folder/file", path("link"));
  std::filesystem::create_symlink(path("link"), path("link to link"));
  std::filesystem::create_symlink("folder/new", path("link to nothing"));
  write_file_atomically(path("link to link"), "new");
  EXPECT_EQ(read(path("folder/file")), "new");
  EXPECT_TRUE(std::filesystem::is_symlink(path("link to link")));
  EXPECT_TRUE(std::filesystem::is_symlink(path("link")));
  write_file_atomically(path("link to nothing"), "first");
  EXPECT_EQ(read(path("folder/new")), "first");
  std::filesystem::create_symlink("circle", path("circle"));
  EXPECT_EQ(config_error([&] { write_file_atomically(path("circle"), ""); }).found(), "a circle of links");
}

TEST_F(AtomicFile, HasTheLongestNameThatThereIs) {
  for (const std::size_t length : {std::size_t{240}, std::size_t{241}, std::size_t{NAME_MAX}}) {
    const std::string file = path(std::string(length, 'n'));
    write_file_atomically(file, "x");
    EXPECT_EQ(read(file), "x") << length;
  }
  EXPECT_EQ(config_error([&] { write_file_atomically(path(std::string(NAME_MAX + 1, 'n')), "x"); }).found(),
            "File name too long");
  EXPECT_EQ(config_error([] { write_file_atomically("", "x"); }).element(), "name");
}

TEST_F(AtomicFile, RemovesWhatAKilledWriterLeft) {
  const pid_t child = ::fork();
  if (child == 0) {
    crossgait::AtomicFile file(path("file"));
    file.write(std::string(200000, 'x'));
    ::_exit(0);  // as if killed: nothing is cleaned up
  }
  ::waitpid(child, nullptr, 0);
  ASSERT_EQ(entries(), 1);
  const std::string left = std::filesystem::directory_iterator(folder_)->path().string();
  EXPECT_TRUE(left.ends_with(".tmp")) << left;
  const std::vector<std::string> others{"file.12-3.tmp", "x.crossgait-.tmp", "x.crossgait-1-2.tmp.old",
                                        "crossgait"};
  for (const std::string& other : others) write(other, "somebody's");
  crossgait::AtomicFile live(path("another"));
  write_file_atomically(path("file"), "new");
  EXPECT_FALSE(std::filesystem::exists(left));
  for (const std::string& other : others) EXPECT_EQ(read(path(other)), "somebody's") << other;
  live.write("whole");
  live.commit();
  EXPECT_EQ(read(path("another")), "whole") << "who still writes keeps its temporary";
}

/// Whose temporaries are folders.
TEST_F(AtomicFile, RemovesWhatAKilledWriterOfPythonLeft) {
  const auto make = [&](const std::string& name) {
    std::filesystem::create_directory(path(name));
    write(name + "/file", "half");
  };
  for (const char* name :
       {".crossgait-a1_b.tmp", ".crossgait-held.tmp", ".crossgait-.tmp", "crossgait-x.tmp"})
    make(name);
  std::filesystem::create_directory(path(".crossgait-new.tmp"));  // and about to be locked
  const int held = ::open(path(".crossgait-held.tmp").c_str(), O_RDONLY | O_DIRECTORY);
  ASSERT_EQ(::flock(held, LOCK_EX | LOCK_NB), 0);
  write_file_atomically(path("file"), "new");
  ::close(held);
  EXPECT_FALSE(std::filesystem::exists(path(".crossgait-a1_b.tmp")));
  EXPECT_TRUE(std::filesystem::exists(path(".crossgait-held.tmp/file"))) << "whose writer lives";
  EXPECT_TRUE(std::filesystem::exists(path(".crossgait-new.tmp")));
  EXPECT_TRUE(std::filesystem::exists(path(".crossgait-.tmp/file")));
  EXPECT_TRUE(std::filesystem::exists(path("crossgait-x.tmp/file")));
}

TEST_F(AtomicFile, WritersOfOneFileDoNotMix) {
  std::vector<std::thread> writers;
  for (char letter = 'a'; letter < 'e'; ++letter) {
    writers.emplace_back([this, letter] {
      for (int i = 0; i < 20; ++i) write_file_atomically(path("file"), std::string(10000, letter));
    });
  }
  for (std::thread& writer : writers) writer.join();
  const std::string bytes = read(path("file"));
  EXPECT_EQ(bytes, std::string(10000, bytes[0]));
  EXPECT_EQ(entries(), 1);
}

class GrowingFile : public ScratchFolder {
 protected:
  bool is_empty() const { return std::filesystem::is_empty(folder_); }
};

TEST_F(GrowingFile, AppearsWholeOrNotAtAll) {
  write("file", "old");
  {
    crossgait::AtomicFile file(path("file"));
    file.write("a");
    file.write(std::string(200000, 'b'));
    EXPECT_EQ(read(path("file")), "old");
  }
  EXPECT_EQ(read(path("file")), "old") << "never committed";
  std::filesystem::remove(path("file"));
  EXPECT_TRUE(is_empty());
  crossgait::AtomicFile file(path("file"));
  file.write("a");
  file.write(std::string(200000, 'b'));
  file.commit();
  EXPECT_EQ(read(path("file")), "a" + std::string(200000, 'b'));
}

TEST_F(GrowingFile, IsTriedWithoutATrace) {
  check_writable(path("file"));
  check_writable("/dev/null");
  EXPECT_TRUE(is_empty());
  write("file", "old");
  check_writable(path("file"));
  EXPECT_EQ(read(path("file")), "old");
  const ConfigError error = config_error([&] { check_writable(path("no/such/folder")); });
  EXPECT_EQ(error.source(), path("no/such/folder"));
  EXPECT_EQ(error.found(), "No such file or directory");
  EXPECT_EQ(config_error([&] { check_writable(folder_); }).found(), "Is a directory");
}

}  // namespace
}  // namespace crossgait
