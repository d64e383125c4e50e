// What is written of the statistics of a motion (schemas, tables of the documents) is what their rows say.
// CROSSGAIT_WRITE_DOCUMENTS=1 writes it anew.
#include <cstdlib>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "motion/statistic_rows.h"

namespace crossgait {
namespace {

using nlohmann::ordered_json;

std::string in_tree(const std::string& path) { return std::string(CROSSGAIT_SOURCE_DIR) + "/" + path; }

std::string text_at(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(in_tree(path)).rdbuf();
  return text.str();
}

/// Compares a file with what it should be, or writes that.
void hold(const std::string& path, const std::string& expected) {
  // NOLINTNEXTLINE(concurrency-mt-unsafe): one thread
  if (std::getenv("CROSSGAIT_WRITE_DOCUMENTS") != nullptr) std::ofstream(in_tree(path)) << expected;
  EXPECT_EQ(text_at(path), expected) << path << ": CROSSGAIT_WRITE_DOCUMENTS=1 writes it anew";
}

ordered_json number_or_null() { return {{"type", {"number", "null"}}}; }

/// The JSON Schema of a value.
struct SchemaOf {
  ordered_json operator()(double MotionSummary::*) const { return {{"type", "number"}}; }
  ordered_json operator()(std::optional<double> MotionSummary::*) const { return number_or_null(); }
  ordered_json operator()(std::int64_t MotionSummary::*) const { return {{"type", "integer"}}; }
  ordered_json operator()(LegArray<double> MotionSummary::*) const {
    ordered_json schema{{"type", "object"}};
    for (const Leg leg : kLegs) {
      schema["properties"][std::string(name(leg))] = {{"type", "number"}};
      schema["required"].push_back(name(leg));
    }
    schema["additionalProperties"] = false;
    return schema;
  }
  ordered_json operator()(Vector3 MotionSummary::*) const {
    return {{"type", "array"}, {"items", {{"type", "number"}}}};
  }
  ordered_json operator()(OutcomeHeld) const { return {{"type", "boolean"}}; }
  ordered_json operator()(OutcomeTime) const { return number_or_null(); }
};

ordered_json described(ordered_json schema, std::string_view help) {
  schema["description"] = help;
  return schema;
}

/// The JSON Schema of the average of a row over episodes.
ordered_json average_schema(const StatisticRow& row) {
  if (row.average.how == OverEpisodes::kSum) return described({{"type", "integer"}}, row.help);
  ordered_json mean{{"$ref", "#/definitions/mean_and_deviation"}};
  if (!std::holds_alternative<std::optional<double> MotionSummary::*>(row.source)) return mean;
  return described({{"oneOf", ordered_json::array({{{"type", "null"}}, mean})}}, row.help);
}

/// Defines an object with these keys, all of them required, and the list of the keys.
void define(const std::string& name, const ordered_json& properties, ordered_json& definitions) {
  ordered_json keys = ordered_json::array();
  for (const auto& [key, schema] : properties.items()) keys.push_back(key);
  definitions[name] = {{"type", "object"}, {"properties", properties}, {"required", keys}};
  definitions[name + "_keys"] = {{"enum", keys}};
}

TEST(StatisticDocuments, SharedDefinitionsOfSchemasFollowTheTable) {
  ordered_json outcomes, motion, averages;
  for (const OutcomeRow& row : outcome_rows()) outcomes["enum"].push_back(row.name);
  motion["outcome"] = described(outcomes, "the worst outcome that holds");
  motion["outcome_at_s"] =
      described(number_or_null(), "when it first held, s; null for what is known at the end alone");
  for (const StatisticRow& row : statistic_rows())
    motion[std::string(row.key)] = described(std::visit(SchemaOf(), row.source), row.help);
  for (const StatisticRow* row : averaged_statistics())
    averages[std::string(row->key)] = average_schema(*row);
  ordered_json json{{"$schema", "http://json-schema.org/draft-07/schema#"},
                    {"title", "statistics of a motion, and their averages over episodes"},
                    {"$comment", "made from motion/statistic_rows.cpp by tests/motion"}};
  define("motion", motion, json["definitions"]);
  define("averages", averages, json["definitions"]);
  json["definitions"]["mean_and_deviation"] = {
      {"type", "object"},
      {"properties", {{"mean", {{"type", "number"}}}, {"deviation", {{"type", "number"}}}}},
      {"required", {"mean", "deviation"}},
      {"additionalProperties", false}};
  hold("docs/schemas/definitions/motion.json", json.dump(1) + "\n");
}

/// Expects a document to have `table` between the two marks, of which the first names where it comes from.
void hold_table(const std::string& path, const std::string& table,
                const std::string& source = "motion/statistic_rows.cpp") {
  const std::string begin = "<!-- " + source + " -->\n", end = "<!-- end -->";
  const std::string text = text_at(path);
  const std::size_t from = text.find(begin), to = text.find(end, from);
  ASSERT_NE(from, std::string::npos) << path;
  ASSERT_NE(to, std::string::npos) << path;
  hold(path, text.substr(0, from) + begin + "\n" + table + "\n" + text.substr(to));
}

TEST(StatisticDocuments, EveryKeyIsInTheTableOfStatistics) {
  std::string table = "| key | unit | meaning | over episodes |\n|---|---|---|---|\n";
  for (const StatisticRow& row : statistic_rows()) {
    const char* over[] = {"", "mean and deviation", "sum"};
    table += fmt::format("| `{}` | {} | {} | {} |\n", row.key, row.unit, row.help,
                         over[static_cast<int>(row.average.how)]);
  }
  hold_table("docs/statistics.md", table);
}

TEST(StatisticDocuments, EveryOutcomeIsInTheTableOfOutcomes) {
  std::string table = "| outcome | holds when | because | ends, unless told otherwise |\n|---|---|---|---|\n";
  for (const OutcomeRow& row : outcome_rows()) {
    const bool walks = OutcomeSet::of_walks().has(row.outcome),
               episodes = OutcomeSet::of_episodes().has(row.outcome);
    table += fmt::format("| `{}` | {} | {} | {} |\n", row.name, row.holds(OutcomeLimits()), row.reason,
                         walks      ? "walks and episodes"
                         : episodes ? "episodes"
                                    : "");
    EXPECT_TRUE(episodes || !walks) << row.name;
  }
  hold_table("docs/statistics.md", table, "motion/outcome.cpp");
}

TEST(StatisticDocuments, EveryMarginIsInTheTableOfVerdicts) {
  std::string table = "| key | statistic | margin: the larger of | which is |\n|---|---|---|---|\n";
  for (const StatisticRow* row : judged_statistics()) {
    const StatisticJudged& judged = row->judged;
    const char* scale[] = {"", " by length", " by speed"};
    std::string margin =
        judged.relative_margin > 0 ? fmt::format("{:g} %, ", 100 * judged.relative_margin) : "";
    margin += fmt::format("{:g}", judged.absolute_margin);
    if (row->unit != "-") margin += fmt::format(" {}", row->unit);
    if (judged.per_second) margin += " a second";
    table += fmt::format("| `{}` | {}{} | {}{} | {} |\n", row->key, judged.name,
                         judged.needs_plan ? ", where a gait plans swing and stance" : "", margin,
                         scale[static_cast<int>(judged.scale)], judged.reason);
  }
  hold_table("docs/verdict-rule.md", table);
}

TEST(StatisticRows, StandBeforeEarlierRowsAlone) {
  const auto places = [](const std::vector<const StatisticRow*>& rows, auto before) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const std::string_view key = before(*rows[i]);
      if (key.empty()) continue;
      bool found = false;
      for (std::size_t k = i + 1; k < rows.size(); ++k) found = found || rows[k]->key == key;
      EXPECT_TRUE(found) << rows[i]->key << " before " << key;
    }
  };
  places(shown_statistics(), [](const StatisticRow& r) { return r.text.before; });
  places(judged_statistics(), [](const StatisticRow& r) { return r.judged.before; });
  places(averaged_statistics(), [](const StatisticRow& r) { return r.average.before; });
}

TEST(StatisticRows, AreFoundByTheirMemberAndHaveAKeyAndAMeaningOfTheirOwn) {
  for (const StatisticRow& row : statistic_rows()) {
    EXPECT_EQ(&statistic_row(row.source), &row) << row.key;
    EXPECT_FALSE(row.key.empty() || row.help.empty() || row.unit.empty());
    for (const StatisticRow& other : statistic_rows()) EXPECT_TRUE(&other == &row || other.key != row.key);
    const bool count = std::holds_alternative<std::int64_t MotionSummary::*>(row.source);
    EXPECT_TRUE(count || row.average.how != OverEpisodes::kSum) << row.key;
    EXPECT_TRUE(!row.average.digits || !row.text.label.empty()) << row.key;
    EXPECT_EQ(row.judged.name.empty(), row.judged.reason.empty()) << row.key;
  }
  EXPECT_THROW(statistic_row(&MotionSummary::wall_seconds), std::logic_error);
}

}  // namespace
}  // namespace crossgait
