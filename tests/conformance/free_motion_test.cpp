// Bodies in the air: Newton's and Euler's laws, without any help from the ground.
#include <cmath>
#include <functional>

#include "crossgait/benchmarks/analytic.h"
#include "crossgait/physics/multibody.h"
#include "crossgait/tests/support/backend_test.h"

namespace crossgait {
namespace {

/// Steps without targets for robots without servos; with home targets otherwise.
void run(
    PhysicsBackend& backend, double seconds, const std::function<void()>& each_step = [] {}) {
  const JointTargets targets = scenes::home_targets(backend.robot());
  const long steps = std::lround(seconds / backend.spec().physics_dt);
  for (long i = 0; i < steps; ++i) {
    ASSERT_EQ(backend.step(targets), StepStatus::kOk);
    each_step();
  }
}

Vector3 velocity_of_mass(const SpatialInertia& inertia, const RobotState& s) {
  return s.v_WB + s.w_WB.cross(s.q_WB * inertia.p_BC);
}

class FreeFall : public BackendTest {};
CROSSGAIT_FOR_EVERY_BACKEND(FreeFall);

TEST_P(FreeFall, FollowsTheDiscreteSolutionAndConvergesToTheParabola) {
  const Vector3 p0(0.1, -0.2, 30), v0(0.3, 0.2, 1);
  for (const double h : {1e-3, 5e-4}) {
    WorldSpec spec = scenes::world_of(scenes::tumbling_body());
    spec.physics_dt = h;
    spec.gravity = {0.5, -0.25, -9.81};
    const auto backend = make(spec);
    RobotState start = backend->home_state();
    start.p_WB = p0;
    start.v_WB = v0;
    start.q_WB = from_roll_pitch_yaw(0.3, 0.2, -2);
    backend->reset(start);
    double worst = 0;
    run(*backend, 1, [&] {
      const double t = backend->state().time;
      // Semi-implicit Euler: v = v0 + g t exactly, p = p0 + v0 t + g t (t + h) / 2. Rounding: a thousand
      // additions to numbers of size 30.
      worst = std::max(worst, (backend->state().v_WB - (v0 + spec.gravity * t)).norm());
      worst =
          std::max(worst, (backend->state().p_WB - (p0 + v0 * t + spec.gravity * (t * (t + h) / 2))).norm());
    });
    measured("difference from the discrete solution, m and m/s", worst);
    EXPECT_LT(worst, 1e-11);
    // Against the parabola it is late by half a step.
    const Vector3 parabola = p0 + v0 + spec.gravity / 2;
    EXPECT_NEAR((backend->state().p_WB - parabola).norm(), spec.gravity.norm() * h / 2, 1e-11);
    EXPECT_LT(backend->state().w_WB.norm(), 1e-12);
  }
}

TEST_P(FreeFall, AWholeRobotHoldingItsPoseFallsAsOne) {
  const auto backend = make(scenes::quadruped());
  RobotState start = backend->home_state();
  start.p_WB.z() = 3;
  backend->reset(start);
  run(*backend, 0.5);
  const double t = 0.5, h = 1e-3;
  // The loops are closed at home to 1e-9 m, and their springs pull at that: nothing else acts inside the
  // robot.
  EXPECT_NEAR(backend->state().p_WB.z(), 3 - 9.81 * t * (t + h) / 2, 1e-9);
  EXPECT_NEAR(backend->state().v_WB.z(), -9.81 * t, 1e-8);
  EXPECT_LT((backend->state().q - start.q).lpNorm<Eigen::Infinity>(), 1e-6);
}

class Tumbling : public BackendTest {
 protected:
  static benchmarks::TumblingDrift drift(double h) { return benchmarks::measure_tumbling(GetParam(), h); }
};
CROSSGAIT_FOR_EVERY_BACKEND(Tumbling);

TEST_P(Tumbling, AngularMomentumAndEnergyDriftAtFirstOrderOnly) {
  const benchmarks::TumblingDrift coarse = drift(1e-3), fine = drift(5e-4), finest = drift(2.5e-4);
  measured("relative drift of angular momentum, h = 1e-3", coarse.momentum);
  measured("relative drift of energy, h = 1e-3", coarse.energy);
  measured("predicted drift of energy, h = 1e-3", coarse.predicted_energy);
  // First order: halving the step halves the drift; the next order is h |w| = 1 % of it.
  EXPECT_NEAR(fine.momentum / coarse.momentum, 0.5, 0.02);
  EXPECT_NEAR(finest.momentum / fine.momentum, 0.5, 0.02);
  EXPECT_NEAR(finest.energy / fine.energy, 0.5, 0.02);
  EXPECT_NEAR(coarse.energy, coarse.predicted_energy, 0.05 * coarse.predicted_energy);
  // (h / 2) |w| T |w| with |w| = 11 rad/s and T = 1 s, were all of w to turn: a bound on what one step's
  // error can sum up to.
  EXPECT_LT(coarse.momentum, 0.5e-3 * 11.2 * 11.2);
}

TEST_P(Tumbling, TheCentreOfMassMovesInAStraightLine) {
  const benchmarks::TumblingDrift d = drift(1e-3);
  measured("velocity of the centre of mass, m/s", d.velocity);
  measured("position of the centre of mass, m", d.position);
  EXPECT_LT(d.velocity, 1e-12);  // rounding of a thousand steps
  EXPECT_LT(d.position, 1e-12);
}

class RobotInTheAir : public BackendTest {
 protected:
  struct Drift {
    double momentum = 0, angular_momentum = 0;
  };
  /// Linear (kg m/s) and angular (about the centre of mass, kg m^2/s) momentum of the whole robot while it
  /// kicks.
  static std::pair<Vector3, Vector3> momenta(const PhysicsBackend& backend) {
    const RobotDescription& robot = backend.robot();
    const RobotState& s = backend.state();
    Eigen::VectorXd v(6 + robot.joint_count());
    v << s.v_WB, s.w_WB, s.qd;
    RobotDescription bare = robot;  // the rotors that armature stands for carry no momentum of the robot's
    for (Body& body : bare.bodies) body.joint.armature = 0;
    const Eigen::VectorXd p = mass_matrix(bare, s) * v;
    std::vector<Pose> poses;
    forward_kinematics(robot, s, poses);
    Vector3 c = Vector3::Zero();
    for (std::size_t i = 0; i < poses.size(); ++i)
      c += robot.bodies[i].inertia.mass * (poses[i] * robot.bodies[i].inertia.p_BC);
    c = c / robot.total_mass() - s.p_WB;
    return {p.head<3>(), p.segment<3>(3) - c.cross(p.head<3>())};
  }

  static Drift drift(const scenes::RobotPtr& robot, double h) {
    WorldSpec spec = scenes::world_of(robot);
    spec.physics_dt = h;
    spec.gravity.setZero();
    const auto backend = make(spec);
    const scenes::Swing swing(*scenes::quadruped());
    RobotState start = backend->home_state();
    start.p_WB.z() = 2;
    start.v_WB = {0.4, -0.3, 0.2};
    start.w_WB = {3, 6, 9};
    backend->reset(start);
    const auto [p0, L0] = momenta(*backend);
    Drift result;
    const long steps = std::lround(0.4 / h);
    for (long i = 0; i < steps; ++i) {
      EXPECT_EQ(backend->step(swing.targets(backend->state().time)), StepStatus::kOk);
      const auto [p, L] = momenta(*backend);
      result.momentum = std::max(result.momentum, (p - p0).norm() / p0.norm());
      result.angular_momentum = std::max(result.angular_momentum, (L - L0).norm() / L0.norm());
    }
    return result;
  }
};
CROSSGAIT_FOR_EVERY_BACKEND(RobotInTheAir);

TEST_P(RobotInTheAir, KeepsItsMomentaAtFirstOrder) {
  const scenes::RobotPtr robot = scenes::without_loops(scenes::quadruped());
  const Drift coarse = drift(robot, 1e-3), fine = drift(robot, 5e-4);
  measured("relative drift of momentum, h = 1e-3", coarse.momentum);
  measured("relative drift of angular momentum, h = 1e-3", coarse.angular_momentum);
  // A step conserves M(q) v with q at its beginning; that q moves is an error of second order per step, first
  // in all.
  EXPECT_NEAR(fine.momentum / coarse.momentum, 0.5, 0.05);
  EXPECT_NEAR(fine.angular_momentum / coarse.angular_momentum, 0.5, 0.05);
  EXPECT_LT(coarse.angular_momentum, 0.5e-3 * 11.2 * 11.2);  // as for one body, see Tumbling
}

TEST_P(RobotInTheAir, LoopsDoNotPushIt) {
  const Drift coarse = drift(scenes::quadruped(), 1e-3), fine = drift(scenes::quadruped(), 5e-4);
  measured("relative drift of momentum, h = 1e-3", coarse.momentum);
  // A soft loop pulls at two points that are a gap apart: a couple, so that its angular momentum does not
  // converge.
  measured("relative drift of angular momentum, h = 1e-3", coarse.angular_momentum);
  EXPECT_NEAR(fine.momentum / coarse.momentum, 0.5, 0.05);
}

class Push : public BackendTest {};
CROSSGAIT_FOR_EVERY_BACKEND(Push);

TEST_P(Push, ChangesTheVelocityOfTheCentreOfMassByImpulseOverMass) {
  WorldSpec spec = scenes::world_of(scenes::tumbling_body());
  spec.gravity.setZero();
  const auto backend = make(spec);
  const SpatialInertia& inertia = backend->robot().bodies[0].inertia;
  RobotState start = backend->home_state();
  start.p_WB.z() = 2;
  start.q_WB = from_roll_pitch_yaw(0.5, -0.4, 0.3);
  backend->reset(start);
  const Vector3 impulse(0.3, -0.2, 0.1);
  backend->apply_push(impulse / 2);
  backend->apply_push(impulse / 2);  // pushes add up
  run(*backend, 2e-3);               // the second step is not pushed
  EXPECT_LT((velocity_of_mass(inertia, backend->state()) - impulse / inertia.mass).norm(), 1e-14);
  EXPECT_LT(backend->state().w_WB.norm(), 1e-14);
}

TEST_P(Push, OfAWholeRobotGivesItTheWholeImpulse) {
  WorldSpec spec = scenes::world_of(scenes::quadruped());
  spec.gravity.setZero();
  const auto backend = make(spec);
  RobotState start = backend->home_state();
  start.p_WB.z() = 2;
  backend->reset(start);
  backend->apply_push({0.05, -0.02, 0.03});
  run(*backend, 1e-3);
  Eigen::VectorXd v(6 + backend->robot().joint_count());
  v << backend->state().v_WB, backend->state().w_WB, backend->state().qd;
  // After one step from rest the momentum is M(q0) v, to rounding.
  const Eigen::VectorXd p = mass_matrix(backend->robot(), start) * v;
  EXPECT_LT((p.head<3>() - Vector3(0.05, -0.02, 0.03)).norm(), 1e-13);
}

TEST_P(Push, IsForgottenByReset) {
  const auto backend = make(scenes::tumbling_body());
  backend->apply_push({1, 0, 0});
  backend->reset();
  run(*backend, 1e-3);
  EXPECT_LT(std::abs(backend->state().v_WB.x()), 1e-15);  // 1.4 m/s if it were remembered
}

}  // namespace
}  // namespace crossgait
