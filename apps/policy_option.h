// A policy in the place of a gait: `--policy` and `--config` of commands that walk.
#pragma once

#include <string>

#include "apps/walk_options.h"
#include "env/loaded_env.h"

namespace crossgait::apps {

struct PolicyOption {
  std::string policy, config;

  /// @param command  that has the options of a walk; stays the caller's
  void add_to(CLI::App& command);
  bool asked() const { return !policy.empty(); }
  /// Loads the environment: of --config, of the policy itself, or the one that the walk's options describe.
  /// On top of a file come terrain, friction, velocity and duration that were asked for.
  /// @throws ConfigError also for another option of a walk beside a file, which says it
  LoadedEnv environment(const WalkOptions& walk) const;

 private:
  const CLI::App* command_ = nullptr;
};

}  // namespace crossgait::apps
