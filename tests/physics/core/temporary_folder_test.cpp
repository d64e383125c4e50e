#include "physics/core/temporary_folder.h"

#include <csignal>
#include <cstdlib>
#include <optional>

#include <sys/wait.h>
#include <unistd.h>

#include "physics/core/error.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"

namespace crossgait {
namespace {

namespace fs = std::filesystem;

/// A test's own place of temporary files.
class TemporaryFolders : public ScratchFolder {
 protected:
  void SetUp() override {
    ScratchFolder::SetUp();
    const char* const place = std::getenv("TMPDIR");
    if (place != nullptr) before_ = place;
    setenv("TMPDIR", folder_.c_str(), 1);
  }
  void TearDown() override {
    before_ ? setenv("TMPDIR", before_->c_str(), 1) : unsetenv("TMPDIR");
    ScratchFolder::TearDown();
  }
  std::size_t count() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  /// Leaves a folder as a program does that is killed.
  void leave_one() const {
    const pid_t child = ::fork();
    if (child == 0) {
      const TemporaryFolder folder("test");
      std::ofstream(folder.file("what.bin")) << "left";
      ::raise(SIGKILL);
    }
    ASSERT_EQ(::waitpid(child, nullptr, 0), child);
  }

  std::optional<std::string> before_;
};

TEST_F(TemporaryFolders, AreGoneAtTheirEnd) {
  {
    const TemporaryFolder folder("test");
    EXPECT_EQ(count(), 1U);
    EXPECT_TRUE(fs::path(folder.file("x"))
                    .parent_path()
                    .filename()
                    .string()
                    .starts_with("crossgait-" + std::to_string(::getpid()) + "-"));
  }
  EXPECT_EQ(count(), 0U);
}

TEST_F(TemporaryFolders, OfKilledProgramsAreRemovedByTheNext) {
  leave_one();
  leave_one();
  const TemporaryFolder folder("test");
  EXPECT_EQ(count(), 1U) << "its own alone";
}

TEST_F(TemporaryFolders, OfLivingProgramsStay) {
  const TemporaryFolder first("test"), second("test");
  std::ofstream(first.file("x")) << "mine";
  const TemporaryFolder third("test");
  EXPECT_EQ(count(), 3U);
  EXPECT_EQ(read(first.file("x")), "mine");
}

TEST_F(TemporaryFolders, NeedAPlaceThatIsThere) {
  setenv("TMPDIR", (folder_ / "gone").c_str(), 1);
  const ConfigError error = config_error([] { const TemporaryFolder folder("video"); });
  EXPECT_EQ(error.source(), "video");
  EXPECT_EQ(error.element(), "TMPDIR");
  EXPECT_EQ(error.found(), (folder_ / "gone").string());
}

TEST_F(TemporaryFolders, NothingElseIsRemovedAndNoLinkFollowed) {
  fs::create_directories(folder_ / "crossgait-mine");
  fs::create_directories(folder_ / "crossgait-12-abcdefg");
  fs::create_directories(folder_ / "crossgait--abcdef");
  fs::create_directories(folder_ / "kept");
  std::ofstream(folder_ / "kept" / "x") << "x";
  fs::create_directory_symlink(folder_ / "kept", folder_ / "crossgait-12-abcdef");
  fs::create_directories(folder_ / "crossgait-13-abcdef");
  fs::create_directory_symlink(folder_ / "kept", folder_ / "crossgait-13-abcdef" / "link");
  const TemporaryFolder folder("test");
  EXPECT_FALSE(fs::exists(folder_ / "crossgait-13-abcdef")) << "of no program";
  EXPECT_EQ(count(), 6U);
  EXPECT_TRUE(fs::exists(folder_ / "kept" / "x"));
}

}  // namespace
}  // namespace crossgait
