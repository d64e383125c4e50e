#include "physics/core/yaml_reader.h"

#include <functional>
#include <locale>

#include <gtest/gtest.h>

#include "tests/physics/core/config_error.h"
#include "tests/physics/robot_files/scratch_robot.h"

namespace crossgait {
namespace {

YamlValue parse(const std::string& text) { return YamlValue::parse(text, "test.yaml"); }

TEST(YamlReader, ReadsEveryKindOfValue) {
  const YamlValue root =
      parse("a: {x: 1.5e-3, n: -7, on: true, name: some text}\np: [1, +2.5, -.5]\nl: [{k: 1}]\n");
  EXPECT_EQ(root.at("a").at("x").number(), 1.5e-3);
  EXPECT_EQ(root.at("a").at("n").integer(), -7);
  EXPECT_TRUE(root.at("a").at("on").boolean());
  EXPECT_EQ(root.at("a").at("name").text(), "some text");
  EXPECT_EQ(root.at("p").vector3(), Vector3(1, 2.5, -0.5));
  EXPECT_EQ(root.at("l").items().at(0).at("k").integer(), 1);
  EXPECT_FALSE(root.find("q").has_value());
  const auto entries = root.entries();
  ASSERT_EQ(entries.size(), 3U);
  EXPECT_EQ(entries[2].first, "l");
  EXPECT_NO_THROW(root.allow_keys({"l", "p", "a"}));
}

TEST(YamlReader, ReadsADecimalPointInEveryLocale) {
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Comma));
  const double value = parse("x: 0.25").at("x").number();
  std::locale::global(before);
  EXPECT_EQ(value, 0.25);
}

struct BadYaml {
  const char* name;
  const char* text;
  std::function<void(const YamlValue&)> read;
  const char* message;
};

void PrintTo(const BadYaml& bad, std::ostream* stream) { *stream << bad.name; }

class YamlReaderError : public ::testing::TestWithParam<BadYaml> {};

TEST_P(YamlReaderError, NamesFileLineAndKey) {
  const ConfigError error = config_error([] { GetParam().read(parse(GetParam().text)); });
  EXPECT_STREQ(error.what(), GetParam().message);
}

const auto kNothing = [](const YamlValue&) {};

const BadYaml kBadYaml[] = {
    {"Syntax", "a: 1\nb: [1, 2\n", kNothing,
     "test.yaml: line 3: expected valid YAML, found end of sequence flow not found"},
    {"Empty", "", kNothing, "test.yaml: file: expected one YAML document, found 0"},
    {"TwoDocuments", "a: 1\n---\na: 2\n", kNothing, "test.yaml: file: expected one YAML document, found 2"},
    {"DuplicateKey", "a:\n  b: 1\n  b: 2\n", kNothing,
     "test.yaml: line 3, a.b: expected each key once, found a duplicate key"},
    {"DuplicateKeyInList", "a: [{b: 1, b: 2}]\n", kNothing,
     "test.yaml: line 1, a[0].b: expected each key once, found a duplicate key"},
    {"NameAsMapping", "a: 1\n[1, 2]: 3\n", kNothing,
     "test.yaml: top level: expected keys that are plain names, found a list of 2"},
    {"UnknownKey", "a: 1\nd: 2\n",
     [](const YamlValue& v) {
       v.allow_keys({"a", "b"});
     },
     "test.yaml: line 2, d: expected one of the keys a, b, found unknown key 'd'"},
    {"MissingKey", "a: {b: 1}\n", [](const YamlValue& v) { v.at("a").at("c"); },
     "test.yaml: line 1, a: expected key 'c', found none"},
    {"MappingWanted", "a: 1\n", [](const YamlValue& v) { v.at("a").at("c"); },
     "test.yaml: line 1, a: expected a mapping, found '1'"},
    {"SequenceWanted", "a: 1\n", [](const YamlValue& v) { v.at("a").items(); },
     "test.yaml: line 1, a: expected a list, found '1'"},
    {"NotANumber", "a: fast\n", [](const YamlValue& v) { v.at("a").number(); },
     "test.yaml: line 1, a: expected a finite number, found 'fast'"},
    {"TrailingText", "a: 1.5m\n", [](const YamlValue& v) { v.at("a").number(); },
     "test.yaml: line 1, a: expected a finite number, found '1.5m'"},
    {"CommaNumber", "a: '1,5'\n", [](const YamlValue& v) { v.at("a").number(); },
     "test.yaml: line 1, a: expected a finite number, found '1,5'"},
    {"NaN", "a: nan\n", [](const YamlValue& v) { v.at("a").number(); },
     "test.yaml: line 1, a: expected a finite number, found 'nan'"},
    {"YamlNaN", "a: .nan\n", [](const YamlValue& v) { v.at("a").number(); },
     "test.yaml: line 1, a: expected a finite number, found '.nan'"},
    {"Infinity", "a: -inf\n", [](const YamlValue& v) { v.at("a").number(); },
     "test.yaml: line 1, a: expected a finite number, found '-inf'"},
    {"Overflow", "a: 1e999\n", [](const YamlValue& v) { v.at("a").number(); },
     "test.yaml: line 1, a: expected a finite number, found '1e999'"},
    {"TwoSigns", "a: +-1\n", [](const YamlValue& v) { v.at("a").number(); },
     "test.yaml: line 1, a: expected a finite number, found '+-1'"},
    {"NoValue", "a:\n", [](const YamlValue& v) { v.at("a").number(); },
     "test.yaml: line 1, a: expected a finite number, found nothing"},
    {"NotAnInteger", "a: 1.5\n", [](const YamlValue& v) { v.at("a").integer(); },
     "test.yaml: line 1, a: expected an integer, found '1.5'"},
    {"NotABoolean", "a: yes\n", [](const YamlValue& v) { v.at("a").boolean(); },
     "test.yaml: line 1, a: expected true or false, found 'yes'"},
    {"NotText", "a: [x]\n", [](const YamlValue& v) { v.at("a").text(); },
     "test.yaml: line 1, a: expected text, found a list of 1"},
    {"WrongSize", "a: [1, 2]\n", [](const YamlValue& v) { v.at("a").vector3(); },
     "test.yaml: line 1, a: expected a list of 3 numbers, found a list of 2"},
    {"BadElement", "a: [1, 2, x]\n", [](const YamlValue& v) { v.at("a").vector3(); },
     "test.yaml: line 1, a[2]: expected a finite number, found 'x'"},
};
const auto kYamlCase = [](const auto& info) { return info.param.name; };
INSTANTIATE_TEST_SUITE_P(All, YamlReaderError, ::testing::ValuesIn(kBadYaml), kYamlCase);

TEST(YamlReader, RejectsAValueInsideItself) {
  const ConfigError error = config_error([] { parse("a: &x [*x, *x]\n"); });
  EXPECT_EQ(error.expected(), "at most 32 levels");
}

std::string repeated(std::string_view text, int count) {
  std::string result;
  for (int i = 0; i < count; ++i) result += text;
  return result;
}

// All of them by the parser's own events: it calls itself for every level.
TEST(YamlReader, RejectsWhatIsNoUtf8) {
  EXPECT_EQ(config_error([] { parse("a: 1\nb\xc7: {x: 2}\n"); }).what(),
            std::string("test.yaml: line 2: expected text in UTF-8, found the byte 0xc7"));
  for (const char* text : {"a: \xc0\xaf", "a: \xed\xa0\x80", "a: \xf5\x80\x80\x80", "a: \xe2\x82", "a: \x80"})
    EXPECT_EQ(config_error([&] { parse(text); }).expected(), "text in UTF-8") << text;
  EXPECT_NO_THROW(parse("a: gr\xc3\xbc\xc3\x9f\xf0\x9f\x90\x95"));
}

TEST(YamlReader, RejectsTooManyLevels) {
  for (const char* level : {"[", "{a: ", "- ", "? ", "[a: "}) {
    const ConfigError error = config_error([&] { parse(repeated(level, 100000)); });
    EXPECT_EQ(error.expected(), "at most 32 levels") << level;
    EXPECT_EQ(error.element(), "line 1") << level;
  }
  EXPECT_NO_THROW(parse(repeated("[", 32) + repeated("]", 32)));
  EXPECT_EQ(config_error([] { parse(repeated("[", 33) + repeated("]", 33)); }).expected(),
            "at most 32 levels");
}

TEST(YamlReader, CountsAliasesAsWhatTheyStandFor) {
  std::string bomb = "a0: &a0 [x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 12; ++i) {
    const std::string before = "*a" + std::to_string(i - 1);
    bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + before;
    for (int k = 0; k < 8; ++k) bomb += ", " + before;
    bomb += "]\n";
  }
  const ConfigError error = config_error([&] { parse(bomb); });
  EXPECT_EQ(config_error([] { parse(repeated("[", 200000)); }).expected(), "at most 100000 values");
  EXPECT_EQ(error.expected(), "at most 100000 values");
  EXPECT_EQ(error.element(), "line 6");  // 9^5 and what came before make 75,000
  std::string chain = "a0: &a0 [x]\n";
  for (int i = 1; i < 1000; ++i) {
    chain += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [*a" + std::to_string(i - 1) + "]\n";
  }
  EXPECT_EQ(config_error([&] { parse(chain); }).expected(), "at most 32 levels");
  EXPECT_EQ(parse("a: &x {b: 1}\nc: *x\n").at("c").at("b").number(), 1);
}

TEST(YamlReader, ShortensWhatItQuotes) {
  const ConfigError error = config_error([] { parse("a: " + std::string(100000, 'x')).at("a").number(); });
  EXPECT_LT(std::string(error.what()).size(), 700U);
  EXPECT_TRUE(error.found().ends_with("... (100002 bytes in all)")) << error.found();
}

TEST(YamlReader, ReadsSeedsUpToTheLargest) {
  EXPECT_EQ(parse("s: 18446744073709551615").at("s").seed(), 18446744073709551615U);
  EXPECT_EQ(parse("s: 0").at("s").seed(), 0U);
  for (const char* bad : {"s: -1", "s: 18446744073709551616", "s: 1.5", "s: 1e3"}) {
    EXPECT_EQ(config_error([&] { parse(bad).at("s").seed(); }).expected(), kSeedInWords);
  }
}

TEST(YamlReader, ReadsBackWhatItQuotes) {
  using std::string_literals::operator""s;
  for (const std::string& text :
       {"plain"s, "it's"s, "'"s, "\"quoted\""s, "back\\slash"s, "two\nlines"s, "tab\tq'"s, "# no comment: x"s,
        " spaces "s, "- a"s, "\x01\x7f"s, "\xc3\xa9t\xc3\xa9"s}) {
    EXPECT_EQ(parse("k: " + yaml_quoted(text)).at("k").text(), text) << yaml_quoted(text);
  }
}

TEST(YamlReader, RejectsMissingFilesAndFolders) {
  EXPECT_EQ(config_error([] { YamlValue::load("no/such.yaml"); }).source(), "no/such.yaml");
  EXPECT_EQ(config_error([] { YamlValue::load(CROSSGAIT_SOURCE_DIR); }).expected(), "a readable file");
}

}  // namespace
}  // namespace crossgait
