// crossgait conformance: is this an engine? The checks that every engine is held to, as a card.
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "backends/registry.h"
#include "conformance/card.h"
#include "physics/core/error.h"
#include "physics/core/table.h"

namespace crossgait::apps {
namespace {

struct ConformanceCommand {
  std::string engine;
  std::vector<std::string> only;
  bool list = false;
  JsonOption json;
};

void run(const ConformanceCommand& options) {
  if (options.list) {
    print(conformance::markdown_of_checks(conformance::topics()));
    return;
  }
  if (options.engine.empty())
    throw ConfigError("command line", "--engine",
                      fmt::format("one of {}", fmt::join(available_engines(), ", ")), "none");
  ProgressLine progress(fmt::format("checking {}", options.engine));
  const conformance::Card card =
      conformance::check_engine(options.engine, options.only, [&](double share) { progress.update(share); });
  options.json.emit(describe(card), to_json(card));
  if (const int failed = card.count(conformance::Status::kFailed); failed > 0)
    throw std::runtime_error(
        fmt::format("{}: {} failed", options.engine, counted(static_cast<std::size_t>(failed), "check")));
}

}  // namespace

void add_conformance_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command =
      program.add_subcommand("conformance", "Check an engine: analytic truth, contacts, determinism, parity");
  command->footer(
      "\nEvery number that is measured is shown with its bound; a check is skipped only for what the engine\n"
      "declares. Exit code 1 if one fails. docs/generated/checks-*.md say what each proves.\n"
      "\nExamples:\n"
      "  crossgait conformance --engine bullet\n"
      "  CROSSGAIT_ENGINE_PATH=build crossgait conformance --engine skeleton --only free_fall,tumbling\n"
      "  crossgait conformance --list");
  auto options = std::make_shared<ConformanceCommand>();
  CLI::Option* engine =
      command->add_option("--engine", options->engine, "The engine to check, of `crossgait engines`");
  CLI::Option* only =
      command->add_option("--only", options->only, "Only these checks, comma-separated or repeated")
          ->delimiter(',');
  command
      ->add_flag("--list", options->list, "Check nothing: print what the checks are, as tables in Markdown")
      ->excludes(engine)
      ->excludes(only);
  options->json.add_to(*command, invocation);
  on_run(*command, [options] { run(*options); });
}

}  // namespace crossgait::apps
