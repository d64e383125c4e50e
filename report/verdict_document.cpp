#include "report/verdict_document.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "parity/consensus.h"
#include "physics/core/error.h"

namespace crossgait {
namespace {

using Json = nlohmann::json;
using nlohmann::ordered_json;

// Each takes what it names, of the type that a page counts on, or throws Json::exception.

ordered_json text(const Json& from, const char* key) { return from.at(key).get<std::string>(); }
ordered_json number(const Json& from, const char* key) { return from.at(key).get<double>(); }

ordered_json interval(const Json& from, const char* key) {
  const Json& i = from.at(key);
  return {{"estimate", number(i, "estimate")}, {"low", number(i, "low")}, {"high", number(i, "high")}};
}

ordered_json texts(const Json& from, const char* key) { return from.at(key).get<std::vector<std::string>>(); }

ordered_json statistic(const Json& s) {
  return {{"name", text(s, "name")},       {"unit", text(s, "unit")},       {"mean_a", number(s, "mean_a")},
          {"mean_b", number(s, "mean_b")}, {"gap", interval(s, "gap")},     {"spread", number(s, "spread")},
          {"floor", number(s, "floor")},   {"score", interval(s, "score")}, {"verdict", text(s, "verdict")}};
}

ordered_json attribution(const Json& a) {
  ordered_json statistics = ordered_json::array(), factors = ordered_json::array();
  for (const Json& s : a.at("statistics")) {
    ordered_json effects = ordered_json::array();
    for (const Json& f : s.at("factors"))
      effects.push_back({{"name", text(f, "name")}, {"effect", interval(f, "effect")}});
    statistics.push_back({{"name", text(s, "name")},
                          {"unit", text(s, "unit")},
                          {"gap", interval(s, "gap")},
                          {"leading", texts(s, "leading")},
                          {"factors", std::move(effects)}});
  }
  for (const Json& f : a.at("factors"))
    factors.push_back({{"name", text(f, "name")}, {"summary", text(f, "summary")}});
  return {{"from", text(a, "from")},
          {"to", text(a, "to")},
          {"statistics", std::move(statistics)},
          {"factors", std::move(factors)}};
}

ordered_json finding(const Json& f) {
  return {{"quantity", text(f, "quantity")},
          {"element", text(f, "element")},
          {"a", number(f, "a")},
          {"b", number(f, "b")},
          {"unit", text(f, "unit")}};
}

}  // namespace

nlohmann::ordered_json verdict_document(const nlohmann::json& verdict, const std::string& file) {
  try {
    ordered_json statistics = ordered_json::array(), models = ordered_json::array();
    for (const Json& s : verdict.at("statistics")) statistics.push_back(statistic(s));
    // Those of `compare --verdict` have none.
    for (const Json& f : verdict.value("models", Json::array())) models.push_back(finding(f));
    return {{"behaviour", text(verdict, "behaviour")},
            {"a", text(verdict, "a")},
            {"b", text(verdict, "b")},
            {"verdict", text(verdict, "verdict")},
            {"starts", number(verdict, "starts")},
            {"limit", number(verdict, "limit")},
            {"confidence", number(verdict, "confidence")},
            {"variations", texts(verdict, "variations")},
            {"left_out", texts(verdict, "left_out")},
            {"statistics", std::move(statistics)},
            {"models", std::move(models)},
            {"attribution", verdict.contains("attribution") && !verdict.at("attribution").is_null()
                                ? attribution(verdict.at("attribution"))
                                : ordered_json()}};
  } catch (const Json::exception& problem) {
    throw ConfigError(file, "verdict", "a result as `crossgait verdict --json` writes it", problem.what());
  }
}

void VerdictsDocument::add_to(ReportPage& page) && {
  page.tables.push_back(std::move(words));
  std::move(sentences.begin(), sentences.end(), std::back_inserter(page.sentences));
  std::move(verdicts.begin(), verdicts.end(), std::back_inserter(page.verdicts));
}

VerdictsDocument verdicts_document(const nlohmann::json& verdicts, const std::string& file) {
  try {
    std::vector<JudgedEngine> engines;
    for (const Json& engine : verdicts.at("engines"))
      engines.push_back({engine.at("name"), engine.at("contact_law")});
    std::vector<std::string> words;
    std::vector<ordered_json> pairs;
    for (const Json& pair : verdicts.at("pairs")) {
      pairs.push_back(verdict_document(pair, file));
      words.push_back(pair.at("verdict"));
    }
    const std::size_t n = engines.size();
    if (n < 2 || pairs.size() != n * (n - 1) / 2) {
      throw ConfigError(file, "pairs", "one of every two engines, which are two or more",
                        fmt::format("{} of {} engines", pairs.size(), n));
    }
    return {words_table(verdicts.at("behaviour"), engines, words),
            verdicts.at("sentences").get<std::vector<std::string>>(), std::move(pairs)};
  } catch (const Json::exception& problem) {
    throw ConfigError(file, "verdicts", "a result as `crossgait verdict --json` writes it", problem.what());
  }
}

}  // namespace crossgait
