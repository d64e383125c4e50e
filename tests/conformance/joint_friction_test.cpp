// Joints without dry friction. What friction does: conformance/joint_friction.cpp.
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

class JointFriction : public EngineTest {};
CROSSGAIT_FOR_EVERY_BACKEND(JointFriction);

// Without friction there are no rows of it.
TEST_P(JointFriction, OfZeroChangesNoBit) {
  RobotDescription soft = *scenes::quadruped();
  soft.friction_softness = {0.1, 0.5, 0.2, 0.3, 0.1};
  const auto a = make(scenes::quadruped()), b = make(std::make_shared<const RobotDescription>(soft));
  const scenes::Trot trot(a->robot());
  for (int i = 0; i < 700; ++i) {
    ASSERT_EQ(a->step(trot.targets(i * 1e-3)), StepStatus::kOk);
    ASSERT_EQ(b->step(trot.targets(i * 1e-3)), StepStatus::kOk);
  }
  EXPECT_TRUE(scenes::identical(a->state(), b->state()));
}

}  // namespace
}  // namespace crossgait
