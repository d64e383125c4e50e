#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "parity/verdict_report.h"
#include "physics/core/schema.h"
#include "study/engine_comparison.h"

namespace crossgait {
namespace {

using nlohmann::ordered_json;

ordered_json pair_json(const PairVerdict& pair) {
  ordered_json json = to_json(pair.verdict);
  json["models"] = to_json(pair.models);
  if (pair.attribution) json["attribution"] = to_json(*pair.attribution);
  return json;
}

std::vector<std::string> names_of(const EngineComparison& comparison,
                                  const std::vector<std::size_t>& engines) {
  std::vector<std::string> names;
  for (const std::size_t i : engines) names.push_back(comparison.engines[i].name);
  return names;
}

// An engine, or a law of which there are several.
std::string outlier_name(const EngineComparison& comparison) {
  const JudgedEngine& first = comparison.engines[comparison.consensus.outlier.front()];
  return comparison.consensus.outlier.size() == 1 ? first.name : first.law;
}

// Statistics of a pair that are not found to agree.
std::string differences(const Verdict& verdict) {
  std::vector<std::string> found;
  for (const StatisticVerdict& s : verdict.statistics) {
    if (s.value == VerdictValue::kAgrees) continue;
    found.push_back(fmt::format("{} {:+.2f}{}", s.statistic.name, s.score.estimate,
                                s.value == VerdictValue::kUnresolved ? " (unresolved)" : ""));
  }
  return fmt::format("{}", fmt::join(found, ", "));
}

// Clusters, and the outlier or why none is named.
std::vector<std::string> sentences(const EngineComparison& comparison) {
  std::vector<std::string> found;
  for (const std::vector<std::size_t>& cluster : comparison.consensus.clusters) {
    const auto names = names_of(comparison, cluster);
    found.push_back(cluster.size() == 1 ? fmt::format("Alone: {}.", names.front())
                                        : fmt::format("Agree with one another: {}.", fmt::join(names, ", ")));
  }
  for (const std::size_t p : comparison.consensus.bridges)
    found.push_back(
        fmt::format("Also agree: {} and {}.", comparison.pairs[p].verdict.a, comparison.pairs[p].verdict.b));
  if (comparison.consensus.outlier.empty()) {
    found.push_back(fmt::format("No outlier is named: {}.", comparison.consensus.reason));
  } else {
    const bool law = comparison.consensus.outlier.size() > 1;
    const std::string who =
        law ? fmt::format("the law {} ({})", outlier_name(comparison),
                          fmt::join(names_of(comparison, comparison.consensus.outlier), ", "))
            : outlier_name(comparison);
    found.push_back(fmt::format("The outlier is {}: {}; in {}.", who, comparison.consensus.reason,
                                fmt::join(comparison.consensus.statistics, ", ")));
  }
  return found;
}

// The words of all pairs, engine by engine.
Table words_table(const EngineComparison& comparison) {
  std::vector<std::string> words;
  for (const PairVerdict& pair : comparison.pairs) words.emplace_back(name(pair.verdict.value()));
  return crossgait::words_table(comparison.pairs.front().verdict.behaviour, comparison.engines, words);
}

}  // namespace

nlohmann::ordered_json to_json(const PairVerdict& pair) { return with_schema("verdict", pair_json(pair)); }

std::string describe(const PairVerdict& pair) {
  std::string text = fmt::format("{}\nModels: {}.\n", describe(pair.verdict), describe(pair.models));
  if (pair.attribution) text += fmt::format("\n{}", describe(*pair.attribution));
  return text;
}

nlohmann::ordered_json to_json(const EngineComparison& comparison) {
  if (comparison.pairs.size() == 1) return to_json(comparison.pairs.front());
  const Verdict& first = comparison.pairs.front().verdict;
  const Consensus& consensus = comparison.consensus;
  ordered_json json{{"behaviour", first.behaviour}, {"engines", ordered_json::array()}};
  for (const JudgedEngine& engine : comparison.engines)
    json["engines"].push_back({{"name", engine.name}, {"contact_law", engine.law}});
  json["clusters"] = ordered_json::array();
  for (const auto& cluster : consensus.clusters) json["clusters"].push_back(names_of(comparison, cluster));
  json["bridges"] = ordered_json::array();
  for (const std::size_t p : consensus.bridges)
    json["bridges"].push_back({{"a", comparison.pairs[p].verdict.a}, {"b", comparison.pairs[p].verdict.b}});
  json["outlier"] =
      consensus.outlier.empty() ? ordered_json(nullptr) : ordered_json(outlier_name(comparison));
  json["outlier_engines"] = names_of(comparison, consensus.outlier);
  json["outlier_statistics"] = consensus.statistics;
  json["reason"] = consensus.reason;
  json["sentences"] = sentences(comparison);
  json["pairs"] = ordered_json::array();
  for (const PairVerdict& pair : comparison.pairs) json["pairs"].push_back(pair_json(pair));
  return with_schema("verdicts", json);
}

std::string describe(const EngineComparison& comparison) {
  if (comparison.pairs.size() == 1) return describe(comparison.pairs.front());
  std::string text = words_table(comparison).str() + "\n";
  for (const PairVerdict& pair : comparison.pairs) {
    const Verdict& v = pair.verdict;
    text += fmt::format("{} against {}: {}{}{}.{}\n", v.b, v.a, name(v.value()),
                        v.value() == VerdictValue::kAgrees ? "" : ": ", differences(v),
                        pair.models.empty() ? "" : fmt::format(" Models: {}.", describe(pair.models)));
  }
  text += fmt::format("\n{}\n", fmt::join(sentences(comparison), "\n"));
  const Verdict& first = comparison.pairs.front().verdict;
  text += fmt::format(
      "\n{} starts. Scores as of two engines (crossgait verdict --engines A,B), at {:g} % confidence for all "
      "pairs together.\n",
      first.options.starts, 100 * first.options.confidence);
  for (const std::string& reason : first.left_out) text += "Left out: " + reason + ".\n";
  for (const PairVerdict& pair : comparison.pairs) {
    if (pair.attribution)
      text +=
          fmt::format("\n{} against {}:\n{}", pair.verdict.b, pair.verdict.a, describe(*pair.attribution));
  }
  return text;
}

}  // namespace crossgait
