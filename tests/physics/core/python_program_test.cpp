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

}  // namespace
}  // namespace crossgait
