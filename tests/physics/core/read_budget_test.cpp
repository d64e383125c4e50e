#include "physics/core/read_budget.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "physics/core/text.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"

namespace crossgait {
namespace {

constexpr ReadBudget kSmall{16, 5, 3};
constexpr ReadBudget kFew{1000, 5, 3};

class ReadBudgets : public ScratchFolder {};

TEST_F(ReadBudgets, HoldForTheSizeOfFiles) {
  EXPECT_EQ(read_text_file(write("fits", "0123456789abcdef"), kSmall), "0123456789abcdef");
  EXPECT_EQ(read_text_file(write("empty", ""), kSmall), "");
  const std::string large = write("large", "0123456789abcdefg");
  EXPECT_STREQ(config_error([&] { read_text_file(large, kSmall); }).what(),
               (large + ": file: expected at most 16 bytes, found 17 bytes").c_str());
  // No more than a hole is on disk, and none of it is read.
  std::filesystem::resize_file(large, std::uintmax_t{1} << 40U);
  EXPECT_EQ(config_error([&] { read_text_file(large, kYamlBudget); }).expected(), "at most 1 MiB");
  // The size of what /proc shows is said to be zero.
  EXPECT_EQ(config_error([] { read_text_file("/proc/self/maps", kSmall); }).expected(), "at most 16 bytes");
  EXPECT_FALSE(read_text_file("/proc/self/status", kYamlBudget).empty());
}

TEST_F(ReadBudgets, LetOnlyRegularFilesBeRead) {
  const auto found = [](const std::string& file) {
    const ConfigError error = config_error([&] { read_text_file(file, kYamlBudget); });
    EXPECT_EQ(error.source(), file);
    EXPECT_EQ(error.expected(), "a readable file");
    return error.found();
  };
  EXPECT_EQ(found("/dev/zero"), "a device");
  EXPECT_EQ(found(path("none")), "none");
  EXPECT_EQ(found(path("")), "a folder");
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  EXPECT_EQ(found(path("pipe")), "a pipe") << "and does not wait for somebody to write to it";
}

std::string json_error(const std::string& text) {
  try {
    check_json_budget(text, kFew, "a.json");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(JsonBudget, CountsValuesAndLevels) {
  EXPECT_EQ(json_error("[[[1]], 2, 3]"), "");
  EXPECT_EQ(json_error(std::string(1001, ' ')),
            "a.json: line 1: expected at most 1000 bytes, found 1001 bytes");
  EXPECT_EQ(json_error("\n[[[[1]]]]"), "a.json: line 2: expected at most 3 levels, found more");
  EXPECT_EQ(json_error("[1, 2, 3, 4, 5, 6]"), "a.json: line 1: expected at most 5 values, found more");
  EXPECT_EQ(json_error(R"(["[[[[[[", "\"[[[[[,,,,,"])"), "") << "what is in strings is text";
}

std::string xml_error(const std::string& text) {
  try {
    check_xml_budget(text, kFew, "a.xml");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(XmlBudget, CountsElementsAndLevels) {
  EXPECT_EQ(xml_error("<?xml version='1.0'?><!-- <a><a><a><a> --><a><b><c/></b><b x='>/'/></a>"), "");
  EXPECT_EQ(xml_error("<a>\n<b><c><d/></c></b></a>"), "a.xml: line 2: expected at most 3 levels, found more");
  EXPECT_EQ(xml_error("<a><b/><b/><b/><b/><b/></a>"),
            "a.xml: line 1: expected at most 5 elements, found more");
}

// TinyXML compares each with all before it.
TEST(XmlBudget, CountsAttributesOfAnElement) {
  std::string tag = "<a x='==='";
  for (std::size_t i = 1; i < kMaxXmlAttributes; ++i) tag += " x" + std::to_string(i) + "='='";
  EXPECT_EQ(xml_error(tag + "/>"), "");
  EXPECT_EQ(xml_error(tag + " y=''/>"),
            "a.xml: line 1: expected at most 100 attributes of an element, found more");
}

// What TinyXML takes for text, a comment or an attribute closes nothing.
TEST(Budgets, TakeNoByteOfZeroForTheEnd) {
  using namespace std::string_view_literals;
  const ReadBudget budget{1000, 10, 5};
  const ConfigError json = config_error([&] { check_json_budget("{}\n\0[[[[[[[["sv, budget, "f", 7); });
  const ConfigError xml = config_error([&] { check_xml_budget("<a/>\n\0<b/>"sv, budget, "f"); });
  EXPECT_EQ(json.element(), "line 8");
  EXPECT_EQ(xml.element(), "line 2");
  for (const ConfigError& error : {json, xml}) EXPECT_EQ(error.found(), "a byte of zero");
}

TEST(XmlBudget, IsNotFooled) {
  for (const std::string fake :
       {"<!-- </a> -->", "<![CDATA[</a>]]>", "<?XML v='></a>'?>", "<b x='/'>", "<b x='</a>'/>"}) {
    EXPECT_NE(xml_error("<a>" + fake + "<a>" + fake + "<a>" + fake + "<a>"), "") << fake;
  }
}

TEST(ConfigErrors, QuoteABeginningFitForATerminal) {
  const ConfigError error("file", std::string(10000, 'k'), "a number",
                          "\x1b[31m" + std::string(499, 'x') + "\xc3\xa9");
  EXPECT_LT(std::string(error.what()).size(), 1300U);
  EXPECT_TRUE(error.found().starts_with("\\x1b[31mx"));
  EXPECT_EQ(error.found().find('\xc3'), std::string::npos) << "half a character";
}

TEST(ConfigErrors, QuoteWhatIsNoTextByItsBytes) {
  const auto quoted = [](const std::string& found) { return ConfigError("f", "e", "x", found).found(); };
  for (const char* text : {"gr\xc3\xbc\xc3\x9f", "\xe2\x82\xac", "\xf0\x9f\x90\x95", "two\n\tlines"}) {
    EXPECT_EQ(quoted(text), text);
  }
  EXPECT_EQ(quoted("\xff\xfe!"), "\\xff\\xfe!");
  EXPECT_EQ(quoted("\xc0\xaf"), "\\xc0\\xaf") << "a slash in two bytes";
  EXPECT_EQ(quoted("\xc3("), "\\xc3(") << "not continued";
  EXPECT_EQ(quoted("half \xe2\x82"), "half \\xe2\\x82") << "cut off";
  EXPECT_EQ(quoted("\x80"), "\\x80") << "nothing to continue";
  EXPECT_EQ(quoted("\xe0\x80\xaf"), "\\xe0\\x80\\xaf") << "a slash in three";
  EXPECT_EQ(quoted("\xed\xa0\x80"), "\\xed\\xa0\\x80") << "half of a surrogate pair";
  EXPECT_EQ(quoted("\xc2"), "\\xc2");
  EXPECT_EQ(quoted("a\u202eb\u2066"), "a\\xe2\\x80\\xaeb\\xe2\\x81\\xa6") << "text that runs backwards";
  EXPECT_EQ(quoted("\u2026"), "\u2026");
}

}  // namespace
}  // namespace crossgait
