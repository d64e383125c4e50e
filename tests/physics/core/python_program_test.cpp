#include "physics/core/python_program.h"

#include <filesystem>

#include <gtest/gtest.h>

#include "physics/core/child_process.h"
#include "tests/physics/core/scratch_folder.h"

namespace crossgait {
namespace {

class PythonProgram : public ScratchFolder {};

// Anybody may put a file into a folder as /tmp is.
TEST_F(PythonProgram, RunsNothingOfTheCurrentFolder) {
  const std::filesystem::path before = std::filesystem::current_path();
  for (const char* name : {"json.py", "runpy.py"}) write(name, "open('ran', 'w')\n");
  std::filesystem::current_path(folder_);
  const auto module = run_child(python_module_command("json.tool"));
  const auto import = run_child(python_import_command("json"));
  const auto missing = run_child(python_import_command("crossgait_no_such_module"));
  std::filesystem::current_path(before);
  ASSERT_TRUE(module && import && missing);
  EXPECT_NE(module->errors.find("Expecting value"), std::string::npos) << module->errors;
  EXPECT_EQ(import->exit_code, 0) << import->errors;
  EXPECT_NE(missing->exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(path("ran")));
}

// A file that serves may have modules beside it, but not in the place of packages.
TEST_F(PythonProgram, RunsAFileWithWhatIsBesideItLast) {
  write("json.py", "open('ran', 'w')\n");
  write("beside.py", "answer = 42\n");
  write("engine.py",
        "import sys, json, beside\nprint(beside.answer, __name__, sys.argv[1:], json.dumps([]))\n");
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder_);
  const auto ran = run_child(python_file_command("engine.py"));
  std::filesystem::current_path(before);
  ASSERT_TRUE(ran);
  EXPECT_EQ(ran->out, "42 __main__ [] []\n") << ran->errors;
  EXPECT_FALSE(std::filesystem::exists(path("ran")));
}

}  // namespace
}  // namespace crossgait
