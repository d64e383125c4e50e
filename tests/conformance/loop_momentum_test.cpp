// Angular momentum of a robot in free flight: what nothing outside changes, but for what soft loops cost.
#include "physics/robot/multibody.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

/// About the centre of mass, in W, kg m^2/s: of the first six rows of the mass matrix times the velocities.
Vector3 angular_momentum(const RobotDescription& robot, const RobotState& state) {
  const Eigen::MatrixXd M = mass_matrix(robot, state);
  Eigen::VectorXd velocity(6 + state.qd.size());
  velocity << state.v_WB, state.w_WB, state.qd;
  const Eigen::VectorXd momentum = M.topRows(6) * velocity;
  const double mass = M(0, 0);
  // M couples the base's rotation and translation by mass times the cross product with the centre of mass.
  const Vector3 centre(M(5, 1) / mass, M(3, 2) / mass, M(4, 0) / mass);
  const Vector3 linear = momentum.head<3>(), about_origin = momentum.segment<3>(3);
  return about_origin - centre.cross(linear);
}

class InFlight : public EngineTest {
 protected:
  /// Share of its angular momentum by which 2 s of swinging legs change that of a tumbling robot.
  static double change(const WorldSpec& spec) {
    const auto world = make(spec);
    const RobotDescription& robot = world->robot();
    RobotState state = world->home_state();
    state.p_WB.z() += 100;
    state.w_WB = {1, 2, 3};
    world->reset(state);
    const Vector3 before = angular_momentum(robot, world->state());
    const scenes::Swing swing(robot);
    for (int i = 0; i < std::lround(2 / spec.physics_dt); ++i)
      EXPECT_EQ(world->step(swing.targets(i * spec.physics_dt)), StepStatus::kOk);
    return (angular_momentum(robot, world->state()) - before).norm() / before.norm();
  }
};
CROSSGAIT_FOR_EVERY_BACKEND(InFlight);

TEST_P(InFlight, SoftLoopsCostAngularMomentumAndNotMuch) {
  const bool soft = find_engine(GetParam()).info.laws.loops.starts_with("mujoco");
  WorldSpec spec = scenes::world_of(scenes::quadruped());
  const double whole = change(spec);
  measured("angular momentum lost by swinging legs in 2 s, share", whole);
  EXPECT_LT(whole, 2e-3);  // twice what was measured
  if (!soft) GTEST_SKIP() << "hard loops, which are no further apart than the solver leaves them";
  // A loop pulls at two points, which its softness lets be apart, so that the two forces are not along one
  // line: stiffer loops lose less. The rest is the integrator's, of first order in the step.
  spec.physics_dt = 5e-4;
  const double half = change(spec);
  measured("the same at half the step", half);
  RobotDescription stiff = *spec.robot;
  stiff.loop_softness.time_constant /= 2;
  spec.robot = scenes::finished(stiff);
  const double stiffer = change(spec);
  measured("the same with loops of half the time constant", stiffer);
  EXPECT_LT(half, whole);
  EXPECT_LT(stiffer, 0.9 * half);
}

}  // namespace
}  // namespace crossgait
