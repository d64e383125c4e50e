// crossgait score: how well policies do what they are asked, each in each engine.
#include <nlohmann/json.hpp>

#include "apps/scored_policies.h"

namespace crossgait::apps {

void add_score_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command =
      program.add_subcommand("score", "How well policies do what they are asked, each in each engine");
  command->footer(
      "\nWalks each straight ahead, turning and standing, from several starts; the score is that of "
      "`diagnose` "
      "(docs/diagnosis.md).\n\nExamples:\n"
      "  crossgait score serial_joints --engines mujoco,bullet\n"
      "  crossgait score runs/3/policy.safetensors --env runs/3/environment.yaml --json -");
  auto options = std::make_shared<ScoredPoliciesOptions>();
  options->add_to(*command, invocation);
  on_run(*command, [options] {
    const ScoredPolicies scored = score_them(*options);
    options->json.emit(describe(scored.cells), to_json(scored.cells, options->how), scored.provenance);
  });
}

}  // namespace crossgait::apps
