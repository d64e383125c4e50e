#include "crossgait/physics/yaml_reader.h"

#include <functional>
#include <locale>

#include <gtest/gtest.h>

#include "crossgait/tests/physics/config_error.h"
#include "crossgait/tests/physics/scratch_robot.h"

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
     "test.yaml: top level: expected keys that are plain names, found a sequence of 2"},
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
     "test.yaml: line 1, a: expected a sequence, found '1'"},
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
     "test.yaml: line 1, a: expected text, found a sequence of 1"},
    {"WrongSize", "a: [1, 2]\n", [](const YamlValue& v) { v.at("a").vector3(); },
     "test.yaml: line 1, a: expected a sequence of 3 numbers, found a sequence of 2"},
    {"BadElement", "a: [1, 2, x]\n", [](const YamlValue& v) { v.at("a").vector3(); },
     "test.yaml: line 1, a[2]: expected a finite number, found 'x'"},
};
const auto kYamlCase = [](const auto& info) { return info.param.name; };
INSTANTIATE_TEST_SUITE_P(All, YamlReaderError, ::testing::ValuesIn(kBadYaml), kYamlCase);

TEST(YamlReader, RejectsAValueInsideItself) {
  const ConfigError error = config_error([] { parse("a: &x [*x, *x]\n"); });
  EXPECT_EQ(error.expected(), "at most 32 levels");
}

TEST(YamlReader, RejectsMissingFilesAndFolders) {
  EXPECT_EQ(config_error([] { YamlValue::load("no/such.yaml"); }).source(), "no/such.yaml");
  EXPECT_EQ(config_error([] { YamlValue::load(CROSSGAIT_SOURCE_DIR); }).expected(), "a readable file");
}

}  // namespace
}  // namespace crossgait
