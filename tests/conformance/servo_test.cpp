// The servo law in every engine: it is shared code, but what it drives is the engine's.
#include <cmath>

#include "crossgait/tests/support/backend_test.h"

namespace crossgait {
namespace {

class Servo : public BackendTest {
 protected:
  static std::unique_ptr<PhysicsBackend> world(const scenes::ArmLink& link, double h, double gravity) {
    WorldSpec spec = scenes::world_of(scenes::arm({link}));
    spec.fixed_base = true;
    spec.physics_dt = h;
    spec.gravity = {0, 0, -gravity};
    return make(spec);
  }
  static JointTargets target(double angle) { return {JointVector::Constant(1, angle)}; }
};
CROSSGAIT_FOR_EVERY_BACKEND(Servo);

/// Largest difference over a second between a step response and the closed form of
/// J q'' + D q' + kp (q - target) = 0, rad.
double step_response_error(PhysicsBackend& backend, const scenes::ArmLink& link,
                           const JointTargets& targets) {
  const double J = link.joint_inertia(), D = link.kd + link.damping, a = D / (2 * J);
  const double wd = std::sqrt(link.kp / J - a * a), goal = targets.q[0];
  double worst = 0;
  while (backend.state().time < 1) {
    const StepStatus status = backend.step(targets);
    EXPECT_EQ(status, StepStatus::kOk);
    if (status != StepStatus::kOk) break;  // time stands still
    const double t = backend.state().time;
    const double exact = goal * (1 - std::exp(-a * t) * (std::cos(wd * t) + a / wd * std::sin(wd * t)));
    worst = std::max(worst, std::abs(backend.state().q[0] - exact));
  }
  return worst;
}

TEST_P(Servo, StepResponseIsThatOfASecondOrderSystem) {
  const scenes::ArmLink link{
      .armature = 4e-3, .damping = 0.03, .servo = true, .kp = 2, .kd = 0.05, .effort_limit = 100};
  const double goal = 0.3;
  double error[2];
  for (int i = 0; i < 2; ++i) {
    const double h = i == 0 ? 1e-3 : 5e-4;
    error[i] = step_response_error(*world(link, h, 0), link, target(goal));
  }
  measured("largest difference from the closed form, h = 1e-3, share of the step", error[0] / goal);
  const double w = std::sqrt(link.kp / link.joint_inertia());
  EXPECT_LT(error[0] / goal,
            w * 1e-3);  // half a step of delay at the greatest speed w, and as much for the damping
  EXPECT_NEAR(error[1] / error[0], 0.5, 0.02);  // first order
}

TEST_P(Servo, LagsAConstantLoadByLoadOverStiffness) {
  const scenes::ArmLink link{.damping = 0.2, .servo = true, .kp = 2, .effort_limit = 100};
  const auto backend = world(link, 1e-3, 9.81);
  const double goal = 0.8;
  ASSERT_EQ(backend->step(target(goal), 6000), StepStatus::kOk);
  const double q = backend->state().q[0];
  EXPECT_LT(std::abs(backend->state().qd[0]), 1e-9);
  // At rest kp (target - q) = m g l sin q.
  EXPECT_NEAR(link.kp * (goal - q), link.mass * 9.81 * link.length * std::sin(q), 1e-9);
  EXPECT_GT(goal - q, 0.1);  // a lag worth the name
  EXPECT_NEAR(backend->torques()[0], link.kp * (goal - q), 1e-9);
}

TEST_P(Servo, EffortLimitBoundsTheTorque) {
  const scenes::ArmLink link{.servo = true, .kp = 50, .kd = 0.5, .effort_limit = 0.4};
  const auto backend = world(link, 1e-3, 0);
  for (const double goal : {1.0, -1.0}) {
    backend->reset();
    ASSERT_EQ(backend->step(target(goal), 10), StepStatus::kOk);
    const double tau = std::copysign(link.effort_limit, goal);
    EXPECT_EQ(backend->torques()[0], tau);
    EXPECT_NEAR(backend->state().qd[0], tau / link.joint_inertia() * 0.01, 1e-13);  // ten equal pushes
  }
}

TEST_P(Servo, TargetsBeyondTheLimitAreHeldAtIt) {
  const scenes::ArmLink link{.damping = 0.2, .servo = true, .kp = 2, .effort_limit = 100, .limit = 0.5};
  const auto backend = world(link, 1e-3, 0);
  for (const double goal : {2.0, -2.0}) {
    ASSERT_EQ(backend->step(target(goal), 6000), StepStatus::kOk);
    EXPECT_NEAR(backend->state().q[0], std::copysign(link.limit, goal), 1e-9);
  }
}

TEST_P(Servo, HoldsItsTargetsOverSubsteps) {
  const scenes::ArmLink link{.servo = true, .kp = 2, .effort_limit = 100};
  const auto one = world(link, 1e-3, 9.81), many = world(link, 1e-3, 9.81);
  ASSERT_EQ(one->step(target(0.7), 20), StepStatus::kOk);
  for (int i = 0; i < 20; ++i) ASSERT_EQ(many->step(target(0.7)), StepStatus::kOk);
  EXPECT_EQ(one->state().q[0], many->state().q[0]);
  EXPECT_EQ(one->state().time, many->state().time);
}

TEST_P(Servo, CannotTurnFasterThanItsNoLoadSpeed) {
  // A full-torque swing of a light link without gravity: qd approaches no_load_speed as a first-order lag,
  // J qd' = effort (1 - qd / w), of time constant J w / effort.
  const scenes::ArmLink link{.armature = 4e-3, .servo = true, .kp = 1e3, .effort_limit = 0.5};
  RobotDescription robot = *scenes::arm({link});
  Joint& joint = robot.bodies[1].joint;
  joint.no_load_speed = 5;
  WorldSpec spec = scenes::world_of(std::make_shared<const RobotDescription>(robot));
  spec.fixed_base = true;
  spec.gravity.setZero();
  const auto backend = make(spec);
  const double lag = link.joint_inertia() * 5 / 0.5;
  double worst = 0;
  while (backend->state().time < 3 * lag) {
    ASSERT_EQ(backend->step(target(3)), StepStatus::kOk);
    const double exact = 5 * (1 - std::exp(-backend->state().time / lag));
    worst = std::max(worst, std::abs(backend->state().qd[0] - exact));
  }
  measured("largest difference from the first-order lag, rad/s", worst);
  EXPECT_LT(worst,
            0.5 * 5 * 1e-3 / lag);  // explicit Euler: h / (2 e lag) of the final speed, and as much again
  EXPECT_GT(backend->state().qd[0], 4.7);
}

}  // namespace
}  // namespace crossgait
