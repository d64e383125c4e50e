// crossgait backends: which engines this build can use.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crossgait/apps/command.h"
#include "crossgait/backends/registry.h"
#include "crossgait/parity/table.h"

namespace crossgait::apps {
namespace {

void run(const JsonOption& json) {
  Table table({"name", "engine", "contact", ""});
  nlohmann::ordered_json entries = nlohmann::ordered_json::array();
  for (const EngineListing& entry : known_engines()) {
    nlohmann::ordered_json object{
        {"name", entry.name}, {"summary", entry.summary}, {"available", entry.available}};
    if (entry.available) {
      const EngineInfo info = find_engine(entry.name).info;
      table.add_row({entry.name, info.engine + " " + info.version, info.mode, "available"});
      object["engine"] = info.engine;
      object["version"] = info.version;
      object["mode"] = info.mode;
      object["contact_law"] = info.laws.contact;
      object["loop_law"] = info.laws.loops;
      object["capabilities"] = {{"soft_contact", info.capabilities.soft_contact},
                                {"exact_field_query", info.capabilities.exact_field_query}};
    } else {
      table.add_row({entry.name, "", "", "not built in: " + entry.reason});
      object["reason"] = entry.reason;
    }
    entries.push_back(std::move(object));
  }
  std::string text = table.str();
  nlohmann::ordered_json families = nlohmann::ordered_json::array();
  for (const EngineFamily& family : engine_families()) {
    text += fmt::format("\nBetween {0} and {1}, e.g. {0}+{2} or {1}-{3}:\n", family.from, family.to,
                        family.factors.front().name, family.factors.back().name);
    nlohmann::ordered_json factors = nlohmann::ordered_json::array();
    for (const ModelFactor& i : family.factors) {
      text += fmt::format("  {:14} {}\n", i.name, i.summary);
      factors.push_back({{"name", i.name}, {"summary", i.summary}, {"needs", i.needs}});
    }
    families.push_back({{"from", family.from}, {"to", family.to}, {"factors", factors}});
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
