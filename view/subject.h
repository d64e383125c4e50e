// What is driven, and where another one comes from while a session goes on.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "physics/core/temporary_folder.h"
#include "view/robot_instance.h"

namespace crossgait {

struct ViewSetup;

/// Names a robot that a hand drives, or a policy with the robot of the environment that it was made for.
struct ViewSubject {
  /// A name or a file, as `load_robot` takes what `find_robot` finds; where a policy drives in the place of
  /// the environment's, which an empty one leaves.
  std::string robot;
  std::string policy;       ///< as `load_policy` takes it; empty where a hand drives
  std::string environment;  ///< the file of the policy's environment; empty: the one beside it
  std::shared_ptr<const TemporaryFolder>
      files;  ///< that hold it, if they were dropped; gone with the last subject
};

/// Provides subjects as a session reaches them.
struct SubjectProvider {
  std::vector<std::string> robots, policies;  ///< names that may be asked for
  /// Makes the setup of one on a ground; its engines are the session's to say. Its own subject names the
  /// robot, whoever drives. Throws ConfigError.
  std::function<ViewSetup(const ViewSubject&, const TerrainChoice&)> make;
};

}  // namespace crossgait
