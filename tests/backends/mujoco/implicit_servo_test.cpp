// Implicit damping against MuJoCo's own implicit integrator, in a model that is not Crossgait's.
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "backends/mujoco/mujoco_backend.h"
#include "scenes/scenes.h"
#include "tests/backends/mujoco/foreign_model.h"

namespace crossgait::mujoco {
namespace {

// One hinge has no velocities that others depend on, and no contact, after which MuJoCo's integrators damp:
// what is left is the servo's law.
TEST(ImplicitServo, DampsAsMujocosImplicitIntegratorDoes) {
  const scenes::ArmLink link{.armature = 1e-3, .servo = true, .kp = 15, .kd = 2.5, .effort_limit = 1e3};
  RobotDescription robot = *scenes::arm({link});
  robot.bodies[1].joint.implicit_damping = 1;
  WorldSpec spec = scenes::world_of(std::make_shared<const RobotDescription>(robot));
  spec.fixed_base = true;
  spec.physics_dt = 5e-3;
  const auto world = engine(true).make(spec);

  const ModelPtr m = compile_text(
      "<mujoco><compiler angle='radian'/><option timestep='0.005' gravity='0 0 -9.81' integrator='implicit'/>"
      "<worldbody><body><joint name='j' axis='0 1 0' armature='0.001'/><inertial pos='0 0 -0.25' mass='0.2' "
      "diaginertia='0.002 0.002 0.002'/></body></worldbody>"
      "<actuator><general joint='j' gaintype='fixed' biastype='affine' gainprm='15' biasprm='0 -15 -2.5'/>"
      "</actuator></mujoco>");
  const DataPtr d(mj_makeData(m.get()));
  const double axis = robot.bodies[1].joint.axis.y();
  ASSERT_EQ(std::abs(axis), 1) << "the arm turns about y";
  ASSERT_EQ(spec.gravity.z(), -9.81);
  double farthest = 0;
  for (int i = 0; i < 400; ++i) {
    const double target = 0.8 * std::sin(0.05 * i);
    d->ctrl[0] = axis * target;
    mj_step(m.get(), d.get());
    ASSERT_EQ(world->step({JointVector::Constant(1, target)}), StepStatus::kOk);
    EXPECT_NEAR(world->state().q[0], axis * d->qpos[0], 1e-12) << i;  // rounding of 400 steps
    farthest = std::max(farthest, std::abs(d->qpos[0]));
  }
  EXPECT_GT(farthest, 0.4);
}

}  // namespace
}  // namespace crossgait::mujoco
