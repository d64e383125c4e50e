#include "physics/core/input_guard.h"

#include <thread>

#include "physics/core/atomic_file.h"
#include "physics/core/error.h"
#include "physics/core/text.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"

namespace crossgait {
namespace {

namespace fs = std::filesystem;

class InputGuards : public ScratchFolder {
 protected:
  std::string expected_of_writing(const std::string& file) const {
    return config_error([&] { write_file_atomically(file, "page"); }).expected();
  }
};

TEST_F(InputGuards, WhatWasReadIsNotWrittenByAnyName) {
  const std::string file = write("network", "numbers");
  fs::create_symlink(file, path("link"));
  fs::create_hard_link(file, path("hard"));
  const InputGuard guard;
  write_file_atomically(path("other"), "page");
  read_text_file(file, kYamlBudget);
  for (const char* name : {"network", "link", "hard"})
    EXPECT_EQ(expected_of_writing(path(name)), "a file that is not read") << name;
  EXPECT_EQ(read(file), "numbers");
  write_file_atomically(path("other"), "page");
}

TEST_F(InputGuards, OfWhatIsReadWhileItIsWrittenNothingIsPutInPlace) {
  const std::string file = write("network", "numbers");
  const InputGuard guard;
  crossgait::AtomicFile output(file);  // not the tests of it
  output.write("page");
  std::thread([&] { read_text_file(file, kYamlBudget); }).join();  // whichever thread it is
  EXPECT_EQ(config_error([&] { output.commit(); }).expected(), "a file that is not read");
  EXPECT_EQ(read(file), "numbers");
}

TEST_F(InputGuards, AFileThatWasMovedAwayKeepsItsPlace) {
  const std::string file = write("network", "numbers");
  const InputGuard guard;
  read_text_file(file, kYamlBudget);
  fs::rename(file, path("moved"));
  EXPECT_EQ(expected_of_writing(file), "a file that is not read");
  write(std::string("network"), "others");
  EXPECT_EQ(expected_of_writing(file), "a file that is not read");
}

TEST_F(InputGuards, AnOutputIsRefusedWhenItIsRead) {
  const std::string file = write("network", "numbers");
  const InputGuard guard({{"--json", path("page")}, {"--report", file}});
  const ConfigError error = config_error([&] { read_text_file(path("./network"), kYamlBudget); });
  EXPECT_EQ(error.element(), "--report");
  EXPECT_EQ(error.found(), "\"" + path("./network") + "\", which is read");
}

TEST_F(InputGuards, WithoutOneAFileIsReadAndWritten) {
  const std::string file = write("map", "0,0");
  { const InputGuard guard; }
  read_text_file(file, kYamlBudget);
  write_file_atomically(file, "0,1");
  EXPECT_EQ(read(file), "0,1");
}

}  // namespace
}  // namespace crossgait
