// No allocation per control step where servos are made to give torques, by a network too.
#include "env/joint_control.h"
#include "tests/physics/core/scratch_folder.h"
#include "tests/policy/actuator_networks.h"
#include "tests/support/allocation_counter.h"

namespace crossgait {
namespace {

class JointControlAllocation : public ScratchFolder {};

TEST_F(JointControlAllocation, NoneOfNetworksOfActuatorsAndSeveralCommands) {
  for (const bool lstm : {false, true}) {
    write_safetensors(path("actuator.safetensors"), actuator_tests::file_of(actuator_tests::plain(lstm)));
    EnvConfig config = joint_environment();
    config.robot = "serial_quadruped";
    config.joints.actuator = path("actuator.safetensors");
    config.joints.commands = {{"FL_knee", JointCommand::kVelocity}, {"FR_knee", JointCommand::kTorque}};
    config.joints.delay = 2e-3;
    config.control_dt = config.physics_dt = 1e-3;
    JointControl control(*EnvModel::make(config));
    const RobotState state = control.initial_state(make_terrain("flat"), {});
    const std::vector<double> action(12, 0.1);
    ControlTargets targets;
    control.hold_pose(1e-3, targets);
    const AllocationScope scope;
    for (int episode = 0; episode < 2; ++episode) {
      control.restart({});
      for (int i = 0; i < 100; ++i) {
        control.apply(action, state);
        control.observe(state, 1e-3);
        control.advance(1e-3, targets);
      }
    }
    EXPECT_EQ(scope.count(), 0U);
    EXPECT_TRUE(targets.joints.q.allFinite());
  }
}

}  // namespace
}  // namespace crossgait
