#include "tests/view/view_setup.h"

#include "backends/registry.h"
#include "physics/robot_files/data_path.h"
#include "policy/bundled_policies.h"

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

std::unique_ptr<ViewSession> make_open_session(const std::vector<std::string>& engines) {
  const auto make = [](const ViewSubject& subject, const TerrainChoice& ground) {
    ViewSetup setup;
    setup.subject = subject;
    setup.terrain_seed = ground.seed;
    if (subject.policy.empty()) {
      setup.world.robot = std::make_shared<const RobotDescription>(load_robot(find_robot(subject.robot)));
      setup.world.terrain = make_terrain(ground.terrain, ground.seed);
      return setup;
    }
    EnvConfig config = load_env_config(environment_file(subject.environment, subject.policy));
    config.terrain = ground.terrain;
    config.terrain_seed = ground.seed;
    setup.subject.robot = config.robot;
    setup.control_dt = config.control_dt;
    setup.policy = {config, subject.policy};
    return setup;
  };
  ViewSetup setup = make({"scara_quadruped", {}, {}, {}}, {"flat", 0});
  setup.engines = engines;
  return std::make_unique<ViewSession>(
      setup, registry_shelf(),
      SubjectProvider{{"serial_quadruped"}, {"serial_joints", "scara_adaptive"}, make});
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
