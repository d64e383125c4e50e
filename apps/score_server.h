// Scores for a training that goes on: a line asks for one, a line answers.
#pragma once

#include "apps/scored_policies.h"

namespace crossgait::apps {

/// Reads lines of JSON from standard input, {"policy": FILE, "env": FILE, "agent": FILE, "trained_in":
/// ENGINE}, all but the first as the options of these names and theirs by default, and answers each with a
/// line: {"policy", "cells"} as `score --json` has them, or {"policy", "error"}, after which it goes on. Ends
/// with its input.
/// @throws Interrupted by a signal
void serve_scores(const ScoredPoliciesOptions& options);

}  // namespace crossgait::apps
