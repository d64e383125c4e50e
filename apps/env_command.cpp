// crossgait env: what an environment's numbers mean.
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/env_options.h"
#include "physics/core/schema.h"
#include "physics/core/table.h"
#include "study/notes.h"

namespace crossgait::apps {
namespace {

using nlohmann::ordered_json;

struct EnvCommand {
  EnvOptions env;
  bool list = false, yaml = false, describe = false;
  JsonOption json;
};

std::string range(const LayoutEntry& entry) {
  return std::isfinite(entry.min) ? fmt::format("{:g} to {:g}", entry.min, entry.max) : "any";
}

std::string layout_table(const std::string& title, const Layout& layout) {
  Table table({"#", title, "unit", "range"});
  for (std::size_t i = 0; i < layout.size(); ++i) {
    const LayoutEntry& entry = layout.entries[i];
    table.add_row({fmt::format("{}", i), entry.name, entry.unit, range(entry)});
  }
  return table.str();
}

ordered_json layout_json(const Layout& layout) {
  ordered_json list = ordered_json::array();
  for (const LayoutEntry& entry : layout.entries) {
    ordered_json row{{"name", entry.name}, {"unit", entry.unit}, {"min", nullptr}, {"max", nullptr}};
    if (std::isfinite(entry.min)) row["min"] = entry.min;
    if (std::isfinite(entry.max)) row["max"] = entry.max;
    list.push_back(row);
  }
  return list;
}

void list_tables(const EnvCommand& options) {
  Table blocks({"observation block", "standard", "what"}),
      terms({"reward term", "unit", "guide's weight", "what"}),
      ranges({"randomisation", "unit", "neutral", "what"});
  ordered_json json{{"observation_blocks", ordered_json::array()},
                    {"reward_terms", ordered_json::array()},
                    {"randomisation", ordered_json::array()}};
  for (const ObservationBlock& block : observation_blocks()) {
    blocks.add_row({std::string(block.name), block.standard ? "yes" : "no", std::string(block.help)});
    json["observation_blocks"].push_back(
        {{"name", block.name}, {"standard", block.standard}, {"help", block.help}});
  }
  for (const RewardTerm& term : reward_terms()) {
    terms.add_row({std::string(term.name), std::string(term.unit), fmt::format("{:g}", term.guide_weight),
                   std::string(term.help)});
    json["reward_terms"].push_back(
        {{"name", term.name}, {"unit", term.unit}, {"guide_weight", term.guide_weight}, {"help", term.help}});
  }
  for (const RandomisationRow& row : randomisation_rows()) {
    const bool off = row.neutral < row.min;
    ranges.add_row({std::string(row.name), std::string(row.unit),
                    off ? "off" : fmt::format("{:g}", row.neutral), std::string(row.help)});
    json["randomisation"].push_back(
        {{"name", row.name}, {"unit", row.unit}, {"min", row.min}, {"max", row.max}, {"help", row.help}});
  }
  options.json.emit(blocks.str() + "\n" + terms.str() + "\n" + ranges.str(), with_schema("env", json));
}

Provenance provenance_of(const EnvCommand& options, const LoadedEnv& environment) {
  return options.json.provenance({{{"behaviour", policy_subject(environment, {"zero"}, 0).at("behaviour")}},
                                  {},
                                  {{"--engine", {environment.config.engine}}}});
}

void describe(const EnvCommand& options, const LoadedEnv& environment) {
  const EnvConfig& config = environment.config;
  const PolicyInterface interface = EnvModel::make(environment)->interface;
  const Layout &action = interface.action, &observation = interface.observation;
  const std::string hash = layout_hash(observation, action);
  const ordered_json json{{"notes", notes_on(environment)},
                          {"layout_version", kLayoutVersion},
                          {"layout_hash", hash},
                          {"policy_dt", config.policy_dt},
                          {"action_size", action.size()},
                          {"observation_size", observation.size()},
                          {"action", layout_json(action)},
                          {"observation", layout_json(observation)}};
  options.json.emit(fmt::format("{} and {} every {:g} ms, layout {} of version {}\n\n{}\n{}",
                                counted(action.size(), "action"), counted(observation.size(), "observation"),
                                1e3 * config.policy_dt, hash, layout_version_in_words(),
                                layout_table("action", action), layout_table("observation", observation)),
                    with_schema("env", json), provenance_of(options, environment));
}

void run(const EnvCommand& options) {
  if (options.list) return list_tables(options);
  const LoadedEnv environment = options.env.make();
  if (options.yaml) {
    const std::string text = to_yaml(EnvModel::make(environment)->resolved());
    return options.json.emit(text, with_schema("env", {{"yaml", text}}), provenance_of(options, environment));
  }
  describe(options, environment);
}

}  // namespace

void add_env_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command = program.add_subcommand(
      "env", "The reinforcement-learning environment: every action and observation by name");
  command->footer(
      "\nExamples:\n"
      "  crossgait env --describe\n"
      "  crossgait env --describe --adapt step_height,step_length --observe terrain,command --json -\n"
      "  crossgait env --list\n"
      "  crossgait env --yaml --terrain rough --gait walk > env.yaml");
  auto options = std::make_shared<EnvCommand>();
  auto* describe_flag =
      command->add_flag("--describe", options->describe, "Print action and observation layout (the default)");
  auto* list_flag =
      command
          ->add_flag("--list", options->list,
                     "List the tables: observation blocks, reward terms, what can be randomised")
          ->excludes(describe_flag);
  command->add_flag("--yaml", options->yaml, "Print the configuration as YAML, every default included")
      ->excludes(describe_flag)
      ->excludes(list_flag);
  options->env.add_to(*command);
  options->json.add_to(*command, invocation);
  on_run(*command, [options] { run(*options); });
}

}  // namespace crossgait::apps
