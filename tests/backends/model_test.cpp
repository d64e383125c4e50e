// What each engine made of the description: masses, inertias, frames, axes, armature, gravity.
#include <cmath>

#include "crossgait/physics/multibody.h"
#include "crossgait/tests/support/backend_test.h"

namespace crossgait {
namespace {

std::vector<scenes::RobotPtr> robots() {
  return {scenes::quadruped(), scenes::long_quadruped(), scenes::awkward_robot(), scenes::tumbling_body()};
}

class Model : public BackendTest {};
CROSSGAIT_FOR_EVERY_BACKEND(Model);

TEST_P(Model, HasTheMassPropertiesOfTheDescription) {
  double worst = 0;
  for (const scenes::RobotPtr& robot : robots()) {
    const auto backend = make(robot);
    for (int i = 0; i <= robot->joint_count(); ++i) {
      const SpatialInertia expected = robot->bodies[static_cast<std::size_t>(i)].inertia;
      const SpatialInertia found = backend->body_inertia(i);
      EXPECT_EQ(found.mass, expected.mass);
      // Engines hold principal moments and axes: the tensor comes back by a rotation, to rounding.
      const double scale = expected.I_C.cwiseAbs().maxCoeff();
      const double difference = (found.I_C - expected.I_C).cwiseAbs().maxCoeff() / scale;
      worst = std::max(worst, difference);
      EXPECT_LT(difference, 1e-14 * 10) << robot->name << " body " << i;
      EXPECT_LT((found.p_BC - expected.p_BC).norm(), 1e-15) << robot->name << " body " << i;
    }
  }
  measured("inertia, relative", worst);
}

TEST_P(Model, HasTheFramesOfTheDescription) {
  std::mt19937 random(1);
  double worst = 0;
  for (const bool fixed : {false, true}) {
    for (const scenes::RobotPtr& robot : robots()) {
      WorldSpec spec = scenes::world_of(robot);
      spec.fixed_base = fixed;
      const auto backend = make(spec);
      for (int n = 0; n < 20; ++n) {
        const RobotState state = scenes::random_state(*robot, random);
        backend->reset(state);
        std::vector<Pose> poses;
        forward_kinematics(*robot, state, poses);
        for (int i = 0; i <= robot->joint_count(); ++i) {
          const Pose expected = poses[static_cast<std::size_t>(i)];
          const double difference =
              (backend->body_pose(i).matrix() - expected.matrix()).cwiseAbs().maxCoeff();
          worst = std::max(worst, difference);
          EXPECT_LT(difference, 1e-12) << robot->name << " body " << i;  // rounding along five joints
        }
      }
    }
  }
  measured("body poses, m and direction cosines", worst);
}

TEST_P(Model, FeetAreWhereForwardKinematicsPutsThem) {
  std::mt19937 random(2);
  for (const scenes::RobotPtr& robot : {scenes::quadruped(), scenes::long_quadruped()}) {
    const auto backend = make(robot);
    for (int n = 0; n < 20; ++n) {
      const RobotState state = scenes::random_state(*robot, random);
      backend->reset(state);
      std::vector<Pose> poses;
      forward_kinematics(*robot, state, poses);
      for (const Leg leg : kLegs) {
        const LegModel& model = (*robot->legs)[leg];
        EXPECT_LT(
            (backend->body_pose(model.foot_body) * model.p_BF - foot_position(*robot, leg, poses)).norm(),
            1e-12);
      }
    }
  }
}

TEST_P(Model, GivesBackTheStateItWasResetTo) {
  std::mt19937 random(3);
  for (const scenes::RobotPtr& robot : robots()) {
    const auto backend = make(robot);
    RobotState state = scenes::random_state(*robot, random);
    state.time = 12.5;
    backend->reset(state);
    const RobotState& found = backend->state();
    EXPECT_EQ(found.time, state.time);
    EXPECT_LT((found.p_WB - state.p_WB).norm(), 1e-15);
    EXPECT_LT(found.q_WB.angularDistance(state.q_WB), 1e-7);  // of an arc cosine near 1
    EXPECT_LT((found.q_WB.toRotationMatrix() - state.q_WB.toRotationMatrix()).norm(), 1e-14);
    EXPECT_LT((found.v_WB - state.v_WB).norm(), 1e-14);
    EXPECT_LT((found.w_WB - state.w_WB).norm(), 1e-14);
    EXPECT_TRUE(found.q == state.q);
    EXPECT_TRUE(found.qd == state.qd);
  }
}

TEST_P(Model, AFixedBaseStaysWhereResetPutIt) {
  WorldSpec spec = scenes::world_of(scenes::awkward_robot());
  spec.fixed_base = true;
  const auto backend = make(spec);
  RobotState state = backend->home_state();
  state.p_WB = {0.3, -0.2, 2};
  state.q_WB = from_roll_pitch_yaw(0.2, -0.5, 1);
  state.v_WB = {1, 2, 3};  // which a fixed base does not have
  state.w_WB = {1, 2, 3};
  backend->reset(state);
  ASSERT_EQ(backend->step({JointVector::Zero(3)}, 100), StepStatus::kOk);
  EXPECT_LT((backend->state().p_WB - state.p_WB).norm(), 1e-15);
  EXPECT_LT((backend->state().q_WB.toRotationMatrix() - state.q_WB.toRotationMatrix()).norm(), 1e-14);
  EXPECT_EQ(backend->state().v_WB.norm(), 0);
  EXPECT_EQ(backend->state().w_WB.norm(), 0);
  EXPECT_GT(backend->state().qd.norm(), 1e-3);  // its joints move
}

TEST_P(Model, MassMatrixIsThatOfTheDescription) {
  std::mt19937 random(4);
  double worst = 0;
  for (const bool fixed : {false, true}) {
    for (const scenes::RobotPtr& robot : robots()) {
      if (fixed && robot->joint_count() == 0) continue;  // nothing moves
      WorldSpec spec = scenes::world_of(robot);
      spec.fixed_base = fixed;
      const auto backend = make(spec);
      for (int n = 0; n < 100; ++n) {
        backend->reset(scenes::random_state(*robot, random));
        const Eigen::MatrixXd all = mass_matrix(*robot, backend->state());
        const Eigen::Index size = all.rows() - (fixed ? 6 : 0);
        const Eigen::MatrixXd expected = all.bottomRightCorner(size, size);
        const double difference =
            (backend->mass_matrix() - expected).cwiseAbs().maxCoeff() / expected.cwiseAbs().maxCoeff();
        worst = std::max(worst, difference);
        // Bullet's is the inverse of an inverse whose condition number is some 1e5.
        ASSERT_LT(difference, 1e-10) << robot->name << (fixed ? " fixed" : "");
      }
    }
  }
  measured("mass matrix, relative", worst);
}

TEST_P(Model, ArmatureAddsToTheDiagonalAlone) {
  RobotDescription bare = *scenes::awkward_robot();
  for (Body& body : bare.bodies) body.joint.armature = 0;
  const Eigen::MatrixXd with = make(scenes::awkward_robot())->mass_matrix();
  const Eigen::MatrixXd without = make(scenes::finished(bare))->mass_matrix();
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(with.rows(), with.cols());
  for (int i = 0; i < bare.joint_count(); ++i)
    expected(6 + i, 6 + i) = scenes::awkward_robot()->joint(i).armature;
  EXPECT_LT((with - without - expected).cwiseAbs().maxCoeff(), 1e-14);  // of entries up to 1.2
}

TEST_P(Model, GravityPullsAtEveryCentreOfMass) {
  const scenes::RobotPtr robot = scenes::without_loops(scenes::awkward_robot());
  WorldSpec spec = scenes::world_of(robot);
  spec.fixed_base = true;
  spec.gravity = {1, -2, -9};
  const auto backend = make(spec);
  std::mt19937 random(5);
  RobotState state = scenes::random_state(*robot, random);
  state.p_WB.z() = 2;  // clear of the ground
  state.v_WB = state.w_WB = Vector3::Zero();
  state.qd.setZero();
  backend->reset(state);
  const Eigen::MatrixXd M = backend->mass_matrix();
  JointTargets where_they_are;
  const std::vector<int> servos = robot->actuated_joints();
  where_they_are.q.resize(static_cast<Eigen::Index>(servos.size()));
  for (std::size_t i = 0; i < servos.size(); ++i)
    where_they_are.q[static_cast<Eigen::Index>(i)] = state.q[servos[i]];
  ASSERT_EQ(backend->step(where_they_are), StepStatus::kOk);

  const auto potential = [&](const RobotState& s) {
    std::vector<Pose> poses;
    forward_kinematics(*robot, s, poses);
    double sum = 0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const SpatialInertia& inertia = robot->bodies[i].inertia;
      sum -= inertia.mass * spec.gravity.dot(poses[i] * inertia.p_BC);
    }
    return sum;
  };
  const Eigen::VectorXd torque = M * backend->state().qd / spec.physics_dt;
  for (int i = 0; i < robot->joint_count(); ++i) {
    RobotState plus = state, minus = state;
    plus.q[i] += 1e-5;
    minus.q[i] -= 1e-5;
    // Central differences: 1e-10 from the third derivative, 1e-9 from rounding potentials of some 40 J over
    // 2e-5 rad.
    EXPECT_NEAR(torque[i], (potential(minus) - potential(plus)) / 2e-5, 2e-9);
  }
}

}  // namespace
}  // namespace crossgait
