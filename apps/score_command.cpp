// crossgait score: how well policies do what they are asked, each in each engine.
#include <nlohmann/json.hpp>

#include "apps/score_server.h"
#include "apps/scored_policies.h"
#include "physics/core/error.h"

namespace crossgait::apps {

void add_score_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command =
      program.add_subcommand("score", "How well policies do what they are asked, each in each engine");
  command->footer(
      "\nWalks each straight ahead, turning and standing, from several starts; the score is that of "
      "`diagnose` "
      "(docs/diagnosis.md).\n\nExamples:\n"
      "  crossgait score serial_joints --engines mujoco,bullet\n"
      "  crossgait score runs/3/policy.safetensors --env runs/3/environment.yaml --json -\n"
      "  crossgait score logs/model_1500.pt --env walk/environment.yaml --engines mujoco\n"
      "  echo '{\"policy\": \"serial_joints\"}' | crossgait score --serve --engines mujoco");
  auto options = std::make_shared<ScoredPoliciesOptions>();
  CLI::Option* policies = options->add_to(*command, invocation);
  auto serve = std::make_shared<bool>(false);
  command
      ->add_flag(
          "--serve", *serve,
          "Answer a running training: for every line {\"policy\": FILE, \"env\": FILE} of standard input "
          "a line with its cells, or its error")
      ->excludes(policies)
      ->excludes("--json");
  on_run(*command, [options, serve] {
    if (*serve) return serve_scores(*options);
    if (options->policies.empty())
      throw ConfigError("command line", "policies", "one to score, or --serve", "none");
    const ScoredPolicies scored = score_them(*options);
    options->json.emit(describe(scored.cells), to_json(scored.cells, options->how), scored.provenance);
  });
}

}  // namespace crossgait::apps
