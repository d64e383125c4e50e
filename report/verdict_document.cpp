#include "report/verdict_document.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>
#include <fmt/ranges.h>

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

ordered_json pair_of(const Json& from, const char* key, const auto& of_one) {
  const Json& two = from.at(key);
  return {of_one(two.at(0)), of_one(two.at(1))};
}

ordered_json as_number(const Json& value) { return value.get<double>(); }
ordered_json as_text(const Json& value) { return value.get<std::string>(); }

ordered_json statistic(const Json& s) {
  const Json& step = s.at("step");
  return {{"name", text(s, "name")},
          {"unit", text(s, "unit")},
          {"values", pair_of(s, "values", as_number)},
          {"estimand", text(s, "estimand")},
          {"gap", number(s, "gap")},
          {"low", number(s, "low")},
          {"high", number(s, "high")},
          {"margin", number(s, "margin")},
          {"margin_rule", text(s.at("margin_rule"), "is")},
          {"word", text(s, "word")},
          {"reason", text(s, "reason")},
          {"gap_half", step.is_null() ? ordered_json() : number(step, "gap_half")}};
}

ordered_json attribution(const Json& a) {
  ordered_json statistics = ordered_json::array(), groups = ordered_json::array();
  for (const Json& s : a.at("statistics")) {
    ordered_json effects = ordered_json::array();
    for (const Json& g : s.at("groups"))
      effects.push_back({{"name", text(g, "name")}, {"effect", interval(g, "effect")}});
    statistics.push_back({{"name", text(s, "name")},
                          {"unit", text(s, "unit")},
                          {"gap", interval(s, "gap")},
                          {"leading", texts(s.at("cause"), "leading")},
                          {"sentence", text(s.at("cause"), "sentence")},
                          {"groups", std::move(effects)}});
  }
  for (const Json& f : a.at("factors"))
    groups.push_back(
        {{"name", text(f, "name")}, {"group", text(f, "group")}, {"summary", text(f, "summary")}});
  return {{"from", text(a, "from")},
          {"to", text(a, "to")},
          {"statistics", std::move(statistics)},
          {"factors", std::move(groups)}};
}

ordered_json finding(const Json& f) {
  return {{"quantity", text(f, "quantity")},
          {"element", text(f, "element")},
          {"a", number(f, "a")},
          {"b", number(f, "b")},
          {"unit", text(f, "unit")}};
}

// "walked 9, fell 15"
std::string outcomes(const Json& counts) {
  std::vector<std::string> parts;
  for (const auto& [name, count] : counts.items())
    parts.push_back(fmt::format("{} {}", name, count.get<int>()));
  return fmt::format("{}", fmt::join(parts, ", "));
}

ordered_json pair_document(const Json& verdict, const Json& pair) {
  ordered_json statistics = ordered_json::array(), models = ordered_json::array(),
               ended = ordered_json::array();
  for (const Json& s : pair.at("statistics")) statistics.push_back(statistic(s));
  for (const Json& f : pair.at("models")) models.push_back(finding(f));
  for (const Json& engine : pair.at("engines"))
    ended.push_back(outcomes(verdict.at("outcomes").at(engine.get<std::string>())));
  return {{"behaviour", text(verdict, "behaviour")},
          {"starts", number(verdict, "starts")},
          {"confidence", number(verdict, "confidence")},
          {"variations", texts(verdict, "variations")},
          {"left_out", texts(verdict, "left_out")},
          {"engines", pair_of(pair, "engines", as_text)},
          {"word", text(pair, "word")},
          {"reason", text(pair, "reason")},
          {"outcomes", std::move(ended)},
          {"statistics", std::move(statistics)},
          {"models", std::move(models)},
          {"attribution",
           pair.at("attribution").is_null() ? ordered_json() : attribution(pair.at("attribution"))}};
}

}  // namespace

VerdictDocument verdict_document(const nlohmann::json& verdict, const std::string& file) {
  try {
    VerdictDocument document;
    document.sentences.push_back(text(verdict, "summary"));
    std::vector<JudgedEngine> engines;
    for (const Json& engine : verdict.at("engines"))
      engines.push_back({engine.at("name"), engine.at("contact_law"), engine.at("contact_family")});
    std::vector<std::string> words;
    for (const Json& pair : verdict.at("pairs")) {
      document.pairs.push_back(pair_document(verdict, pair));
      words.push_back(pair.at("word"));
    }
    const std::size_t n = engines.size();
    if (n < 2 || words.size() != n * (n - 1) / 2) {
      throw ConfigError(file, "pairs", "one of every two engines, which are two or more",
                        fmt::format("{} of {} engines", words.size(), n));
    }
    if (n > 2) {
      document.words = words_table(verdict.at("behaviour"), engines, words);
      for (const Json& group : verdict.at("groups")) document.groups.push_back(group.at("sentence"));
      for (const Json& sentence : verdict.at("sentences")) document.sentences.push_back(sentence);
    }
    return document;
  } catch (const Json::exception& problem) {
    throw ConfigError(file, "verdict", "a result as `crossgait verdict --json` writes it", problem.what());
  }
}

void VerdictDocument::add_to(ReportPage& page) && {
  if (words) page.tables.push_back({std::move(*words)});
  if (page.summary.empty() && !sentences.empty()) {
    page.summary = std::move(sentences.front());
    sentences.erase(sentences.begin());
  }
  // A comparison has groups of its own.
  std::move(groups.begin(), groups.end(),
            std::back_inserter(page.groups.empty() ? page.groups : page.sentences));
  std::move(sentences.begin(), sentences.end(), std::back_inserter(page.sentences));
  std::move(pairs.begin(), pairs.end(), std::back_inserter(page.verdicts));
}

}  // namespace crossgait
