// DART's forward dynamics, Jacobians and inertias as this engine takes them, held against one another.
#include "backends/dart/skeleton_model.h"

#include <random>

#include <gtest/gtest.h>

#include "scenes/scenes.h"

namespace crossgait::dart {
namespace {

using contact::DofVector;
using contact::PointJacobian;

/// A robot of DART's in a random pose, moving.
struct Machine {
  Machine(const scenes::RobotPtr& robot, bool fixed, std::mt19937& random)
      : spec(scenes::world_of(robot)),
        model((spec.fixed_base = fixed, spec)),
        inertia(*robot, fixed, spec.physics_dt) {
    const RobotState state = scenes::random_state(*robot, random);
    X_WC = make_pose(state.q_WB, state.p_WB);
    q = state.q;
    v.setZero(6 + q.size());
    if (!fixed) v.head<6>() << state.w_WB, state.v_WB;
    v.tail(q.size()) = state.qd;
    model.place(X_WC, q, v);
    model.bare_inertia(inertia);
  }

  int first() const { return inertia.first_dof(); }

  WorldSpec spec;
  SkeletonModel model;
  contact::JointSpaceInertia inertia;
  Pose X_WC;
  JointVector q;
  DofVector v;
};

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

/// A tenth of a metre ahead of a body's centre of mass.
Vector3 point_of(const Machine& machine, int body) {
  const SpatialInertia& own = machine.spec.robot->bodies[static_cast<std::size_t>(body)].inertia;
  const Pose X_WB = machine.model.X_WC(body) * machine.model.X_BC()[static_cast<std::size_t>(body)].inverse();
  return X_WB * Vector3(own.p_BC + Vector3(0.1, 0, 0));
}

// A robot at rest is moved by gravity and by the push: sum of J' m g + J' F.
TEST(SkeletonModel, ForcesAreThoseOfItsJacobians) {
  const Vector3 push(3, -2, 5);
  for_machines([&](Machine& machine) {
    const RobotDescription& robot = *machine.spec.robot;
    DofVector rest = DofVector::Zero(machine.v.size());
    machine.model.place(machine.X_WC, machine.q, rest);
    DofVector force = rest, impulse;
    machine.model.free_impulse(1, {push}, machine.inertia, rest, impulse);  // of a second
    PointJacobian J;
    for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
      const int body = static_cast<int>(i);
      const Pose X_WB = machine.model.X_WC(body) * machine.model.X_BC()[i].inverse();
      machine.model.point_jacobian(body, X_WB * robot.bodies[i].inertia.p_BC, J);
      force += J.transpose() *
               (robot.bodies[i].inertia.mass * machine.spec.gravity + (i == 0 ? push : Vector3::Zero()));
    }
    const Eigen::Index size = rest.size() - machine.first();
    EXPECT_LT((impulse - force).tail(size).norm(), 1e-12 * force.tail(size).norm());  // rounding
  });
}

// J v is how fast a point of the body goes: against where it is a moment before and after.
TEST(SkeletonModel, PointJacobiansAreTheVelocitiesOfPoints) {
  constexpr double kMoment = 1e-6;
  for_machines([&](Machine& machine) {
    const int body = machine.spec.robot->joint_count();
    const Vector3 p = point_of(machine, body);
    const Vector3 p_C = machine.model.X_WC(body).inverse() * p;
    PointJacobian J;
    machine.model.point_jacobian(body, p, J);
    const Vector3 expected = J * machine.v;
    std::array<Vector3, 2> places;
    for (const double sign : {-1.0, 1.0}) {
      const double t = sign * kMoment;
      Pose X = machine.X_WC;
      const Vector3 turn = t * machine.v.head<3>();
      if (turn.norm() > 0) X.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * X.linear();
      X.translation() += t * machine.v.segment<3>(3);
      machine.model.place(X, machine.q + t * machine.v.tail(machine.q.size()), machine.v);
      places[sign > 0 ? 1 : 0] = machine.model.X_WC(body) * p_C;
    }
    const Vector3 measured = (places[1] - places[0]) / (2 * kMoment);
    EXPECT_LT((measured - expected).norm(), 1e-7 * (1 + expected.norm()));  // of the difference quotient
  });
}

// DART's own way there and back loses the third order of small angles.
TEST(SkeletonModel, TurnsTheBaseExactly) {
  WorldSpec spec = scenes::world_of(scenes::quadruped());
  SkeletonModel model(spec);
  const JointVector q = JointVector::Zero(spec.robot->joint_count());
  const DofVector v = DofVector::Zero(6 + q.size());
  for (const double angle : {1e-9, 1e-6, 1e-4, 1e-3, 0.1, 3.1}) {
    Pose X = Pose::Identity();
    X.linear() = Eigen::AngleAxisd(angle, Vector3(1, -2, 3).normalized()).toRotationMatrix();
    X.translation() = Vector3(1, 2, 3);
    model.place(X, q, v);
    EXPECT_EQ((model.X_WC(0).matrix() - X.matrix()).norm(), 0) << angle;
  }
}

TEST(SkeletonModel, HoldsTheDescriptionsInertias) {
  for_machines([&](Machine& machine) {
    for (std::size_t i = 0; i < machine.spec.robot->bodies.size(); ++i) {
      const SpatialInertia &own = machine.spec.robot->bodies[i].inertia,
                           held = machine.model.inertia(static_cast<int>(i));
      EXPECT_EQ(held.mass, own.mass);
      EXPECT_LT((held.p_BC - own.p_BC).norm(), 1e-16);
      EXPECT_LT((held.I_C - own.I_C).norm(), 1e-16);
    }
  });
}

}  // namespace
}  // namespace crossgait::dart
