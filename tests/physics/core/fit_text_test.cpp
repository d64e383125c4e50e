// Text in the width of a terminal.
#include "physics/core/fit_text.h"

#include <sstream>

#include <gtest/gtest.h>

#include "physics/core/table.h"

namespace crossgait {
namespace {

std::size_t widest_line(const std::string& text) {
  std::istringstream lines(text);
  std::size_t widest = 0;
  for (std::string line; std::getline(lines, line);) widest = std::max(widest, line.size());
  return widest;
}

TEST(FitText, LeavesWhatFits) {
  Table table({"name", "distance, m", "word"});
  table.add_row({"one", "1.25", "agrees"});
  const std::string text = "A sentence.\n\n" + table.str() + "\n  a  list\n";
  EXPECT_EQ(fit_text(text, 40), text);
  EXPECT_EQ(fit_text("", 40), "");
  EXPECT_EQ(fit_text("no end", 40), "no end");
}

TEST(FitText, WrapsProseBetweenWords) {
  EXPECT_EQ(fit_text("one two three four five six seven\n", 20), "one two three four\nfive six seven\n");
  EXPECT_EQ(fit_text("a " + std::string(30, 'x') + " b\n", 20), "a\n" + std::string(30, 'x') + "\nb\n");
}

TEST(FitText, HangsWhatIsExplainedBelowItsExplanation) {
  EXPECT_EQ(fit_text("  --seconds N   how long it walks, in simulated time\n", 32),
            "  --seconds N   how long it\n"
            "                walks, in\n"
            "                simulated time\n");
}

TEST(FitText, WrapsTheLastColumnOfATableWhereItIsWords) {
  Table table({"name", "contact", "what it is"});
  table.add_row({"mujoco", "soft", "elliptic cones, solved by Newton's method"});
  table.add_row({"bullet", "hard", "projected Gauss-Seidel"});
  EXPECT_EQ(fit_text(table.str(), 36),
            "name    contact  what it is\n"
            "------------------------------------\n"
            "mujoco  soft     elliptic cones,\n"
            "                 solved by Newton's\n"
            "                 method\n"
            "bullet  hard     projected\n"
            "                 Gauss-Seidel\n");
}

TEST(FitText, PutsColumnsThatDoNotFitBelowAndLosesNone) {
  Table table({"trot", "first", "second", "third"});
  table.add_row({"distance, m", "1.0000", "2.0000", "3.0000"});
  table.add_row({"speed, m/s", "0.1000", "0.2000", "0.3000"});
  EXPECT_EQ(fit_text(table.str(), 30),
            "trot          first  second\n"
            "---------------------------\n"
            "distance, m  1.0000  2.0000\n"
            "speed, m/s   0.1000  0.2000\n"
            "\n"
            "trot          third\n"
            "-------------------\n"
            "distance, m  3.0000\n"
            "speed, m/s   0.3000\n");
}

TEST(FitText, WrapsAColumnThatIsWiderThanTheTerminal) {
  Table table({"quantity", "used", "why"});
  table.add_row({"limits", "0.5", "targets are clipped to them, and engines keep the angle within them"});
  table.add_row({"step", "0.001", "--physics-dt"});
  EXPECT_LE(widest_line(fit_text(table.str(), 30)), 30U);
  EXPECT_NE(fit_text(table.str(), 24).find("\nstep      --physics-dt\n"), std::string::npos)
      << fit_text(table.str(), 24);
}

// A word that is longer than a line stands on one of its own, with nothing beside it that would be cut.
TEST(FitText, PutsAWordThatIsTooLongBelowItsRow) {
  const std::string path = "/home/somebody/" + std::string(30, 'x') + "/engine.so";
  Table table({"name", "plug-in"});
  table.add_row({"mujoco", path});
  table.add_row({"none", "-"});
  EXPECT_EQ(fit_text(table.str(), 40),
            "name\n"
            "  plug-in\n" +
                std::string(40, '-') + "\nmujoco\n  " + path + "\nnone\n  -\n");
}

TEST(FitText, CountsCharactersAndNoBytes) {
  const std::string line =
      "\u00b1\u00b1\u00b1\u00b1\u00b1\u00b1\u00b1\u00b1\u00b1\u00b1 "
      "\u00b1\u00b1\u00b1\u00b1\u00b1\u00b1\u00b1\u00b1\u00b1\n";
  EXPECT_EQ(fit_text(line, 20), line);  // 20 characters, 39 bytes
  Table table({"\u00e4\u00e4\u00e4\u00e4\u00e4\u00e4\u00e4\u00e4\u00e4\u00e4", "first", "second"});
  table.add_row({"x", "1", "2"});
  EXPECT_NE(fit_text(table.str(), 20).find("\n\n"), std::string::npos) << "the last column stands below";
}

TEST(FitText, FitsTablesOfEveryShape) {
  for (std::size_t columns = 2; columns < 12; ++columns) {
    Table table(std::vector<std::string>(columns, "heading"));
    table.add_row(std::vector<std::string>(columns, "-0.12345"));
    for (const std::size_t width : {20, 40, 80}) EXPECT_LE(widest_line(fit_text(table.str(), width)), width);
  }
}

}  // namespace
}  // namespace crossgait
