// What a program adds to environments beside the tables: terms of its own. Python's are such
// (crossgait.terms).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "policy/layout.h"

namespace crossgait {

class QuadrupedEnv;

/// Adds terms to an environment, which calls them on the thread that steps it; a throw ends its step.
class EnvExtension {
 public:
  /// Holds what terms say of a step.
  struct Step {
    double reward = 0;  ///< on top of the tables'
    bool terminated = false, truncated = false;
  };

  virtual ~EnvExtension() = default;
  EnvExtension(const EnvExtension&) = delete;
  EnvExtension& operator=(const EnvExtension&) = delete;

  /// Is called when an episode is over, by its end or by a reset, before anything of the next is there.
  virtual void end(QuadrupedEnv& env) = 0;
  /// Is called when an episode has begun, which may be changed before its first observation.
  virtual void begin(QuadrupedEnv& env, std::uint64_t seed) = 0;
  /// Is called when a policy step was made; it is not rewarded yet.
  virtual Step step(QuadrupedEnv& env) = 0;
  /// Is called when the episode goes on after a step, and may be changed before its observation.
  virtual void change(QuadrupedEnv& env) = 0;
  /// Writes the numbers behind those of the blocks.
  virtual void observe(const QuadrupedEnv& env, std::span<double> out) = 0;
  /// Returns values of `EnvExtensionModel::reward_terms` in the last step, weighted.
  virtual std::span<const double> reward_terms() const noexcept = 0;
  /// Saves what the rest of the episode depends on.
  virtual std::shared_ptr<const void> save() const = 0;
  virtual void restore(const std::shared_ptr<const void>& saved) = 0;

 protected:
  EnvExtension() = default;
};

/// Holds what all environments of a configuration share of it.
struct EnvExtensionModel {
  std::vector<std::string> terms;         ///< names of all, for documents: no file holds the functions
  std::vector<std::string> reward_terms;  ///< names
  Layout observation;                     ///< behind the entries of the blocks
  std::shared_ptr<const void> source;     ///< what the program made it of
  /// Makes the terms of one environment. Called from several threads.
  std::function<std::unique_ptr<EnvExtension>()> make;
};

}  // namespace crossgait
