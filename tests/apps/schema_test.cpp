// What the commands print as JSON is what docs/schemas promises: every key is there, none beside them.
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include "backends/registry.h"
#include "report/page_template.h"
#include "tests/apps/run_program.h"

namespace crossgait {
namespace {

using nlohmann::json;
using Adapter = valijson::adapters::NlohmannJsonAdapter;

json read_schema_file(const std::string& path) {
  std::ifstream file(std::string(CROSSGAIT_SOURCE_DIR) + "/docs/schemas/" + path);
  return json::parse(file);
}

/// An object made of parts as one object that is closed for the names it allows: valijson lets any name pass
/// `propertyNames`.
json closed(json object) {
  for (const json& part : object.at("allOf")) {
    object["properties"].update(part.at("properties"));
    for (const json& key : part.at("required")) object["required"].push_back(key);
  }
  std::set<std::string> allowed;
  for (const json& names : object.at("propertyNames").at("anyOf"))
    for (const json& key : names.at("enum")) allowed.insert(key.get<std::string>());
  for (const auto& [key, schema] : object["properties"].items())
    EXPECT_EQ(allowed.erase(key), 1U) << key << " is not among the names";
  EXPECT_EQ(allowed.size(), 0U) << "names without a property";
  object.erase("allOf");
  object.erase("propertyNames");
  object["additionalProperties"] = false;
  return object;
}

/// `schema` with what it refers to in its place: valijson does not follow relative references from one file
/// into a second. @param root the document that it stands in; @param folder that document's
json without_references(const json& schema, const json& root, const std::string& folder) {
  if (schema.is_object() && schema.contains("$ref")) {
    const auto reference = schema["$ref"].get<std::string>();
    const std::string file = reference.substr(0, reference.find('#'));
    const json::json_pointer place(reference.substr(reference.find('#') + 1));
    if (file.empty()) return without_references(root.at(place), root, folder);
    const json other = read_schema_file(folder + file);
    return without_references(other.at(place), other, "definitions/");
  }
  json result = schema;
  if (schema.is_structured()) {
    for (json& part : result) part = without_references(part, root, folder);
  }
  return result.is_object() && result.contains("propertyNames") ? closed(result) : result;
}

json read_schema(const std::string& name) {
  const json schema = read_schema_file(name + ".json");
  return without_references(schema, schema, "");
}

/// What is wrong with `value`, by place; empty if nothing is.
std::string violations(const json& schema_json, const json& value) {
  valijson::Schema schema;
  valijson::SchemaParser().populateSchema(Adapter(schema_json), schema);
  valijson::ValidationResults results;
  if (valijson::Validator().validate(schema, Adapter(value), &results)) return {};
  std::string text;
  valijson::ValidationResults::Error error;
  while (results.popError(error)) {
    for (const std::string& place : error.context) text += place;
    text += ": " + error.description + "\n";
  }
  return text;
}

struct Case {
  std::string schema, arguments;
};

std::vector<Case> cases() {
  const std::vector<std::string> engines = available_engines();
  if (engines.empty()) return {};
  const std::string two = "--engines " + engines.front() + "," + engines.back();
  std::vector<Case> all{
      {"walk", "walk --seconds .1"},
      {"walk", "walk --seconds .1 --gait auto --speed 0"},  // cost of transport and drag are null
      {"walk", "walk --seconds .2 --terrain slope:angle=45 --friction 0"},
      {"rollout", "rollout --policy random --baseline --episodes 2 --episode-seconds .1"},
      {"rollout", "rollout --episodes 1 --episode-seconds .05 --command 0,0,0"},
      {"transfer", "transfer --episodes 1 --episode-seconds .1"},
      {"course", "course --sections speed-1.0,pushed --episodes 1"},
      {"diagnose", "diagnose serial_joints --engine " + engines.front()},
      {"matrix",
       "matrix serial_joints --starts 2 --seconds 1.5 --engines " + engines.front() + "," + engines.back()},
      {"score", "score serial_joints --starts 2 --seconds 1.5 --engines " + engines.front()},
      {"tune", "tune --iterations 1 --population 4 --terrains 1 --unseen 1 --episode-seconds .1"},
      {"engines", "engines"},
      {"conformance", "conformance --only free_fall,soft_friction,hard_friction --engine " + engines.front()},
      {"robots", "robots"},
      {"robots", "robots scara_quadruped"},
      {"terrain", "terrain --list"},
      {"terrain", "terrain rough --sample .1,.2 --ring 0,0,1"},
      {"terrain", "terrain flat"},
      {"terrain", "terrain " CROSSGAIT_SOURCE_DIR "/models/terrains/bumps.png:z_max=.1"},
      {"ik", "ik --target .01,.02,-.07"},
      {"ik", "ik --target .01,.02,-.7"},
      {"ik", "ik --robot serial_quadruped --target 0,0,-.3"},
      {"robots", "robots serial_quadruped"},
      {"robots", "robots serial_quadruped --check"},
      {"robots", "robots serial_quadruped --against scara_quadruped"},
      {"stand", "stand --robot serial_quadruped --seconds .5"},
      {"gait", "gait --list"},
      {"gait", "gait --parameters"},
      {"gait", "gait --seconds .1"},
      {"workspace", "workspace"},
      {"workspace", "workspace --gait trot --set step_length=.1 --set body_height=.04"},
      {"env", "env"},
      {"env", "env --list"},
      {"env", "env --yaml"},
      {"bench", "bench --quick --only analytic --engines " + engines.front()},
  };
  all.push_back(
      {"verdict", "verdict --seconds .1 --starts 4 --explain --against friction=0.3,kp=x0.5 --engines " +
                      engines.front()});
  if (engines.size() > 1) {
    all.push_back({"compare", "compare --seconds .1 " + two});
    all.push_back({"compare", "compare --seconds .1 --verdict " + two});
    all.push_back({"verdict", "verdict --seconds .1 --starts 4 " + two});
    all.push_back({"verdict", "verdict --seconds .1 --starts 4 --policy zero " + two});
  }
  if (engines.size() > 2) {
    all.push_back({"verdict", "verdict --seconds .1 --starts 4 --engines " + engines[0] + "," + engines[1] +
                                  "," + engines[2]});
  }
  return all;
}

class Schemas : public testing::TestWithParam<Case> {};

TEST_P(Schemas, HoldForWhatIsPrinted) {
  const auto& [name, arguments] = GetParam();
  const json value = run_json(arguments);
  EXPECT_EQ(violations(read_schema(name), value), "") << arguments;
  EXPECT_EQ(value.begin().key().empty(), false);
  EXPECT_EQ(value.at("schema").at("name"), name);
}

// The test itself can fail: a key that goes or comes, and another version, are seen.
TEST_P(Schemas, RefuseAnythingElse) {
  const auto& [name, arguments] = GetParam();
  const json schema = read_schema(name), value = run_json(arguments);
  json more = value, less = value, other = value;
  more["key_of_nobody"] = 1;
  less.erase("schema");
  other["schema"]["version"] = 99;
  for (const json& wrong : {more, less, other}) EXPECT_NE(violations(schema, wrong), "");
}

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Schemas);
INSTANTIATE_TEST_SUITE_P(EveryCommand, Schemas, testing::ValuesIn(cases()), [](const auto& test) {
  return test.param.schema + "_" + std::to_string(test.index);
});

TEST(SchemaFiles, HoldForTheDocumentOfAPage) {
  if (page_template().empty() || available_engines().empty()) GTEST_SKIP() << "no page, or no engine";
  ASSERT_EQ(run_program("compare --seconds .1 --terrain rough --verdict --report schema_page.html").exit_code,
            0);
  json document = document_of("schema_page.html");
  EXPECT_EQ(violations(read_schema("report"), document), "");
  document["motions"][0]["runs"][0].erase("poses");
  EXPECT_NE(violations(read_schema("report"), document), "");
}

TEST(SchemaFiles, HoldForTheDocumentsOfCharts) {
  if (page_template().empty()) GTEST_SKIP() << "no page";
  const std::string stored = CROSSGAIT_SOURCE_DIR "/benchmarks/results/amd-epyc-2-cores.json";
  for (const std::string& command :
       std::vector<std::string>{"workspace", "gait --gait gallop", "bench --from " + stored}) {
    ASSERT_EQ(run_program(command + " --report schema_charts.html").exit_code, 0) << command;
    json document = document_of("schema_charts.html");
    EXPECT_EQ(violations(read_schema("report"), document), "") << command;
    document["charts"][0]["charts"][0]["series"][0]["style"] = "stars";
    EXPECT_NE(violations(read_schema("report"), document), "") << command;
  }
}

TEST(SchemaFiles, HoldForTheDocumentOfMarksAndIntervals) {
  if (page_template().empty() || available_engines().empty()) GTEST_SKIP() << "no page, or no engine";
  ASSERT_EQ(run_program("course --sections speed-1.0 --episodes 1 --report schema_marks.html").exit_code, 0);
  json document = document_of("schema_marks.html");
  EXPECT_EQ(violations(read_schema("report"), document), "");
  EXPECT_EQ(document["motions"][0]["name"], "speed-1.0");
  EXPECT_FALSE(document["tables"][1]["intervals"].is_null());
  document["tables"][0]["marks"][0][0] = "fine";
  EXPECT_NE(violations(read_schema("report"), document), "");
}

TEST(SchemaFiles, AreOfTheStoredResultsToo) {
  std::ifstream file(std::string(CROSSGAIT_SOURCE_DIR) + "/benchmarks/results/amd-epyc-2-cores.json");
  EXPECT_EQ(violations(read_schema("bench"), json::parse(file)), "");
}

}  // namespace
}  // namespace crossgait
