// The inertia that Crossgait computes for Bullet's multibody, against Bullet's own algorithms.
#include "backends/bullet/composite_inertia.h"

#include <algorithm>
#include <random>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "backends/bullet/convert.h"
#include "backends/bullet/multibody_model.h"
#include "scenes/scenes.h"

namespace crossgait::bullet {
namespace {

/// A robot of Bullet's in a random pose.
struct Machine {
  Machine(const scenes::RobotPtr& robot, bool fixed, std::mt19937& random)
      : spec(scenes::world_of(robot)),
        model((spec.fixed_base = fixed, spec)),
        composite(model.body()),
        inertia(*robot, fixed, spec.physics_dt) {
    const RobotState state = scenes::random_state(*robot, random);
    btMultiBody& body = model.body();
    body.setBasePos(vector(state.p_WB));
    body.setWorldToBaseRot(quaternion(state.q_WB.conjugate()));
    for (int i = 0; i < body.getNumLinks(); ++i) body.setJointPos(i, state.q[i]);
    btAlignedObjectArray<btQuaternion> rotations;
    btAlignedObjectArray<btVector3> origins;
    body.forwardKinematics(rotations, origins);
    composite.update(inertia);
  }

  int dofs() const { return inertia.dofs(); }
  int first() const { return inertia.first_dof(); }

  /// M0^-1 by Bullet's articulated-body algorithm, rows and columns that can move.
  Eigen::MatrixXd inverse() {
    btMultiBody& body = model.body();
    btAlignedObjectArray<btScalar> r;
    btAlignedObjectArray<btVector3> v;
    btAlignedObjectArray<btMatrix3x3> m;
    body.clearForcesAndTorques();
    body.computeAccelerationsArticulatedBodyAlgorithmMultiDof(0, r, v, m, false, false, false);
    Eigen::MatrixXd result(dofs(), dofs());
    for (int c = 0; c < dofs(); ++c) {
      const Eigen::VectorXd force = Eigen::VectorXd::Unit(dofs(), c);
      body.calcAccelerationDeltasMultiDof(force.data(), result.col(c).data(), r, v);
    }
    const int size = dofs() - first();
    return result.bottomRightCorner(size, size);
  }

  WorldSpec spec;
  MultibodyModel model;
  CompositeInertia composite;
  contact::JointSpaceInertia inertia;
};

/// Calls `check` with several robots, free and fixed, in random poses.
template <typename Check>
void for_machines(Check check) {
  std::mt19937 random(1);
  for (const scenes::RobotPtr& robot :
       {scenes::quadruped(), scenes::long_quadruped(), scenes::awkward_robot()}) {
    for (const bool fixed : {false, true}) {
      for (int n = 0; n < 20; ++n) {
        Machine machine(robot, fixed, random);
        check(machine);
      }
    }
  }
}

TEST(CompositeInertia, IsTheInverseOfBulletsResponse) {
  double worst = 0;
  for_machines([&](Machine& machine) {
    const Eigen::MatrixXd inverse = machine.inverse();
    const Eigen::Index size = inverse.rows();
    const Eigen::MatrixXd M = machine.inertia.bare_matrix().bottomRightCorner(size, size);
    const double difference = (M * inverse - Eigen::MatrixXd::Identity(size, size)).cwiseAbs().maxCoeff();
    worst = std::max(worst, difference);
    EXPECT_LT(difference, 1e-9);  // rounding times the condition number of some 1e5
  });
  std::printf("measured M0 times Bullet's inverse - 1: %.3g\n", worst);
}

TEST(JointSpaceInertia, SolvesWithArmature) {
  for_machines([&](Machine& machine) {
    const int n = machine.dofs(), size = n - machine.first();
    Eigen::MatrixXd M = machine.inertia.bare_matrix().bottomRightCorner(size, size);
    for (int i = 0; i < n - 6; ++i)
      M(size - n + 6 + i, size - n + 6 + i) += machine.spec.robot->joint(i).armature;
    const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(n, -1, 1);
    DofVector x = b;
    machine.inertia.half_solve(x);
    const double energy = x.squaredNorm();
    machine.inertia.finish_solve(x);
    const Eigen::VectorXd expected = M.partialPivLu().solve(b.tail(size));
    EXPECT_LT((x.tail(size) - expected).norm(), 1e-11 * expected.norm());
    EXPECT_NEAR(energy, b.tail(size).dot(expected), 1e-11 * energy);
    for (int i = 0; i < machine.first(); ++i) EXPECT_EQ(x[i], 0);
  });
}

TEST(JointSpaceInertia, HalfMultipliesBack) {
  for_machines([&](Machine& machine) {
    const DofVector x = Eigen::VectorXd::LinSpaced(machine.dofs(), 2, -1);
    DofVector y = x;
    machine.inertia.half_multiply(y);
    machine.inertia.finish_solve(y);
    EXPECT_LT((y - x).tail(machine.dofs() - machine.first()).norm(), 1e-12 * x.norm());
    for (int i = 0; i < machine.first(); ++i) EXPECT_EQ(y[i], 0);
  });
}

TEST(JointSpaceInertia, HalfSolvesThePointsOfABodyByWhatMovesIt) {
  for_machines([&](Machine& machine) {
    const int n = machine.dofs();
    for (int body = machine.first() > 0 ? 1 : 0; body <= n - 6; ++body) {
      PointJacobian J(3, n);
      machine.composite.point_jacobian(body - 1, {0.1, 0.2, 0.3}, J);
      const PointJacobian whole = J;
      const std::vector<int> dofs = machine.inertia.dofs_of(body);
      machine.inertia.half_solve_rows(dofs, J);
      ASSERT_TRUE(std::is_sorted(dofs.begin(), dofs.end()));
      for (int row = 0; row < 3; ++row) {
        DofVector expected = whole.row(row).transpose();
        machine.inertia.half_solve(expected);
        DofVector found = DofVector::Zero(n);
        for (const int dof : dofs) found[dof] = J(row, dof);
        EXPECT_LT((found - expected).norm(), 1e-14 * (1 + expected.norm()));
      }
    }
  });
}

TEST(JointSpaceInertia, MultipliesWithoutArmature) {
  for_machines([&](Machine& machine) {
    const int n = machine.dofs(), size = n - machine.first();
    const DofVector x = Eigen::VectorXd::LinSpaced(n, 2, -1);
    DofVector y(n);
    machine.inertia.multiply_bare(x, y);
    const Eigen::VectorXd expected =
        machine.inertia.bare_matrix().bottomRightCorner(size, size) * x.tail(size);
    EXPECT_LT((y.tail(size) - expected).norm(), 1e-14 * expected.norm());
  });
}

TEST(CompositeInertia, PointJacobianIsBulletsContactJacobian) {
  for_machines([&](Machine& machine) {
    const btMultiBody& body = machine.model.body();
    btAlignedObjectArray<btScalar> r;
    btAlignedObjectArray<btVector3> v;
    btAlignedObjectArray<btMatrix3x3> m;
    const int n = machine.dofs();
    PointJacobian J(3, n);
    Eigen::VectorXd row(n);
    for (int link = -1; link < body.getNumLinks(); ++link) {
      const btVector3 point = body.localPosToWorld(link, btVector3(0.03, -0.02, 0.05));
      machine.composite.point_jacobian(link, vector(point), J);
      for (int k = 0; k < 3; ++k) {
        btVector3 normal(0, 0, 0);
        normal[k] = 1;
        body.fillContactJacobianMultiDof(link, point, normal, row.data(), r, v, m);
        EXPECT_LT((J.row(k).tail(n - machine.first()).transpose() - row.tail(n - machine.first())).norm(),
                  1e-14);
      }
    }
  });
}

}  // namespace
}  // namespace crossgait::bullet
