// crossgait backends: which engines this build can use.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crossgait/apps/command.h"
#include "crossgait/backends/registry.h"
#include "crossgait/parity/table.h"
#include "crossgait/physics/data_path.h"

namespace crossgait::apps {
namespace {

void run(const JsonOption& json) {
  WorldSpec spec;
  spec.robot = std::make_shared<const RobotDescription>(load_robot(find_robot("scara_quadruped")));
  Table table({"name", "engine", "contact", ""});
  nlohmann::ordered_json entries = nlohmann::ordered_json::array();
  for (const BackendEntry& entry : known_backends()) {
    nlohmann::ordered_json object{
        {"name", entry.name}, {"summary", entry.summary}, {"available", entry.available}};
    if (entry.available) {
      const BackendInfo info = make_backend(entry.name, spec)->info();
      table.add_row({entry.name, info.engine + " " + info.version, info.mode, "available"});
      object["engine"] = info.engine;
      object["version"] = info.version;
      object["mode"] = info.mode;
      object["capabilities"] = {{"soft_contact", info.capabilities.soft_contact},
                                {"matches_mujoco", info.capabilities.matches_mujoco},
                                {"exact_field_query", info.capabilities.exact_field_query}};
    } else {
      table.add_row({entry.name, "", "", "not built in: " + entry.reason});
      object["reason"] = entry.reason;
    }
    entries.push_back(std::move(object));
  }
  std::string text = table.str();
  nlohmann::ordered_json families = nlohmann::ordered_json::array();
  for (const BackendFamily& family : backend_families()) {
    text += fmt::format("\nBetween {0} and {1}, e.g. {0}+{2} or {1}-{3}:\n", family.from, family.to,
                        family.ingredients.front().name, family.ingredients.back().name);
    nlohmann::ordered_json ingredients = nlohmann::ordered_json::array();
    for (const BackendIngredient& i : family.ingredients) {
      text += fmt::format("  {:14} {}\n", i.name, i.summary);
      ingredients.push_back({{"name", i.name}, {"summary", i.summary}, {"needs", i.needs}});
    }
    families.push_back({{"from", family.from}, {"to", family.to}, {"ingredients", ingredients}});
  }
  json.emit(text, {{"backends", std::move(entries)}, {"families", std::move(families)}});
}

}  // namespace

void add_backends_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand("backends", "List the physics engines that this build can use");
  auto json = std::make_shared<JsonOption>();
  json->add_to(*command);
  command->callback([json] { run(*json); });
}

}  // namespace crossgait::apps
