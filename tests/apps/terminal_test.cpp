// The program on a terminal of 80x24 and 100x30: nothing is wider, and no line of progress is left.
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include "backends/registry.h"
#include "tests/apps/run_program.h"

namespace crossgait {
namespace {

struct Screen {
  int exit_code = -1;
  std::string bytes;  ///< as the terminal got them
  std::vector<std::string>
      lines;  ///< without colours; what a carriage return and a cleared line took away is gone
};

// What is seen of a line: of what carriage returns begin anew the last, of which `ESC [ K` clears the rest.
std::string seen(const std::string& line) {
  std::string shown;
  std::size_t at = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '\r') {
      at = 0;
    } else if (line[i] == '\033' && i + 1 < line.size() && line[i + 1] == '[') {
      const std::size_t end = line.find_first_of("Km", i);
      if (end == std::string::npos) break;
      if (line[end] == 'K') shown.resize(std::min(at, shown.size()));
      i = end;
    } else {
      if (at < shown.size()) {
        shown[at] = line[i];
      } else {
        shown += line[i];
      }
      ++at;
    }
  }
  return shown;
}

/// @param before  what the shell does first
Screen on_terminal(const std::string& arguments, unsigned short columns, unsigned short rows,
                   const std::string& before = "export TERM=xterm; unset NO_COLOR; ") {
  Screen screen;
  winsize size{rows, columns, 0, 0};
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, &size);
  if (child == 0) {
    const std::string command = before + "exec " + CROSSGAIT_PROGRAM + " " + arguments;
    execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  char buffer[4096];
  // The end of a terminal is an error to its reader.
  for (ssize_t count = 0; (count = read(terminal, buffer, sizeof buffer)) > 0;)
    screen.bytes.append(buffer, static_cast<std::size_t>(count));
  int status = 0;
  waitpid(child, &status, 0);
  close(terminal);
  screen.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  std::istringstream lines(screen.bytes);
  for (std::string line; std::getline(lines, line);) screen.lines.push_back(seen(line));
  return screen;
}

std::size_t characters(const std::string& line) {
  std::size_t count = 0;
  for (const char c : line) count += (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  return count;
}

TEST(Terminal, NothingIsWiderThanIt) {
  const std::string all = "compare --seconds .3 --settle .1";  // of every engine
  for (const std::string& arguments :
       {std::string("--help"), std::string("verdict --help"), std::string("engines"),
        std::string("gait --list"), std::string("gait --parameters"), std::string("terrain --list"),
        std::string("robots"), std::string("robots scara_quadruped"),
        std::string("walk --seconds .3 --settle .1"),
        available_engines().size() > 1 ? all : std::string("--version"),
        std::string("course --sections pushed,slope-20deg --episodes 1")}) {
    for (const auto& [columns, rows] : {std::pair<unsigned short, unsigned short>{80, 24}, {100, 30}}) {
      const Screen screen = on_terminal(arguments, columns, rows);
      EXPECT_EQ(screen.exit_code, 0) << arguments << "\n" << screen.bytes;
      for (const std::string& line : screen.lines) {
        // A word that is longer than a line stays whole.
        const std::size_t first = line.find_first_not_of(' ');
        const bool one_word = first == std::string::npos || line.find(' ', first) == std::string::npos;
        EXPECT_TRUE(characters(line) <= columns || one_word) << arguments << ", " << columns << ": " << line;
      }
    }
  }
}

TEST(Terminal, NoLineOfProgressIsLeft) {
  // Longer than the two seconds after which progress shows, on any machine.
  const Screen screen = on_terminal("verdict --seconds 1 --starts 24 --workers 1", 80, 24);
  ASSERT_EQ(screen.exit_code, 0) << screen.bytes;
  if (screen.bytes.find("s left") == std::string::npos) GTEST_SKIP() << "done before progress shows";
  for (const std::string& line : screen.lines) EXPECT_EQ(line.find("s left"), std::string::npos) << line;
}

TEST(Terminal, HasColoursUnlessTheyAreNotWanted) {
  const std::string verdict = "verdict --seconds .2 --settle .1 --starts 4";
  if (available_engines().size() > 1) {
    EXPECT_NE(on_terminal(verdict, 100, 30).bytes.find("\033[3"), std::string::npos);
    EXPECT_EQ(on_terminal(verdict, 100, 30, "export TERM=xterm NO_COLOR=1; ").bytes.find("\033[3"),
              std::string::npos);
  }
  EXPECT_NE(on_terminal("fly", 80, 24).bytes.find("\033[31mcrossgait:"), std::string::npos);
  EXPECT_EQ(on_terminal("fly", 80, 24, "export TERM=dumb; unset NO_COLOR; ").bytes.find('\033'),
            std::string::npos);
  EXPECT_EQ(run_program("fly").err.find('\033'), std::string::npos) << "no terminal";
}

TEST(Terminal, JsonIsNeverWrapped) {
  const Screen screen = on_terminal("walk --seconds .1 --settle .1 --json -", 40, 24);
  std::string text;
  for (const std::string& line : screen.lines) text += line + "\n";
  EXPECT_TRUE(nlohmann::json::accept(text)) << text;
}

}  // namespace
}  // namespace crossgait
