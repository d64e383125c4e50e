#include "tests/view/view_setup.h"

#include "backends/registry.h"
#include "physics/robot_files/data_path.h"

namespace crossgait {
namespace {

EngineProvider registry_shelf() {
  return {available_engines(), [](const std::string& name) { return find_engine(name); }};
}

}  // namespace

std::unique_ptr<ViewSession> make_view_session(const std::vector<std::string>& engines) {
  ViewSetup setup;
  setup.world.robot = std::make_shared<const RobotDescription>(load_robot(find_robot("scara_quadruped")));
  setup.engines = engines;
  return std::make_unique<ViewSession>(setup, registry_shelf());
}

std::unique_ptr<ViewSession> make_policy_session(const std::vector<std::string>& engines,
                                                 const EnvConfig& config, const std::string& policy) {
  ViewSetup setup;
  setup.policy = {config, policy};
  setup.control_dt = config.control_dt;
  setup.engines = engines;
  return std::make_unique<ViewSession>(setup, registry_shelf());
}

void tell(ViewSession& session, const std::string& command) { session.apply(parse_view_command(command)); }

const RobotState& state_of(const ViewSession& session, std::size_t instance) {
  return session.instances().at(instance)->world().state();
}

}  // namespace crossgait
