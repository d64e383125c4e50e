#include "physics/core/table.h"

#include <gtest/gtest.h>

namespace crossgait {
namespace {

TEST(Counted, IsOneOfAThingAndSeveralThings) {
  EXPECT_EQ(counted(0, "episode"), "0 episodes");
  EXPECT_EQ(counted(1, "episode"), "1 episode");
  EXPECT_EQ(counted(2, "episode"), "2 episodes");
}

TEST(Table, LinesUpWordsAtTheLeftAndNumbersAtTheRight) {
  Table table({"what", "mm", "word"});
  table.add_row({"first", "+1.5", "a"});
  table.add_row({"the second", "-12.25", "longer"});
  table.add_row({"3rd", ".5", "-"});  // the first column is words whatever it holds
  EXPECT_EQ(table.str(),
            "what            mm    word\n"
            "--------------------------\n"
            "first         +1.5       a\n"
            "the second  -12.25  longer\n"
            "3rd             .5       -\n");
}

TEST(Table, WithoutNumbersIsLeftAlignedAndEndsItsLinesAtTheirText) {
  Table table({"what", "word"});
  table.add_row({"a", "longer"});
  table.add_row({"b", "x"});
  table.add_row({"c", ""});
  EXPECT_EQ(table.str(),
            "what  word\n"
            "------------\n"
            "a     longer\n"
            "b     x\n"
            "c\n");
}

TEST(Table, FillsShortRowsAndMayHaveNone) {
  Table table({"a", "b", "c"});
  EXPECT_EQ(table.str(), "a  b  c\n-------\n");
  table.add_row({"x"});
  table.add_row({});
  EXPECT_EQ(table.str(), "a  b  c\n-------\nx\n\n");
}

TEST(Table, CountsCharactersNotBytes) {
  Table table({"unit", "value"});
  table.add_row({"µm", "1"});  // three bytes
  table.add_row({"Ω", "10"});
  EXPECT_EQ(table.str(),
            "unit  value\n"
            "-----------\n"
            "µm        1\n"
            "Ω        10\n");
}

}  // namespace
}  // namespace crossgait
