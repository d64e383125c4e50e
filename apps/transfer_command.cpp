// crossgait transfer: one policy in every engine on every ground.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crossgait/apps/env_options.h"
#include "crossgait/backends/registry.h"
#include "crossgait/parity/table.h"

namespace crossgait::apps {
namespace {

struct Options {
  EnvOptions env;
  std::string policy = "zero";
  std::vector<std::string> engines, terrains = {"flat", "rough", "waves"};
  EpisodeOptions runs;
  JsonOption json;
};

struct Cell {
  std::string terrain, engine;
  Evaluation policy, baseline;
};

std::string speed(const Evaluation& e) {
  const std::size_t ended = e.falls + e.diverged + e.left_terrain;
  return fmt::format("{:.4f}{}", e.speed.mean, ended > 0 ? fmt::format(" ({})", outcome(e)) : "");
}

std::string describe(const Options& options, const std::vector<std::string>& engines,
                     const std::vector<Cell>& cells) {
  std::vector<std::string> header{"mean speed, m/s", "policy"};
  header.insert(header.end(), engines.begin(), engines.end());
  header.emplace_back("largest / smallest");
  Table table(header);
  const auto add = [&](const std::string& terrain, const std::string& policy, Evaluation Cell::*which) {
    std::vector<std::string> row{terrain, policy};
    double low = 0, high = 0;
    bool first = true;
    for (const Cell& cell : cells) {
      if (cell.terrain != terrain) continue;
      const double value = (cell.*which).speed.mean;
      low = first ? value : std::min(low, value);
      high = first ? value : std::max(high, value);
      first = false;
      row.push_back(speed(cell.*which));
    }
    row.push_back(low > 0 ? fmt::format("{:.3f}", high / low) : "-");
    table.add_row(row);
  };
  for (const std::string& terrain : options.terrains) {
    add(terrain, short_name(options.policy), &Cell::policy);
    if (options.policy != "zero") add(terrain, "zero", &Cell::baseline);
  }
  return table.str();
}

void run(const Options& options) {
  const std::vector<std::string> engines = options.engines.empty() ? available_engines() : options.engines;
  const EnvConfig base = options.env.make();
  std::vector<Cell> cells;
  ProgressLine progress("transferring");
  const double all = static_cast<double>(options.terrains.size() * engines.size());
  for (const std::string& terrain : options.terrains) {
    for (const std::string& engine : engines) {
      EnvConfig config = base;
      config.terrain = terrain;
      config.backend = engine;
      const auto evaluate = [&](const std::string& policy) {
        return sum_up(evaluate_policy(env_factory(config), policy_factory(policy), options.runs.episodes,
                                      options.runs.seed, options.runs.workers));
      };
      Cell cell{terrain, engine, evaluate(options.policy), {}};
      cell.baseline = options.policy == "zero" ? cell.policy : evaluate("zero");
      cells.push_back(std::move(cell));
      progress.update(static_cast<double>(cells.size()) / all);
    }
  }
  nlohmann::ordered_json json{{"policy", options.policy}, {"seed", options.runs.seed}};
  for (const Cell& cell : cells) {
    json["cells"].push_back({{"terrain", cell.terrain},
                             {"backend", cell.engine},
                             {"policy", to_json(cell.policy)},
                             {"baseline", to_json(cell.baseline)}});
  }
  options.json.emit(describe(options, engines, cells), json);
}

}  // namespace

void add_transfer_command(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("transfer", "One policy in every engine on every ground: does it carry over?");
  command->footer(
      "\nExamples:\n"
      "  crossgait transfer --policy policy.safetensors --config env.yaml\n"
      "  crossgait transfer --terrains flat rough stairs:rise=.005,run=.1 --engines mujoco,bullet --episodes "
      "5 --json -");
  auto options = std::make_shared<Options>();
  command->add_option("--policy", options->policy, "zero, random, or a file (docs/policies.md)")
      ->type_name("zero|random|FILE.safetensors|FILE.yaml")
      ->capture_default_str();
  command->add_option("--engines", options->engines, "Comma-separated; all that are built in by default")
      ->delimiter(',');
  command
      ->add_option("--terrains", options->terrains,
                   "Separated by blanks or semicolons (a terrain's own text has commas)")
      ->delimiter(';')
      ->capture_default_str();
  options->runs.add_to(*command);
  options->env.add_to(*command, false);
  options->json.add_to(*command);
  command->callback([options] { run(*options); });
}

}  // namespace crossgait::apps
