#include "tests/layering/words.h"

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace crossgait::layering {
namespace {

std::string words_md() {
  std::ifstream stream(std::string(CROSSGAIT_SOURCE_DIR) + "/docs/words.md");
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(Words, RetiredOnesAreNowhereInTheTree) {
  const std::vector<std::string> words = retired_words(words_md());
  ASSERT_GT(words.size(), 30U);  // as many as when this was written: the table is read to its end
  const WordReport report = find_words(CROSSGAIT_SOURCE_DIR, words);
  for (const std::string& found : report.found)
    ADD_FAILURE() << found << " (docs/words.md says what it is now)";
  EXPECT_GT(report.files, 900);  // 1000 and more when this was written
}

TEST(Words, AreThoseOfTheFirstColumn) {
  const std::vector<std::string> expected{"old_name", "--old", "two words"};
  EXPECT_EQ(retired_words("| `no` | x |\n## Retired words\n\n| retired | now |\n|---|---|\n"
                          "| `old_name`, `--old` | `new_name` |\n| `two words` | `one` |"),
            expected);
  EXPECT_TRUE(retired_words("| `no` | x |\n").empty());
}

TEST(Numbers, HaveAZeroBeforeTheirPoint) {
  const WordReport report = find_bare_decimals(CROSSGAIT_SOURCE_DIR);
  for (const std::string& found : report.found) ADD_FAILURE() << found << ": 0.83 s, not .83 s";
  EXPECT_GT(report.files, 200);
}

TEST(Numbers, AreLookedForInProseAlone) {
  EXPECT_EQ(bare_decimals("a\nof .5 s\n(.25)\n", true), (std::vector{2, 3}));
  EXPECT_TRUE(bare_decimals("0.5 s, `--dt .5` and \".5\"\n```\n --dt .5\n```\n    x .5\n", true).empty());
  EXPECT_EQ(bare_decimals("double a = .5;\n/// of .5 s\nb; // x (.25)\n", false), (std::vector{2, 3}));
}

TEST(Comments, BeginWithNoFragment) {
  const WordReport report = find_verbless_comments(CROSSGAIT_SOURCE_DIR);
  for (const std::string& found : report.found)
    ADD_FAILURE() << found << R"(: "Returns the mass of a robot.", not "Of a robot.")";
  EXPECT_GT(report.files, 200);
}

TEST(Comments, AreLookedAtBeforeFunctionsAndClassesAlone) {
  EXPECT_EQ(verbless_comments("/// Of a robot.\ndouble mass(int body) const;\n"), (std::vector{1}));
  EXPECT_EQ(verbless_comments("\n  /// What it did,\n  /// and how.\n  template <int n>\n  struct A {\n"),
            (std::vector{2}));
  EXPECT_EQ(verbless_comments("/// Whether.\n[[nodiscard]] bool\nis_valid(double a = 1);"), (std::vector{1}));
  EXPECT_EQ(verbless_comments("/// In place.\n  enum class Kind {\n"), (std::vector{1}));
  EXPECT_TRUE(verbless_comments("/// Says what f() did.\n/// Of it.\nvoid f();\n").empty());
  EXPECT_TRUE(verbless_comments("/// What f() took.\ndouble a = f();  ///< s\n").empty());
  EXPECT_TRUE(verbless_comments("/// What it does.\nstd::function<void(int)> f;\n").empty());
  EXPECT_TRUE(verbless_comments("/// Whether it can.\nbool (*can)(int) = nullptr;\n").empty());
  EXPECT_TRUE(verbless_comments("/// As here.\nkA,  ///< f()\nkB,\n};\n").empty());
  EXPECT_TRUE(verbless_comments("/// All throw.\n\nvoid f();\n").empty());
}

TEST(Words, AreFoundOnTheirOwn) {
  EXPECT_EQ(line_of_word("a\nb = old_name;\n", "old_name"), 2);
  EXPECT_EQ(line_of_word("old_name", "old_name"), 1);
  EXPECT_EQ(line_of_word("very_old_name old_names Old_name", "old_name"), 0);
  EXPECT_EQ(line_of_word("very_old_name\nold_name", "old_name"), 2);  // goes on behind one that is none
  EXPECT_EQ(line_of_word("x --old", "--old"), 1);
  EXPECT_EQ(line_of_word("x--older", "--old"), 0);
}

}  // namespace
}  // namespace crossgait::layering
