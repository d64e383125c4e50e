// Verdicts of many engines as a page shows them, from results that may have been written by anybody.
#include "report/verdict_document.h"

#include <gtest/gtest.h>

#include "tests/physics/core/config_error.h"

namespace crossgait {
namespace {

using Json = nlohmann::json;

Json pair_of(const std::string& a, const std::string& b, const std::string& word) {
  return {{"behaviour", "trot"}, {"a", a},           {"b", b},
          {"verdict", word},     {"starts", 4},      {"limit", 1},
          {"confidence", 0.95},  {"variations", {}}, {"left_out", Json::array()},
          {"statistics", {}},    {"models", {}}};
}

Json three() {
  Json pairs{pair_of("a", "b", "agrees"), pair_of("a", "c", "unresolved"), pair_of("b", "c", "agrees")};
  for (Json& pair : pairs) pair["variations"] = pair["statistics"] = pair["models"] = Json::array();
  return {{"behaviour", "trot"},
          {"engines",
           {{{"name", "a"}, {"contact_law", "soft"}},
            {{"name", "b"}, {"contact_law", "hard"}},
            {{"name", "c"}, {"contact_law", "hard"}}}},
          {"sentences", {"No outlier is named: two laws."}},
          {"pairs", std::move(pairs)}};
}

TEST(VerdictsDocument, HasTheWordsOfAllPairsEngineByEngine) {
  const VerdictsDocument many = verdicts_document(three(), "many.json");
  EXPECT_EQ(many.words.rows(),
            (std::vector<std::vector<std::string>>{{"trot", "law", "a", "b", "c"},
                                                   {"a", "soft", ".", "agrees", "unresolved"},
                                                   {"b", "hard", "agrees", ".", "agrees"},
                                                   {"c", "hard", "unresolved", "agrees", "."}}));
  EXPECT_EQ(many.sentences, std::vector<std::string>{"No outlier is named: two laws."});
  ASSERT_EQ(many.verdicts.size(), 3U);
  EXPECT_EQ(many.verdicts[1].at("b"), "c");
}

TEST(VerdictsDocument, RefusesWhatIsNoResult) {
  const auto refusal = [](Json json) {
    return config_error([&json] { static_cast<void>(verdicts_document(json, "many.json")); });
  };
  Json fewer = three();
  fewer["pairs"].erase(2);
  EXPECT_EQ(refusal(fewer).element(), "pairs");
  EXPECT_EQ(refusal(fewer).found(), "2 of 3 engines");
  EXPECT_EQ(refusal({{"engines", Json::array()}, {"pairs", Json::array()}}).element(), "pairs");
  Json worded = three();
  worded["pairs"][0]["verdict"] = 1;
  EXPECT_EQ(refusal(worded).source(), "many.json");
  Json silent = three();
  silent.erase("sentences");
  EXPECT_EQ(refusal(silent).element(), "verdicts");
  EXPECT_EQ(refusal(Json::array()).source(), "many.json");
}

}  // namespace
}  // namespace crossgait
