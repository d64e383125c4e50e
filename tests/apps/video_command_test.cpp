// `crossgait video`: that it hands traces to the package that draws, and says what is missing. What is drawn
// is the package's to test (python/tests/test_video.py).
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

#include "tests/apps/run_program.h"

namespace crossgait {
namespace {

class Video : public ::testing::Test {
 protected:
  void TearDown() override { unsetenv("CROSSGAIT_PYTHON"); }

  /// Names a file of this test alone: others run at the same time, in the same folder.
  static std::string file(const std::string& name) {
    return std::string("video_") + ::testing::UnitTest::GetInstance()->current_test_info()->name() + "_" +
           name;
  }

  /// Instead of an interpreter: keeps what it was told, and ends with `code`.
  static void draw_with(int code) {
    const std::string python = file("python.sh");
    write_file(python, "#!/bin/sh\n[ $# = 2 ] && exit 0\nprintf '%s\\n' \"$@\" >" + file("told.txt") +
                           "\nfor last; do :; done\nhead -n 1 \"$last\" >" + file("head.txt") +
                           "\necho drawn\nexit " + std::to_string(code) + "\n");
    std::filesystem::permissions(python, std::filesystem::perms::owner_all);
    setenv("CROSSGAIT_PYTHON", ("./" + python).c_str(), 1);
  }
};

TEST_F(Video, WalksAndHandsOverTheTraces) {
  draw_with(0);
  const ProgramResult result =
      run_program("video video_out.mp4 --seconds .1 --terrain rough --seed 3 --slow 2");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, "drawn\n");
  const std::string told = read_file(file("told.txt"));
  for (const char* word :
       {"\ncrossgait.traces.video\n", "--out=video_out.mp4\n", "--terrain=rough\n", "--seed=3\n",
        "--slow=2\n", "--fps=30\n", "--robot=scara_quadruped\n", "--outcome=walked@0.1\n"})
    EXPECT_NE(told.find(word), std::string::npos) << told;
  EXPECT_EQ(read_file(file("head.txt")).substr(0, 5), "time,");
  const std::string trace = told.substr(told.rfind('/', told.rfind('\n') - 1) + 1);
  EXPECT_TRUE(trace.ends_with(".csv\n")) << trace;
  const std::size_t begin = told.find("\n--\n") + 4;
  EXPECT_FALSE(std::filesystem::exists(told.substr(begin, told.size() - begin - 1))) << "the trace is gone";
}

TEST_F(Video, EndsAsItsPainterDoes) {
  write_file("video_trace.csv", "time\n0\n");
  draw_with(2);
  EXPECT_EQ(run_program("video video_out.mp4 video_trace.csv").exit_code, 2);
  draw_with(1);
  EXPECT_EQ(run_program("video video_out.mp4 video_trace.csv").exit_code, 1);
}

TEST_F(Video, SaysWhatIsMissing) {
  setenv("CROSSGAIT_PYTHON", "./no_such_python", 1);
  expect_bad_input("video video_out.mp4 --seconds .1", {"crossgait[video]", "no_such_python"});
  setenv("CROSSGAIT_PYTHON", "false", 1);
  expect_bad_input("video video_out.mp4 --seconds .1", {"crossgait[video]", "false"});
  EXPECT_FALSE(std::filesystem::exists("video_out.mp4"));
}

}  // namespace
}  // namespace crossgait
