// crossgait engines: which engines there are, where each came from, and why one cannot be used.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "backends/registry.h"
#include "physics/core/schema.h"
#include "physics/core/table.h"

namespace crossgait::apps {
namespace {

/// What is not known of an engine that is not available is an empty text.
nlohmann::ordered_json to_json(const EngineListing& entry) {
  return {{"name", entry.name},
          {"summary", entry.summary},
          {"library", entry.info.library},
          {"version", entry.info.version},
          {"mode", entry.info.mode},
          {"contact_law", entry.info.laws.contact},
          {"loop_law", entry.info.laws.loops},
          {"joint_friction_law", entry.info.laws.joint_friction},
          {"joint_limit_law", entry.info.laws.joint_limits},
          {"coupling_law", entry.info.laws.couplings},
          {"implicit_servo_law", entry.info.laws.implicit_servos},
          {"capabilities",
           {{"soft_contact", entry.info.capabilities.soft_contact},
            {"soft_friction", entry.info.capabilities.soft_friction},
            {"turning_friction", entry.info.capabilities.turning_friction},
            {"pyramidal_cone", entry.info.capabilities.pyramidal_cone},
            {"error_reduction", entry.info.capabilities.error_reduction},
            {"sweeps", entry.info.capabilities.sweeps},
            {"exact_field_query", entry.info.capabilities.exact_field_query},
            {"allocates", entry.info.capabilities.allocates},
            {"precision", name_of(entry.info.capabilities.precision)}}},
          {"file", entry.file},
          {"available", entry.available},
          {"reason", entry.reason}};
}

// Of one factor both ends have names already.
std::string examples_of(const EngineFamily& family) {
  if (family.factors.size() < 2) return "";
  return fmt::format(", e.g. {}+{} or {}-{}", family.from, family.factors.front().name, family.to,
                     family.factors.back().name);
}

void run(const JsonOption& json) {
  Table table({"name", "library", "contact", "plug-in"});
  std::string refused;
  nlohmann::ordered_json entries = nlohmann::ordered_json::array();
  for (const EngineListing& entry : known_engines()) {
    entries.push_back(to_json(entry));
    if (entry.available) {
      table.add_row({entry.name, entry.info.library + " " + entry.info.version, entry.info.mode, entry.file});
    } else {
      refused += fmt::format("  {}{}: {}\n", entry.name, entry.file.empty() ? "" : " of " + entry.file,
                             entry.reason);
    }
  }
  std::string text = table.str();
  if (!refused.empty()) text += "\nNot available:\n" + refused;
  nlohmann::ordered_json families = nlohmann::ordered_json::array();
  for (const EngineFamily& family : engine_families()) {
    text += fmt::format("\nBetween {} and {}{}:\n", family.from, family.to, examples_of(family));
    nlohmann::ordered_json factors = nlohmann::ordered_json::array();
    for (const ModelFactor& i : family.factors) {
      text += fmt::format("  {:19} {}\n", i.name, i.summary);
      factors.push_back({{"name", i.name}, {"summary", i.summary}, {"needs", i.needs}});
    }
    families.push_back({{"from", family.from}, {"to", family.to}, {"factors", factors}});
  }
  json.emit(text,
            with_schema("engines", {{"engines", std::move(entries)}, {"families", std::move(families)}}));
}

}  // namespace

void add_engines_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command =
      program.add_subcommand("engines", "List the physics engines, where they are, and why one is missing");
  command->footer(
      "\nEngines are plug-ins, libcrossgait_engine_<name>.so. Those in the folders that the environment\n"
      "variable CROSSGAIT_ENGINE_PATH lists, separated by colons, come before the ones of the installation.\n"
      "Beside them python:FILE.py is the engine that a Python file serves in a process of its own, and\n"
      "python:drake, python:mujoco_warp, python:newton and python:newton_kamino are those of Crossgait's\n"
      "package (docs/engines-in-processes.md).");
  auto json = std::make_shared<JsonOption>();
  json->add_to(*command, invocation);
  on_run(*command, [json] { run(*json); });
}

}  // namespace crossgait::apps
