// Networks as trainings write them, which the Python package reads.
#pragma once

#include <string>

#include "policy/relabelled_policy.h"

namespace crossgait::apps {

/// Tells whether a policy is a file that only the Python package reads: FILE.pt, FILE.pth or FILE.onnx.
bool is_checkpoint(const std::string& policy);

/// Reads the network of a checkpoint of rsl_rl, of TorchScript or of ONNX.
/// @param environment  the file of what it acts in, which has its sizes
/// @param agent        the agent.yaml of a checkpoint; if empty, the one beside it or in its folder's
/// `params`
/// @throws ConfigError for a file that is none of these, or whose network does not fit
RelabelledPolicy read_checkpoint(const std::string& checkpoint, const std::string& environment,
                                 const std::string& agent);

}  // namespace crossgait::apps
