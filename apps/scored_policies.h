// What `score` and `matrix` ask for: policies, each in the environment that it was made for, in some engines.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/policy_score.h"

#include "apps/command.h"

namespace crossgait::apps {

struct ScoredPoliciesOptions {
  std::vector<std::string> policies, engines, trained_in;
  std::string env, agent;
  PolicyScoreOptions how;
  JsonOption json;

  /// @returns the option that names the policies
  CLI::Option* add_to(CLI::App& command, Invocation& invocation);
};

/// Holds what came of them.
struct ScoredPolicies {
  std::vector<ScoredPolicy> policies;
  std::vector<std::string> engines;
  std::vector<PolicyCell> cells;
  Provenance provenance;
};

/// Reads the policies. @throws ConfigError
ScoredPolicies read_scored(const ScoredPoliciesOptions& options);
/// Notes how their result is made: what `JsonOption` writes beside it. @throws ConfigError
void note_provenance(const ScoredPoliciesOptions& options, ScoredPolicies& scored);
/// Walks each in every engine, with its progress. @throws ConfigError
ScoredPolicies score_them(ScoredPolicies scored, const PolicyScoreOptions& how);
/// Does all three. @throws ConfigError
ScoredPolicies score_them(const ScoredPoliciesOptions& options);

}  // namespace crossgait::apps
