// Verdicts of many engines as a page shows them, from results that may have been written by anybody.
#include "report/verdict_document.h"

#include <gtest/gtest.h>

#include "tests/physics/core/config_error.h"

namespace crossgait {
namespace {

using Json = nlohmann::json;

Json pair_of(const std::string& a, const std::string& b, const std::string& word) {
  return {{"engines", {a, b}},       {"word", word},          {"reason", ""}, {"statistics", Json::array()},
          {"models", Json::array()}, {"attribution", nullptr}};
}

Json three() {
  const auto engine = [](const char* name, const char* law) {
    return Json{{"name", name}, {"contact_law", law}, {"contact_family", law}};
  };
  return {
      {"summary", "trot: all of it."},
      {"behaviour", "trot"},
      {"starts", 6},
      {"confidence", 0.95},
      {"variations", Json::array()},
      {"left_out", Json::array()},
      {"outcomes", {{"a", {{"walked", 6}}}, {"b", {{"fell", 2}, {"walked", 4}}}, {"c", {{"walked", 6}}}}},
      {"engines", {engine("a", "soft"), engine("b", "hard"), engine("c", "hard")}},
      {"groups",
       {{{"name", "A"}, {"engines", {"a", "b"}}, {"sentence", "A = a, b: agree with one another."}}}},
      {"sentences", {"No outlier is named: two laws."}},
      {"pairs", {pair_of("a", "b", "agrees"), pair_of("a", "c", "unresolved"), pair_of("b", "c", "agrees")}}};
}

TEST(VerdictDocument, HasTheWordsOfAllPairsEngineByEngine) {
  const VerdictDocument many = verdict_document(three(), "many.json");
  ASSERT_TRUE(many.words.has_value());
  EXPECT_EQ(many.words->rows(),
            (std::vector<std::vector<std::string>>{{"trot", "law", "a", "b", "c"},
                                                   {"a", "soft", ".", "agrees", "unresolved"},
                                                   {"b", "hard", "agrees", ".", "agrees"},
                                                   {"c", "hard", "unresolved", "agrees", "."}}));
  EXPECT_EQ(many.sentences, (std::vector<std::string>{"trot: all of it.", "No outlier is named: two laws."}));
  EXPECT_EQ(many.groups, std::vector<std::string>{"A = a, b: agree with one another."});
  ASSERT_EQ(many.pairs.size(), 3U);
  EXPECT_EQ(many.pairs[1].at("engines").at(1), "c");
  EXPECT_EQ(many.pairs[0].at("outcomes").at(1), "fell 2, walked 4");
}

TEST(VerdictDocument, LeavesAComparisonItsOwnGroups) {
  ReportPage alone, compared;
  compared.groups = {"A = a, b: walked 1 m"};
  verdict_document(three(), "many.json").add_to(alone);
  verdict_document(three(), "many.json").add_to(compared);
  EXPECT_EQ(alone.groups, std::vector<std::string>{"A = a, b: agree with one another."});
  EXPECT_EQ(compared.groups, std::vector<std::string>{"A = a, b: walked 1 m"});
  EXPECT_EQ(compared.sentences.size(), alone.sentences.size() + 1);
}

TEST(VerdictDocument, OfTwoEnginesIsItsSentence) {
  Json two = three();
  two["engines"].erase(2);
  two["pairs"].erase(2);
  two["pairs"].erase(1);
  const VerdictDocument document = verdict_document(two, "two.json");
  EXPECT_FALSE(document.words.has_value());
  EXPECT_EQ(document.sentences, std::vector<std::string>{"trot: all of it."});
}

TEST(VerdictDocument, RefusesWhatIsNoResult) {
  const auto refusal = [](Json json) {
    return config_error([&json] { static_cast<void>(verdict_document(json, "many.json")); });
  };
  Json fewer = three();
  fewer["pairs"].erase(2);
  EXPECT_EQ(refusal(fewer).element(), "pairs");
  EXPECT_EQ(refusal(fewer).found(), "2 of 3 engines");
  EXPECT_EQ(refusal({{"summary", ""}, {"engines", Json::array()}, {"pairs", Json::array()}}).element(),
            "pairs");
  Json worded = three();
  worded["pairs"][0]["word"] = 1;
  EXPECT_EQ(refusal(worded).source(), "many.json");
  Json silent = three();
  silent.erase("sentences");
  EXPECT_EQ(refusal(silent).element(), "verdict");
  EXPECT_EQ(refusal(Json::array()).source(), "many.json");
}

}  // namespace
}  // namespace crossgait
