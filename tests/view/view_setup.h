// Sessions for the tests of view/.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "view/session.h"

namespace crossgait {

/// Makes robots of scara_quadruped on flat ground, in engines of the registry.
std::unique_ptr<ViewSession> make_view_session(const std::vector<std::string>& engines);

/// Makes one whose robot may be changed: for serial_quadruped, the policies
/// serial_joints and scara_adaptive, and files.
std::unique_ptr<ViewSession> make_open_session(const std::vector<std::string>& engines);

/// Makes a session driven by a policy of the environment.
std::unique_ptr<ViewSession> make_policy_session(const std::vector<std::string>& engines,
                                                 const EnvConfig& config, const std::string& policy);

/// Tells the session as a viewer says it.
void tell(ViewSession& session, const std::string& command);

/// Returns the state of the robot in the instance.
const RobotState& state_of(const ViewSession& session, std::size_t instance = 0);

}  // namespace crossgait
