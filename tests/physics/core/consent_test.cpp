// Which files may run code, and what is said of it. Another user's file takes root to make: that case is
// skipped by others.
#include "physics/core/consent.h"

#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"

namespace crossgait {
namespace {

namespace fs = std::filesystem;

/// A folder `here`, which is the current one, and one beside it.
class Consent : public ScratchFolder {
 protected:
  void SetUp() override {
    ScratchFolder::SetUp();
    unsetenv(kTrustVariable);
    fs::create_directories(path("here/models"));
    fs::create_directories(path("here-too"));
    fs::current_path(path("here"));
    set_consent_notice([this](const std::string& sentence) { said_ += sentence + "\n"; });
  }
  void TearDown() override {
    unsetenv(kTrustVariable);
    fs::current_path(before_);
    ScratchFolder::TearDown();
  }

  std::string why_refused(const std::string& file) const {
    return config_error([&] { require_consent(path(file), "it is run"); }).found();
  }

  const fs::path before_ = fs::current_path();
  std::string said_;
};

TEST_F(Consent, IsThereForOnesOwnFilesBelowTheCurrentFolder) {
  const std::string file = write("here/models/a.xacro", "");
  require_consent(file, "it is run");
  require_consent("models/a.xacro", "it is run");
  EXPECT_EQ(said_, file + " runs code: it is run\nmodels/a.xacro runs code: it is run\n");
  require_consent(file, "it is run");
  EXPECT_EQ(said_.find(file, 1), std::string::npos) << "said once";
}

TEST_F(Consent, IsMissingElsewhere) {
  write("here-too/a.xacro", "");
  EXPECT_EQ(why_refused("here-too/a.xacro"), "a file outside the current folder");
  fs::create_symlink(path("here-too/a.xacro"), path("here/link.xacro"));
  EXPECT_EQ(why_refused("here/link.xacro"), "a file outside the current folder");
  for (const std::string folder : {".cache", "site-packages", "dist-packages"}) {
    fs::create_directories(path("here/" + folder + "/robots"));
    write("here/" + folder + "/robots/a.xacro", "");
    EXPECT_EQ(why_refused("here/" + folder + "/robots/a.xacro"),
              "a file in " + folder + ", which programs fill");
  }
  write("here/.hidden.xacro", "");
  EXPECT_NO_THROW(require_consent(path("here/.hidden.xacro"), "it is run"))
      << "a file of one's own, not a folder";
  EXPECT_EQ(config_error([&] { require_consent(path("here/none"), "it is run"); }).expected(),
            "a readable file");
}

TEST_F(Consent, IsMissingWhereEverythingIsBelowTheCurrentFolder) {
  write("here/a.xacro", "");
  fs::current_path("/");
  EXPECT_EQ(why_refused("here/a.xacro"), "a file anywhere, with / as the current folder");
}

TEST_F(Consent, IsOfTheWholeName) {
  const std::string other = path("here-too") + std::string("\0harmless", 9);
  EXPECT_EQ(config_error([&] { trust_folder(other, "test"); }).expected(), "a name without a byte of zero");
  EXPECT_EQ(trusted_folders(), "");
}

TEST_F(Consent, IsMissingForFilesOfOthers) {
  const std::string file = write("here/a.xacro", "");
  constexpr uid_t kNobody = 65534;
  if (chown(file.c_str(), kNobody, kNobody) != 0) GTEST_SKIP() << "only root can give files away";
  EXPECT_EQ(why_refused("here/a.xacro"), "another user's file");
}

TEST_F(Consent, IsGivenByFolder) {
  const std::string file = write("here-too/a.xacro", "");
  setenv(kTrustVariable, (path("here/models") + "::" + path("none")).c_str(), 1);
  EXPECT_EQ(why_refused("here-too/a.xacro"), "a file outside the current folder");
  trust_folder("../here-too", "command line");
  EXPECT_EQ(trusted_folders(),
            path("here/models") + "::" + path("none") + ":" + fs::canonical(path("here-too")).string());
  require_consent(file, "it is run");
  EXPECT_EQ(said_, file + " runs code: it is run\n");
}

TEST_F(Consent, IsGivenToFoldersAlone) {
  const std::string file = write("here/a", "");
  EXPECT_EQ(config_error([&] { trust_folder(file, "command line"); }).expected(), "a folder");
  EXPECT_EQ(config_error([&] { trust_folder(path("none"), "command line"); }).source(), "command line");
  fs::create_directories(path("a:b"));
  EXPECT_NE(config_error([&] { trust_folder(path("a:b"), "command line"); }).expected().find("without ':'"),
            std::string::npos);
}

TEST_F(Consent, SaysTheWordsOfConsent) {
  write("here-too/a.xacro", "");
  const ConfigError error = config_error([&] { require_consent(path("here-too/a.xacro"), "it is run"); });
  for (const std::string& word : {std::string("it is run"), std::string("--trust"),
                                  std::string(kTrustVariable), fs::canonical(path("here-too")).string()})
    EXPECT_NE(error.expected().find(word), std::string::npos) << error.what();
}

}  // namespace
}  // namespace crossgait
