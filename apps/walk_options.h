// Options that `walk` and `compare` share: the gait and its timing.
#pragma once

#include <optional>

#include "crossgait/apps/command.h"
#include "crossgait/parity/comparison.h"

namespace crossgait::apps {

struct WalkOptions {
  std::string gait = "trot";
  std::vector<std::string> settings;  // NAME=VALUE of gait parameters
  std::optional<double> speed;
  std::string velocity;
  WalkTiming timing;
  bool plain_servos = false;

  void add_to(CLI::App& command);
  /// Of --speed or --command. @throws ConfigError
  std::optional<VelocityCommand> make_command() const;
  /// @param robot must outlive the setup
  /// @throws ConfigError for an unknown gait or parameter
  WalkSetup make(const RobotDescription& robot) const;
};

}  // namespace crossgait::apps
