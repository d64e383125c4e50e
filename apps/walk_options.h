// Options that `walk`, `compare` and `verdict` share: the world, the gait and its timing.
#pragma once

#include <optional>

#include "apps/command.h"
#include "apps/contact_option.h"
#include "study/loaded_walk.h"

namespace crossgait::apps {

struct WalkOptions {
  WalkConfig config;  // all but contact and the gait is filled in by the options
  ContactOptions contact;
  std::string gait = "trot";
  std::vector<std::string> settings;  // NAME=VALUE of gait parameters
  std::optional<double> speed;
  std::string velocity;
  std::vector<std::string> terminations{"left_terrain"};  // outcomes, beside divergence
  bool plain_servos = false, open_loop = false;

  void add_to(CLI::App& command);
  /// Reads robot and ground, for everything that the command does with them.
  /// @throws ConfigError also for an unknown gait or parameter
  LoadedWalk make() const;
  /// Returns the velocity that --command or --speed asks for. @throws ConfigError
  std::optional<VelocityCommand> velocity_command() const;
  /// Describes what a walk looks at, for its provenance.
  static nlohmann::json subject(const LoadedWalk& walk);
};

/// Says "12.3 of 300 s are walked": of a walk that was interrupted.
std::string how_far(double walked, double asked);

}  // namespace crossgait::apps
