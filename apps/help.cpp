#include "apps/help.h"

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "apps/results.h"
#include "backends/registry.h"
#include "gait/gait.h"
#include "physics/core/text.h"
#include "physics/robot_files/data_path.h"
#include "physics/terrain/terrain.h"
#include "policy/bundled_policies.h"

namespace crossgait::apps {
namespace {

using Names = std::vector<std::string_view>;

// Groups of commands, in the order of `crossgait --help`.
const std::vector<std::pair<const char*, Names>>& command_groups() {
  static const std::vector<std::pair<const char*, Names>> kGroups{
      {"Begin", {"demo", "compare", "walk", "verdict", "course"}},
      {"See", {"view", "report", "video"}},
      {"Policies", {"rollout", "transfer", "import", "tune", "env"}},
      {"Robots, ground, gaits", {"robots", "stand", "terrain", "ik", "gait", "workspace"}},
      {"Engines", {"engines", "conformance", "bench"}}};
  return kGroups;
}

// What is in no group stands behind them.
std::string group_of(const std::string& command) {
  for (const auto& [group, names] : command_groups()) {
    if (std::find(names.begin(), names.end(), command) != names.end()) return group;
  }
  return "Further";
}

// Groups of options, in the order of a command's help; what is in none is the command's own and comes first.
const std::vector<std::pair<const char*, Names>>& option_groups() {
  static const std::vector<std::pair<const char*, Names>> kGroups{
      {"Robot and ground",
       {"--robot", "--robots", "--servos", "--xacro-arg", "--terrain", "--terrain-seed", "--seed",
        "--friction", "--contact"}},
      {"What moves it",
       {"--gait", "--set", "--speed", "--command", "--policy", "--config", "--adapt", "--observe",
        "--residual-scale", "--no-compensation", "--no-heading-hold"}},
      {"Time",
       {"--seconds", "--episode-seconds", "--settle", "--control-dt", "--policy-dt", "--physics-dt",
        "--terminations"}},
      {"Tolerances", {"--position-tolerance", "--joint-tolerance", "--attitude-tolerance"}}};
  return kGroups;
}

struct Type {
  std::string name;   ///< as help has it
  std::string range;  ///< "4 to 10000"; empty without one
};

// CLI11 writes "UINT:INT in [4 - 10000]" or "TEXT:{file,rule}".
Type type_of(const CLI::Option& option) {
  static const std::map<std::string, std::string> kMetavars{
      {"UINT", "N"}, {"UINT64", "N"}, {"INT", "N"}, {"FLOAT", "X"}, {"TEXT", "NAME"}};
  constexpr std::array<std::string_view, 7> kChecks{":INT in [",    ":UINT in [", ":FLOAT in [", ":POSITIVE",
                                                    ":NONNEGATIVE", ":NUMBER",    ":{"};
  std::string name = option.get_type_name(), range;
  for (const std::string_view check : kChecks) {
    const std::size_t at = name.find(check);
    if (at == std::string::npos) continue;
    const std::string said = name.substr(at + 1);
    name.resize(at);
    const std::size_t open = said.find('['), dash = said.find(" - "), close = said.find(']');
    if (open != std::string::npos && dash != std::string::npos && close != std::string::npos)
      range = fmt::format("{} to {}", said.substr(open + 1, dash - open - 1),
                          said.substr(dash + 3, close - dash - 3));
    else if (check == ":POSITIVE")
      range = "above 0";
    break;
  }
  const auto known = kMetavars.find(name);
  return {known == kMetavars.end() ? name : known->second, range};
}

class Help : public CLI::Formatter {
 public:
  Help() { column_width(28); }
  std::string make_option_opts(const CLI::Option* option) const override {
    const std::string value = metavar(*option);
    const bool many = option->get_expected_max() == CLI::detail::expected_max_vector_size;
    return (value.empty() ? "" : " " + value) + (many && !value.empty() ? " ..." : "");
  }
  std::string make_option_desc(const CLI::Option* option) const override { return explanation(*option); }
};

void group_options(CLI::App& command) {
  for (CLI::Option* option : command.get_options()) {
    if (option->get_group() != "Options" || !option->nonpositional()) continue;
    for (const auto& [group, names] : option_groups()) {
      if (std::find(names.begin(), names.end(), option->get_name()) != names.end()) option->group(group);
    }
  }
}

}  // namespace

void set_help_style(CLI::App& program) { program.formatter(std::make_shared<Help>()); }

void group_help(CLI::App& program) {
  for (CLI::App* command : program.get_subcommands([](const CLI::App*) { return true; })) {
    command->group(group_of(command->get_name()));
    group_options(*command);
  }
}

std::string metavar(const CLI::Option& option) {
  return option.get_type_size() == 0 || option.get_items_expected_max() == 0 ? "" : type_of(option).name;
}

std::string explanation(const CLI::Option& option) {
  std::string text = option.get_description();
  if (metavar(option).empty()) return text;
  std::string more = type_of(option).range;
  const std::string preset = option.get_default_str();
  if (!preset.empty()) more += fmt::format("{}default {}", more.empty() ? "" : "; ", preset);
  return more.empty() ? text : fmt::format("{} [{}]", text, more);
}

std::vector<const CLI::App*> commands_of(const CLI::App& program) {
  return program.get_subcommands([](const CLI::App*) { return true; });
}

std::vector<const CLI::Option*> options_of(const CLI::App& command) {
  std::vector<const CLI::Option*> options;
  for (const CLI::Option* option : command.get_options()) {
    if (option->nonpositional()) options.push_back(option);
  }
  return options;
}

std::vector<std::string> values_of(const CLI::Option& option) {
  const std::string name = option.get_name();
  const auto names = [](const auto& rows) {
    std::vector<std::string> all;
    for (const auto& row : rows) all.emplace_back(row.name);
    return all;
  };
  if (name == "--engine" || name == "--engines") return available_engines();
  if (name == "--gait") return names(gaits());
  if (name == "--terrain") return names(terrain_generators());
  if (name == "--robot") return robot_names();
  if (name == "--policy") {
    std::vector<std::string> policies = policy_names();
    policies.insert(policies.end(), {"zero", "random"});
    return policies;
  }
  // What is spelled out: "file|rule".
  const std::string type = metavar(option);
  std::vector<std::string> spelled;
  if (type.find('|') == std::string::npos ||
      type.find_first_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ[,:") != std::string::npos)
    return spelled;
  for (const std::string_view part : parts_of(type, "|")) spelled.emplace_back(part);
  return spelled;
}

}  // namespace crossgait::apps
