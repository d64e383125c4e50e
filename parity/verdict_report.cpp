#include "parity/verdict_report.h"

#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "physics/core/table.h"

namespace crossgait {
namespace {

using nlohmann::ordered_json;

template <typename T>
ordered_json or_null(const std::optional<T>& value) {
  return value ? ordered_json(*value) : ordered_json(nullptr);
}

ordered_json to_json(const StepCheck& step) {
  return {{"gap_half", step.half.estimate},
          {"low", step.half.low},
          {"high", step.half.high},
          {"change", to_json(step.change)},
          {"gap_quarter", or_null(step.quarter)},
          {"order", or_null(step.order)},
          {"extrapolated", or_null(step.extrapolated)}};
}

ordered_json to_json(const StatisticVerdict& v) {
  const Margin& margin = v.statistic.margin;
  ordered_json json{{"key", v.statistic.key},
                    {"name", v.statistic.name},
                    {"unit", v.statistic.unit},
                    {"values", {v.value_a, v.value_b}},
                    {"starts", v.pairs},
                    {"estimand", name(v.estimand)},
                    {"gap", v.gap.estimate},
                    {"low", v.gap.low},
                    {"high", v.gap.high},
                    {"equivalence", {{"low", v.equivalence.low}, {"high", v.equivalence.high}}},
                    {"margin", v.margin},
                    {"margin_rule", {{"is", margin.words(v.statistic.unit)}, {"reason", margin.reason}}},
                    {"word", name(v.word)},
                    {"reason", v.reason},
                    {"starts_needed", or_null(v.starts_needed)},
                    {"step", v.step ? to_json(*v.step) : ordered_json(nullptr)},
                    {"own", ordered_json::array()}};
  for (const OwnChange& own : v.own) {
    json["own"].push_back({{"engine", own.engine},
                           {"variation", own.variation},
                           {"change", own.change.estimate},
                           {"low", own.change.low},
                           {"high", own.change.high}});
  }
  return json;
}

ordered_json to_json(const PairCut& cut) {
  return {{"pairs", cut.pairs},
          {"mean_s", cut.mean_s},
          {"shortest_s", cut.shortest_s},
          {"time_to_failure", cut.any_failed ? ordered_json{{"means_s", {cut.mean_a_s, cut.mean_b_s}},
                                                            {"difference_s", to_json(cut.difference_s)}}
                                             : ordered_json(nullptr)}};
}

std::string number(double value) { return fmt::format("{:.3g}", value); }

// What each engine changes by itself, of statistics in which the engines do not agree.
std::string own_changes(const Verdict& verdict) {
  std::vector<std::string> header{"by itself"};
  std::vector<const StatisticVerdict*> shown;
  for (const StatisticVerdict& v : verdict.statistics) {
    if (v.word == Word::kAgrees || v.own.empty()) continue;
    shown.push_back(&v);
    header.push_back(label(v.statistic));
  }
  if (shown.empty()) return "";
  Table table(header);
  for (std::size_t i = 0; i < shown.front()->own.size(); ++i) {
    const OwnChange& first = shown.front()->own[i];
    std::vector<std::string> row{fmt::format("{}, {}", first.engine, first.variation)};
    for (const StatisticVerdict* v : shown) row.push_back(fmt::format("{:+.3g}", v->own[i].change.estimate));
    table.add_row(row);
  }
  return fmt::format("\n{}", table.str());
}

std::string cut_in_words(const Verdict& verdict) {
  if (!verdict.cut) return "";
  const PairCut& cut = *verdict.cut;
  return fmt::format(
      "Of {} pairs one run or both ended early: pairs are compared up to there, {:.2f} s on average, {:.2f} "
      "s at "
      "least.\nRuns lasted {:.2f} s in {} and {:.2f} s in {}: {:+.2f} s ({:+.2f} to {:+.2f}).\n",
      cut.pairs, cut.mean_s, cut.shortest_s, cut.mean_a_s, verdict.a, cut.mean_b_s, verdict.b,
      cut.difference_s.estimate, cut.difference_s.low, cut.difference_s.high);
}

// A line for each reason, with all statistics that have it.
std::string reasons_in_words(const Verdict& verdict) {
  std::vector<std::string> reasons;
  std::map<std::string, std::vector<std::string>> names;
  std::string limits;
  for (const StatisticVerdict& v : verdict.statistics) {
    if (v.reason.empty()) continue;
    const std::string reason =
        fmt::format("{}: {}{}", name(v.word), v.reason,
                    v.starts_needed ? fmt::format("; about {} starts would tell", *v.starts_needed) : "");
    if (!names.contains(reason)) reasons.push_back(reason);
    names[reason].push_back(v.statistic.name);
    if (v.step && v.step->extrapolated) {
      limits +=
          fmt::format("With steps of one, a half and a quarter the gap in {} goes to {}, in order {:.1f}.\n",
                      v.statistic.name, signed_amount(*v.step->extrapolated, v.statistic), *v.step->order);
    }
  }
  std::string text;
  for (const std::string& reason : reasons)
    text += fmt::format("{}: {}.\n", fmt::join(names[reason], ", "), reason);
  return text + limits;
}

}  // namespace

nlohmann::ordered_json to_json(const Interval& i) {
  return {{"estimate", i.estimate}, {"low", i.low}, {"high", i.high}};
}

std::string label(const Statistic& s) {
  return s.unit == "-" ? s.name : fmt::format("{}, {}", s.name, s.unit);
}

std::string signed_amount(double amount, const Statistic& statistic) {
  return fmt::format("{:+.3g}{}{}", amount, statistic.unit == "-" ? "" : " ",
                     statistic.unit == "-" ? "" : statistic.unit);
}

nlohmann::ordered_json to_json(const OutcomeCounts& outcomes) {
  ordered_json json = ordered_json::object();
  for (const OutcomeRow& row : outcome_rows()) {
    const std::size_t count = outcomes[static_cast<std::size_t>(row.outcome)];
    if (count > 0) json[std::string(row.name)] = count;
  }
  return json;
}

std::string describe(const OutcomeCounts& outcomes) {
  std::vector<std::string> parts;
  for (const OutcomeRow& row : outcome_rows()) {
    const std::size_t count = outcomes[static_cast<std::size_t>(row.outcome)];
    if (count > 0) parts.insert(parts.begin(), fmt::format("{} {}", row.words, count));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

nlohmann::ordered_json to_json(const Verdict& verdict) {
  ordered_json json{{"engines", {verdict.a, verdict.b}},
                    {"word", name(verdict.word)},
                    {"reason", verdict.reason},
                    {"starts_needed", or_null(verdict.starts_needed)},
                    {"cut", verdict.cut ? to_json(*verdict.cut) : ordered_json(nullptr)},
                    {"undefined", ordered_json::array()},
                    {"statistics", ordered_json::array()}};
  for (const Statistic& s : verdict.undefined) json["undefined"].push_back(s.key);
  for (const StatisticVerdict& s : verdict.statistics) json["statistics"].push_back(to_json(s));
  return json;
}

nlohmann::ordered_json to_json(const std::vector<AuditFinding>& findings) {
  ordered_json json = ordered_json::array();
  for (const AuditFinding& f : findings)
    json.push_back(
        {{"quantity", f.quantity}, {"element", f.element}, {"a", f.a}, {"b", f.b}, {"unit", f.unit}});
  return json;
}

std::string describe(const Verdict& verdict) {
  Table table({"statistic", verdict.a, verdict.b, "gap", "from", "to", "margin", "at half the step", "word"});
  for (const StatisticVerdict& v : verdict.statistics) {
    table.add_row({label(v.statistic), fmt::format("{:.4g}", v.value_a), fmt::format("{:.4g}", v.value_b),
                   fmt::format("{:+.3g}", v.gap.estimate), fmt::format("{:+.3g}", v.gap.low),
                   fmt::format("{:+.3g}", v.gap.high), number(v.margin),
                   v.step ? fmt::format("{:+.3g}", v.step->half.estimate) : "-", std::string(name(v.word))});
  }
  std::string text = table.str();
  text += fmt::format("\nOutcomes: {}: {}; {}: {}.\n", verdict.a, describe(verdict.outcomes_a), verdict.b,
                      describe(verdict.outcomes_b));
  text += cut_in_words(verdict);
  text += reasons_in_words(verdict);
  if (!verdict.undefined.empty()) {
    std::vector<std::string> names;
    for (const Statistic& s : verdict.undefined) names.push_back(s.name);
    text += fmt::format("Without a value in any run: {}.\n", fmt::join(names, ", "));
  }
  return text + own_changes(verdict);
}

std::string describe_rule(const Verdicts& verdicts) {
  const VerdictOptions& how = verdicts.options;
  std::string text = fmt::format(
      "{} starts{}; also run: {}.\nagrees: the {:g} % interval lies within the margin (of outcomes also "
      "where no "
      "start differs). differs: the gap is\nbeyond it, at {:g} % confidence for all lines of all pairs "
      "together "
      "(from, to). step-dependent: not at half the time\nstep. docs/verdict.md has the rule and the "
      "margins.\n",
      verdicts.starts,
      how.looks > 1 ? fmt::format(", look {} of {} that were planned", verdicts.looks_made, how.looks) : "",
      fmt::join(verdicts.variations, ", "), 100 * (1 - 2 * kEquivalenceTail / static_cast<double>(how.looks)),
      100 * how.confidence);
  for (const std::string& reason : verdicts.left_out) text += fmt::format("Left out: {}.\n", reason);
  return text;
}

}  // namespace crossgait
