#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "parity/answer.h"
#include "parity/report.h"
#include "parity/verdict_report.h"
#include "physics/core/schema.h"
#include "study/engine_comparison.h"

namespace crossgait {
namespace {

using nlohmann::ordered_json;

// An engine, or a law of which there are several.
std::string outlier_name(const EngineComparison& comparison, const std::vector<std::size_t>& outlier) {
  const JudgedEngine& first = comparison.engines[outlier.front()];
  return outlier.size() == 1 ? first.name : first.law;
}

ordered_json outlier_json(const EngineComparison& comparison, const std::vector<std::size_t>& outlier) {
  if (outlier.empty()) return nullptr;
  return {{"name", outlier_name(comparison, outlier)}, {"engines", names_of(comparison, outlier)}};
}

// Of a cluster of one: what is not known of it yet, else that it stands apart.
std::string alone(const EngineComparison& comparison, std::size_t engine) {
  const std::string& own = comparison.engines[engine].name;
  std::vector<std::string> open;
  std::optional<std::size_t> starts;
  for (const Verdict& pair : comparison.verdicts.pairs) {
    if ((pair.a != own && pair.b != own) || pair.word != Word::kUnresolved) continue;
    open.push_back(pair.a == own ? pair.b : pair.a);
    if (pair.starts_needed) starts = std::max(starts.value_or(0), *pair.starts_needed);
  }
  if (open.empty()) return "agrees with no other";
  return fmt::format("undecided against {}{}", listed(open),
                     starts ? fmt::format(" (about {} starts would tell)", *starts) : "");
}

// The cluster of that number: "A = mujoco, bullet:matched: agree with one another."
std::string describe_group(const EngineComparison& comparison, std::size_t number) {
  const std::vector<std::size_t>& cluster = comparison.consensus.clusters[number];
  return fmt::format(
      "{} = {}: {}.", group_name(number), fmt::join(names_of(comparison, cluster), ", "),
      cluster.size() == 1 ? alone(comparison, cluster.front()) : std::string("agree with one another"));
}

// What else is known of them: pairs across clusters, and the outlier or why none is named.
std::vector<std::string> sentences(const EngineComparison& comparison) {
  const Consensus& consensus = comparison.consensus;
  std::vector<std::string> found;
  for (const std::size_t p : consensus.bridges) {
    const Verdict& pair = comparison.verdicts.pairs[p];
    found.push_back(fmt::format("Also agree: {} and {}.", pair.a, pair.b));
  }
  if (consensus.outlier.empty()) {
    found.push_back(fmt::format("No outlier is named: {}.", consensus.reason));
  } else {
    const auto& outlier = consensus.outlier;
    const std::string who = outlier.size() > 1
                                ? fmt::format("the law {} ({})", outlier_name(comparison, outlier),
                                              fmt::join(names_of(comparison, outlier), ", "))
                                : outlier_name(comparison, outlier);
    found.push_back(fmt::format("The outlier is {}: {}; in {}.", who, consensus.reason,
                                fmt::join(consensus.statistics, ", ")));
  }
  if (consensus.outlier_by_law != consensus.outlier) {
    found.push_back(consensus.outlier_by_law.empty()
                        ? "If every law had a vote, whatever its family, none would be named."
                        : fmt::format("If every law had a vote, whatever its family, it would be {}.",
                                      outlier_name(comparison, consensus.outlier_by_law)));
  }
  return found;
}

// Statistics of a pair that are not found to agree.
std::string differences(const Verdict& verdict) {
  std::vector<std::string> found;
  for (const StatisticVerdict& s : verdict.statistics) {
    if (s.word == Word::kAgrees) continue;
    found.push_back(fmt::format("{} {}{}", s.statistic.name, signed_amount(s.gap.estimate, s.statistic),
                                s.word == Word::kDiffers ? "" : fmt::format(" ({})", name(s.word))));
  }
  return fmt::format("{}", fmt::join(found, ", "));
}

// The words of all pairs, engine by engine.
Table words_table(const EngineComparison& comparison) {
  std::vector<std::string> words;
  for (const Verdict& pair : comparison.verdicts.pairs) words.emplace_back(name(pair.word));
  return crossgait::words_table(comparison.verdicts.pairs.front().behaviour, comparison.engines, words);
}

std::string describe_background(const PairBackground& background) {
  std::string text = fmt::format("Models: {}. Shared, and so no evidence: {}.\n", describe(background.models),
                                 fmt::join(background.shared, "; "));
  if (background.attribution) text += fmt::format("\n{}", describe(*background.attribution));
  return text;
}

// Every pair of an engine has its outcomes.
const OutcomeCounts& outcomes_of(const EngineComparison& comparison, const std::string& engine) {
  for (const Verdict& pair : comparison.verdicts.pairs) {
    if (pair.a == engine) return pair.outcomes_a;
    if (pair.b == engine) return pair.outcomes_b;
  }
  throw std::logic_error("an engine without a pair");
}

std::string describe_many(const EngineComparison& comparison) {
  std::string text;
  for (std::size_t g = 0; g < comparison.consensus.clusters.size(); ++g)
    text += describe_group(comparison, g) + "\n";
  text += fmt::format("{}\n\nOutcomes:", fmt::join(sentences(comparison), "\n"));
  for (const JudgedEngine& engine : comparison.engines)
    text += fmt::format(" {}: {};", engine.name, describe(outcomes_of(comparison, engine.name)));
  text.back() = '.';
  text += fmt::format("\n\n{}\n", words_table(comparison).str());
  for (std::size_t p = 0; p < comparison.verdicts.pairs.size(); ++p) {
    const Verdict& v = comparison.verdicts.pairs[p];
    const auto& models = comparison.backgrounds[p].models;
    text +=
        fmt::format("{} against {}: {}{}{}.{}\n", v.b, v.a, name(v.word), v.word == Word::kAgrees ? "" : ": ",
                    differences(v),
                    models.findings.empty() ? "" : fmt::format(" Models: {}.", describe(models.findings)));
  }
  for (std::size_t p = 0; p < comparison.verdicts.pairs.size(); ++p) {
    const auto& attribution = comparison.backgrounds[p].attribution;
    const Verdict& v = comparison.verdicts.pairs[p];
    if (attribution) text += fmt::format("\n{} against {}:\n{}", v.b, v.a, describe(*attribution));
  }
  return text;
}

ordered_json pair_json(const EngineComparison& comparison, std::size_t pair) {
  const PairBackground& background = comparison.backgrounds[pair];
  ordered_json json = to_json(comparison.verdicts.pairs[pair]);
  json["shared"] = background.shared;
  json["models"] = to_json(background.models.findings);
  json["models_compared"] = background.models.compared;
  json["attribution"] = background.attribution ? to_json(*background.attribution) : ordered_json(nullptr);
  return json;
}

}  // namespace

nlohmann::ordered_json to_json(const EngineComparison& comparison) {
  const Verdicts& verdicts = comparison.verdicts;
  const VerdictOptions& how = verdicts.options;
  const Consensus& consensus = comparison.consensus;
  ordered_json json{{"summary", summary(comparison)},
                    {"word", name(word_of(comparison))},
                    {"behaviour", verdicts.pairs.front().behaviour},
                    {"starts", verdicts.starts},
                    {"starts_held", comparison.starts_held},
                    {"looks", {{"planned", how.looks}, {"made", verdicts.looks_made}}},
                    {"confidence", how.confidence},
                    {"variations", verdicts.variations},
                    {"left_out", verdicts.left_out},
                    {"notes", comparison.notes},
                    {"contact", to_json(comparison.contact)},
                    {"against", comparison.against ? to_json(*comparison.against) : ordered_json(nullptr)},
                    {"not_of_law", ordered_json::object()},
                    {"engines", ordered_json::array()},
                    {"outcomes", ordered_json::object()},
                    {"groups", ordered_json::array()},
                    {"bridges", ordered_json::array()}};
  for (std::size_t i = 0; i < comparison.infos.size(); ++i) {
    const EngineInfo& engine = comparison.infos[i];
    const ContactSpec& contact =
        comparison.against && i % 2 == 1 ? comparison.against->b.contact : comparison.contact;
    const std::vector<std::string> ignored = not_of_law(contact, engine.capabilities);
    if (!ignored.empty()) json["not_of_law"][engine.name] = ignored;
  }
  for (const JudgedEngine& engine : comparison.engines) {
    json["engines"].push_back(
        {{"name", engine.name}, {"contact_law", engine.law}, {"contact_family", engine.family}});
    json["outcomes"][engine.name] = to_json(outcomes_of(comparison, engine.name));
  }
  for (std::size_t g = 0; g < consensus.clusters.size(); ++g) {
    json["groups"].push_back({{"name", group_name(g)},
                              {"engines", names_of(comparison, consensus.clusters[g])},
                              {"sentence", describe_group(comparison, g)}});
  }
  for (const std::size_t p : consensus.bridges)
    json["bridges"].push_back({verdicts.pairs[p].a, verdicts.pairs[p].b});
  json["outlier"] = outlier_json(comparison, consensus.outlier);
  json["outlier_by_law"] = outlier_json(comparison, consensus.outlier_by_law);
  json["outlier_statistics"] = consensus.statistics;
  json["outlier_reason"] = consensus.reason;
  json["sentences"] = sentences(comparison);
  json["pairs"] = ordered_json::array();
  for (std::size_t p = 0; p < verdicts.pairs.size(); ++p) json["pairs"].push_back(pair_json(comparison, p));
  return with_schema("verdict", json);
}

std::string describe(const EngineComparison& comparison) {
  const bool two = comparison.verdicts.pairs.size() == 1;
  std::string text = fmt::format("{}\n\n", summary(comparison));
  if (comparison.against) text += fmt::format("{}\n", describe(*comparison.against));
  text += two ? fmt::format("{}\n{}", describe(comparison.verdicts.pairs.front()),
                            describe_background(comparison.backgrounds.front()))
              : describe_many(comparison);
  text += fmt::format("\n{}{}", describe_contact(comparison.contact, comparison.infos),
                      describe_rule(comparison.verdicts));
  if (comparison.starts_held > 0) {
    text += fmt::format(
        "The store held {} of these starts already: if they have been looked at, this is a new plan, with "
        "its own "
        "error.\n",
        comparison.starts_held);
  }
  return text;
}

}  // namespace crossgait
