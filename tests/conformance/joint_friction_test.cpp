// Dry friction in joints: what it takes from motions that are known in closed form, and that it holds.
#include <cmath>

#include "crossgait/physics/multibody.h"
#include "crossgait/tests/support/backend_test.h"
#include "crossgait/tests/support/constants.h"

namespace crossgait {
namespace {

using scenes::ArmLink;
using test::kGravity;

constexpr double kFriction = 0.05;  // N m, a tenth of the pendulum's weight at its length

double weight_torque(const ArmLink& link) { return link.mass * kGravity * link.length; }

/// Speed at which MuJoCo's friction gives way to `torque` in a joint of this link alone: aref = -B v has to
/// carry it through R = (1 - imp) / imp / inertia. Hard friction does not give way at all.
double creep_speed(const ArmLink& link, double torque) {
  const Softness soft = RobotDescription().friction_softness;
  const double damping = 2 / (soft.impedance_max * soft.time_constant);
  return torque * (1 - soft.impedance_min) / soft.impedance_min / link.joint_inertia() / damping;
}

/// Where a pendulum let go at `from` is at rest next: m g l (cos to - cos from) = friction |to - from|.
double next_rest(const ArmLink& link, double from) {
  const double side = std::copysign(1.0, from), start = std::abs(from);
  const auto energy = [&](double to) {
    return weight_torque(link) * (std::cos(to) - std::cos(start)) - link.friction * (start - to);
  };
  double moving = std::asin(link.friction / weight_torque(link)), beyond = -start;  // fastest; never reached
  for (int i = 0; i < 60; ++i) {
    const double middle = (moving + beyond) / 2;
    (energy(middle) > 0 ? moving : beyond) = middle;
  }
  return side * moving;
}

class JointFriction : public BackendTest {
 protected:
  static std::unique_ptr<PhysicsBackend> make_arm(const ArmLink& link, const Vector3& gravity) {
    WorldSpec spec = scenes::world_of(scenes::arm({link}));
    spec.fixed_base = true;
    spec.gravity = gravity;
    return make(spec);
  }
  static std::unique_ptr<PhysicsBackend> make_pendulum(const ArmLink& link, double angle) {
    auto world = make_arm(link, {0, 0, -kGravity});
    RobotState start = world->home_state();
    start.q[0] = angle;
    world->reset(start);
    return world;
  }
  static double angle(const PhysicsBackend& world) { return world.state().q[0]; }
  static void step(PhysicsBackend& world, int count = 1) {
    ASSERT_EQ(world.step({}, count), StepStatus::kOk);
  }
  /// How far it moves in a second, rad.
  static double creep(PhysicsBackend& world) {
    const double before = angle(world);
    step(world, 1000);
    return std::abs(angle(world) - before);
  }
};
CROSSGAIT_FOR_EVERY_BACKEND(JointFriction);

TEST_P(JointFriction, APendulumTurnsAndStopsWhereItsEnergySays) {
  const ArmLink link{.friction = kFriction};
  double from = 1.2;
  const auto world = make_pendulum(link, from);
  double worst = 0;
  int swings = 0;
  while (weight_torque(link) * std::abs(std::sin(from)) > kFriction) {
    const double expected = next_rest(link, from), direction = std::copysign(1.0, expected - from);
    step(*world, 10);  // it is under way
    while (direction * world->state().qd[0] > creep_speed(link, kFriction)) step(*world);
    worst = std::max(worst, std::abs(angle(*world) / expected - 1));
    from = expected;
    ASSERT_LT(++swings, 20);
  }
  const double stopped = angle(*world), crept = creep(*world);
  measured("angles of rest, largest relative difference", worst);
  measured("stops at, rad", stopped);
  measured("creeps in a second, rad", crept);
  EXPECT_GE(swings, 4);
  // Turns are seen to a step, (w h)^2 / 2 of their angle at most: 2e-5 each, and more of the small last
  // angle.
  EXPECT_LT(worst, 0.01);
  // The torque falls on the way: a hundredth is for the second's beginning.
  EXPECT_LT(crept, 1.01 * creep_speed(link, weight_torque(link) * std::abs(std::sin(stopped))));
}

TEST_P(JointFriction, AJointWithoutLoadCoastsToRestAtConstantDeceleration) {
  const ArmLink link{.armature = 1e-3, .friction = kFriction};
  const auto world = make_arm(link, Vector3::Zero());
  RobotState start = world->home_state();
  start.qd[0] = 2;
  world->reset(start);
  const double deceleration = kFriction / link.joint_inertia();  // 3.2 rad/s^2
  for (int i = 1; i <= 500; ++i) {
    step(*world);
    ASSERT_NEAR(world->state().qd[0], 2 - deceleration * i * 1e-3, 1e-9) << i;  // solvers stop early
  }
  step(*world, 500);
  // Steps: v h / 2 ahead; and the way of MuJoCo's damper from where it no longer reaches the bound.
  const double way = 2 * 2 / (2 * deceleration);
  measured("coasts, relative difference", angle(*world) / way - 1);
  EXPECT_NEAR(angle(*world), way, 2 * 1e-3);
  EXPECT_LT(creep(*world), 1e-9);  // nothing moves it, and a damper's end is exponential
}

TEST_P(JointFriction, HoldsWhatIsBelowIt) {
  const ArmLink link{.friction = kFriction};
  for (const double share : {0.1, 0.5, 0.95}) {
    const double held = std::asin(share * kFriction / weight_torque(link));
    const auto world = make_pendulum(link, held);
    const double crept = creep(*world);
    measured("share of the friction", share);
    measured("creeps in a second, rad", crept);
    EXPECT_LT(crept, 1.001 * creep_speed(link, share * kFriction)) << share;
  }
}

TEST_P(JointFriction, GivesWayToWhatIsAboveIt) {
  const ArmLink link{.friction = kFriction};
  const double angle_of_release = std::asin(1.1 * kFriction / weight_torque(link));
  const auto world = make_pendulum(link, angle_of_release);
  step(*world, 10);
  // A tenth of the friction accelerates it. Ten steps: the mean is of (n + 1) h / 2, and the angle has
  // changed little.
  EXPECT_NEAR(world->state().qd[0], -0.1 * kFriction / link.joint_inertia() * 0.01,
              0.01 * 0.1 * kFriction / link.joint_inertia() * 0.01);
}

TEST_P(JointFriction, IsAsTheEngineSaysItHoldsIt) {
  const scenes::RobotPtr robot = scenes::quadruped();
  RobotDescription changed = *robot;
  changed.bodies[3].joint.friction = 0.02;
  changed.bodies[20].joint.friction = 0.01;
  const auto world = make(std::make_shared<const RobotDescription>(changed));
  const JointVector friction = world->joint_friction();
  ASSERT_EQ(friction.size(), robot->joint_count());
  for (int i = 0; i < robot->joint_count(); ++i)
    EXPECT_EQ(friction[i], i == 2 ? 0.02 : i == 19 ? 0.01 : 0) << i;
}

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

TEST_P(JointFriction, KeepsAStandingRobotStill) {
  const auto world = make(scenes::with_joint_friction(scenes::quadruped(), 0.05));
  const JointTargets targets = scenes::home_targets(world->robot());
  ASSERT_EQ(world->step(targets, 1000), StepStatus::kOk);
  const RobotState before = world->state();
  ASSERT_EQ(world->step(targets, 1000), StepStatus::kOk);
  const Softness& soft = world->robot().friction_softness;
  const double damping = 2 / (soft.impedance_max * soft.time_constant);
  const double weight = joint_inverse_weights(world->robot(), false).maxCoeff();
  const double moved = (world->state().q - before.q).cwiseAbs().maxCoeff();
  measured("joints of a standing robot in a second, rad", moved);
  // As in creep_speed: no row of friction gives way faster, nor more than its bound.
  EXPECT_LT(moved, 0.05 * (1 - soft.impedance_min) / soft.impedance_min * weight / damping);
}

}  // namespace
}  // namespace crossgait
