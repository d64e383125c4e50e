#include "parity/model_probes.h"

#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

class Probes : public EngineTest {};
CROSSGAIT_FOR_EVERY_BACKEND(Probes);

TEST_P(Probes, TurnEveryJointTheFirstOneToo) {
  const scenes::RobotPtr robot = scenes::quadruped();
  const auto world = make(robot);
  const std::vector<Pose> rest = probes::poses_with_turned(*world, -1);
  for (int joint = 0; joint < robot->joint_count(); ++joint) {
    const std::vector<Pose> turned = probes::poses_with_turned(*world, joint);
    for (int body = 1; body <= robot->joint_count(); ++body) {
      const auto i = static_cast<std::size_t>(body);
      const Eigen::AngleAxisd expected(body == joint + 1 ? 0.5 : 0, robot->joint(joint).axis);
      // Rounding of rotations, far above the ground.
      EXPECT_LT((turned[i].linear() - rest[i].linear() * expected.toRotationMatrix()).norm(), 1e-12);
    }
  }
}

}  // namespace
}  // namespace crossgait
