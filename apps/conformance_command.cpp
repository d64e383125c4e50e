// crossgait conformance: is this an engine? The checks that every engine is held to, as a card.
#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "crossgait/apps/command.h"
#include "crossgait/backends/registry.h"
#include "crossgait/conformance/card.h"
#include "crossgait/parity/table.h"
#include "crossgait/physics/error.h"

namespace crossgait::apps {
namespace {

struct ConformanceCommand {
  std::string engine;
  std::vector<std::string> only;
  bool list = false;
  JsonOption json;
};

std::vector<const conformance::Check*> chosen_checks(const std::vector<std::string>& only) {
  std::vector<const conformance::Check*> chosen;
  for (const conformance::Check& check : conformance::checks()) {
    if (only.empty() || std::find(only.begin(), only.end(), check.name) != only.end())
      chosen.push_back(&check);
  }
  for (const std::string& name : only) {
    const auto is_it = [&](const conformance::Check* check) { return check->name == name; };
    if (std::none_of(chosen.begin(), chosen.end(), is_it))
      throw ConfigError("command line", "--only", "names of checks (`crossgait conformance --list`)", name);
  }
  return chosen;
}

void run(const ConformanceCommand& options) {
  if (options.list) {
    print(conformance::markdown_of_checks());
    return;
  }
  const std::vector<const conformance::Check*> chosen = chosen_checks(options.only);
  if (options.engine.empty())
    throw ConfigError("command line", "--engine",
                      fmt::format("one of {}", fmt::join(available_engines(), ", ")), "none");
  const conformance::Subject subject = conformance::subject_of(options.engine);
  conformance::Card card{subject.engine.info, {}};
  ProgressLine progress(fmt::format("checking {}", options.engine));
  for (const conformance::Check* check : chosen) {
    card.outcomes.push_back(conformance::run_check(*check, subject));
    progress.update(static_cast<double>(card.outcomes.size()) / static_cast<double>(chosen.size()));
  }
  options.json.emit(describe(card), to_json(card));
  if (const int failed = card.count(conformance::Status::kFailed); failed > 0)
    throw std::runtime_error(
        fmt::format("{}: {} failed", options.engine, counted(static_cast<std::size_t>(failed), "check")));
}

}  // namespace

void add_conformance_command(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("conformance", "Check an engine: analytic truth, contacts, determinism, parity");
  command->footer(
      "\nEvery number that is measured is shown with its bound; a check is skipped only for what the engine\n"
      "declares. Exit code 1 if one fails. docs/adding-an-engine.md says what each proves.\n"
      "\nExamples:\n"
      "  crossgait conformance --engine bullet\n"
      "  CROSSGAIT_ENGINE_PATH=build crossgait conformance --engine skeleton --only free_fall,tumbling\n"
      "  crossgait conformance --list");
  auto options = std::make_shared<ConformanceCommand>();
  CLI::Option* engine = command->add_option("--engine,--backend", options->engine,
                                            "The engine to check, of `crossgait backends`");
  CLI::Option* only =
      command->add_option("--only", options->only, "Only these checks, comma-separated or repeated")
          ->delimiter(',');
  command
      ->add_flag("--list", options->list, "Check nothing: print what the checks are, as a table in Markdown")
      ->excludes(engine)
      ->excludes(only);
  options->json.add_to(*command);
  on_run(*command, [options] { run(*options); });
}

}  // namespace crossgait::apps
