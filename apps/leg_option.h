// --leg, --mode and --knee: which leg, and in which of its postures.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "ik/leg_kinematics.h"

namespace crossgait::apps {

struct LegOption {
  std::string leg = "FL";
  int mode = 0;      ///< working mode of a five-bar; 0: that of the home pose
  std::string knee;  ///< forward or backward, of a serial leg; empty: as in the home pose

  void add_to(CLI::App& command);
  /// @throws ConfigError naming the option
  Leg which() const;
  /// @throws ConfigError naming the option, if it is none or none for legs of this kind
  LegBranch branch(const LegKinematics& kinematics) const;
};

/// Names a branch: "mode 2", "knee backward".
std::string branch_text(const LegKinematics& kinematics, LegBranch branch);

}  // namespace crossgait::apps
