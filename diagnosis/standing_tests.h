// What can be known of a policy and its environment in a second of standing: cheap tests, none of which is a
// proof by itself.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "env/loaded_env.h"
#include "policy/relabelled_policy.h"

namespace crossgait {

/// Says what came of a test.
struct StandingTest {
  std::string name;
  std::string proves;  ///< what passing shows
  std::string limits;  ///< what it does not
  bool judged = true;  ///< false: `found` is for the reader, or says why there was nothing to ask
  bool passed = true;
  std::string found = {};  ///< in numbers, with units
  /// Beginnings of the names of fields that a failure points at.
  std::vector<std::string> suspects = {};
};

/// Runs hold, symmetry at rest, yaw invariance, negative feedback by joint, last action, range of
/// observations against the normaliser, servo stability, and the layout that the policy states.
/// @throws ConfigError for an environment or a policy that cannot be
std::vector<StandingTest> run_standing_tests(const LoadedEnv& environment, const RelabelledPolicy& policy,
                                             std::uint64_t seed);

}  // namespace crossgait
