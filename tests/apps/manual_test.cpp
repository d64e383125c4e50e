// The manual: a page for every command, of what its help says, as `man` takes it.
#include <cstdio>
#include <filesystem>
#include <regex>
#include <set>

#include <gtest/gtest.h>

#include "tests/apps/run_program.h"

namespace crossgait {
namespace {

/// Finds what the only group of `expression` matches, everywhere in `text`.
std::set<std::string> all_of(const std::string& text, const std::string& expression) {
  const std::regex found(expression);
  std::set<std::string> all;
  for (std::sregex_iterator i(text.begin(), text.end(), found), end; i != end; ++i) all.insert((*i)[1]);
  return all;
}

/// Runs a shell's command. @returns what it printed
std::string output_of(const std::string& command, int& status) {
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  std::string text;
  for (int c = 0; (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
  status = pclose(pipe);
  return text;
}

TEST(Manual, HasAPageOfEveryCommandWithWhatItsHelpSays) {
  ASSERT_EQ(run_program("completion man --out manual/man1").exit_code, 0);
  const std::string all = read_file("manual/man1/crossgait.1");
  EXPECT_EQ(run_program("completion man").out, all);
  const std::set<std::string> commands = all_of(all, R"(\.BR crossgait\\-(\w+) \(1\))");
  EXPECT_GE(commands.size(), 24U);
  std::size_t pages = 0;
  for ([[maybe_unused]] const auto& page : std::filesystem::directory_iterator("manual/man1")) ++pages;
  EXPECT_EQ(pages, commands.size() + 1);
  for (const std::string& command : commands) {
    const std::string page = read_file("manual/man1/crossgait-" + command + ".1");
    const std::string name = ".SH NAME\ncrossgait\\-" + command + " \\- ";
    EXPECT_NE(page.find(name), std::string::npos) << command;
    // Each option of help as often as there, and no other.
    const std::string help = run_program(command + " --help").out;
    const std::regex minus(R"(\\-)");
    EXPECT_EQ(all_of(std::regex_replace(page, minus, "-"), R"(\.TP\n\\fB(?:-\w,)?(--[\w-]+))"),
              all_of(help, R"((?:^|\n)  (?:-\w, *)?(--[\w-]+))"))
        << command;
    EXPECT_EQ(help.find("\nExamples:\n") != std::string::npos,
              page.find(".SH EXAMPLES\n") != std::string::npos)
        << command;
  }
}

TEST(Manual, IsWhatTroffTakesWithoutAWarning) {
  int status = 0;
  output_of("command -v groff", status);
  if (status != 0) GTEST_SKIP() << "groff is not there (Debian: groff-base)";
  ASSERT_EQ(run_program("completion man --out manual/man1").exit_code, 0);
  const std::string said = output_of("groff -man -Tutf8 -K utf8 -ww -z manual/man1/*.1", status);
  EXPECT_EQ(status, 0) << said;
  EXPECT_EQ(said, "");
  const std::string shown =
      output_of("groff -man -Tascii -P-c -P-b -P-u -rLL=100n manual/man1/crossgait-walk.1", status);
  EXPECT_NE(shown.find("\n       crossgait walk --engine bullet --terrain rough --seed 3 --seconds 10\n"),
            std::string::npos)
      << shown;
  EXPECT_NE(shown.find("\nROBOT AND GROUND\n"), std::string::npos) << shown;
}

TEST(Manual, RefusesWhatIsNoPage) {
  expect_bad_input("completion man wlak", {"command", "walk", "wlak"});
  expect_bad_input("completion bash walk", {"command", "man", "bash"});
  expect_bad_input("completion fish --out manual", {"--out", "man", "fish"});
  expect_bad_input("completion man walk --out manual", {"--out", "command"});
  write_file("no_folder", "");
  expect_bad_input("completion man --out no_folder/man1", {"no_folder/man1"});
}

}  // namespace
}  // namespace crossgait
