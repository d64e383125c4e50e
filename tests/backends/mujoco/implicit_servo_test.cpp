// Implicit damping against MuJoCo's own implicit integrator, in a model that is not Crossgait's.
#include <algorithm>
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

// Of joints it is Euler's default as well: two hinges, one on the other, with dampers that an explicit step
// would throw about.
TEST(ImplicitDamper, DampsAsMujocosEulerDoes) {
  const scenes::ArmLink link{.armature = 1e-3, .damping = 8};
  RobotDescription robot = *scenes::arm({link, link});
  for (std::size_t i : {1, 2}) robot.bodies[i].joint.implicit_joint_damping = 1;
  WorldSpec spec = scenes::world_of(std::make_shared<const RobotDescription>(robot));
  spec.fixed_base = true;
  spec.physics_dt = 5e-3;
  ASSERT_GT(link.damping * spec.physics_dt, 2 * link.joint_inertia());
  const auto world = engine(true).make(spec);
  const auto body = [](const char* at, const char* name, const std::string& inside) {
    return std::string("<body pos='") + at + "'><joint name='" + name +
           "' axis='0 1 0' armature='0.001' damping='8'/><inertial pos='0 0 -0.25' mass='0.2' "
           "diaginertia='0.002 0.002 0.002'/>" +
           inside + "</body>";
  };
  const ModelPtr m = compile_text("<mujoco><option timestep='0.005' gravity='0 0 -9.81'/><worldbody>" +
                                  body("0 0 0", "a", body("0 0 -0.5", "b", "")) + "</worldbody></mujoco>");
  const DataPtr d(mj_makeData(m.get()));
  RobotState state = world->state();
  state.q << 1, -0.6;
  state.qd << 3, -20;
  ASSERT_EQ(robot.bodies[1].joint.axis.y(), 1) << "the arm turns about y";
  for (int i = 0; i < 2; ++i) d->qpos[i] = state.q[i], d->qvel[i] = state.qd[i];
  world->reset(state);
  double farthest = 0;
  for (int i = 0; i < 400; ++i) {
    mj_step(m.get(), d.get());
    ASSERT_EQ(world->step({JointVector()}), StepStatus::kOk);
    for (int k = 0; k < 2; ++k) {
      EXPECT_NEAR(world->state().q[k], d->qpos[k], 1e-12) << i;  // rounding of 400 steps
      farthest = std::max(farthest, std::abs(d->qpos[k] - state.q[k]));
    }
  }
  EXPECT_GT(farthest, 0.1);
}

}  // namespace
}  // namespace crossgait::mujoco
