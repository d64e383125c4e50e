#include "physics/robot/multibody.h"

#include <cmath>
#include <random>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "tests/physics/robot_files/scratch_robot.h"

namespace crossgait {
namespace {

const char* const kRobots[] = {"scara_quadruped", "scara_quadruped_long"};

RobotDescription load_model(const std::string& name) {
  return load_robot(std::string(CROSSGAIT_SOURCE_DIR "/models/robots/") + name + "/robot.yaml");
}

/// Any pose and velocity, loops open: the tree's algorithms do not know of loops.
RobotState random_state(const RobotDescription& robot, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto vector = [&] { return Vector3(uniform(random), uniform(random), uniform(random)); };
  RobotState state;
  state.p_WB = vector();
  state.q_WB = from_roll_pitch_yaw(uniform(random), uniform(random), 3 * uniform(random));
  state.v_WB = vector();
  state.w_WB = 3 * vector();
  state.q = state.qd = JointVector::Zero(robot.joint_count());
  for (double& angle : state.q) angle = uniform(random);
  for (double& rate : state.qd) rate = 3 * uniform(random);
  return state;
}

/// The state `dt` later if velocities stay as they are.
RobotState advanced(RobotState state, double dt) {
  state.p_WB += dt * state.v_WB;
  const double angle = dt * state.w_WB.norm();
  state.q_WB = Quaternion(Eigen::AngleAxisd(angle, state.w_WB.normalized())) * state.q_WB;
  state.q += dt * state.qd;
  return state;
}

Eigen::VectorXd velocity(const RobotState& state) {
  Eigen::VectorXd v(6 + state.qd.size());
  v << state.v_WB, state.w_WB, state.qd;
  return v;
}

/// Sum of 1/2 m v^2 + 1/2 w I w over bodies, with velocities by central differences of the poses, and the
/// rotors'.
double kinetic_energy(const RobotDescription& robot, const RobotState& state) {
  constexpr double dt = 1e-5;
  std::vector<Pose> before, after, now;
  forward_kinematics(robot, advanced(state, -dt), before);
  forward_kinematics(robot, advanced(state, dt), after);
  forward_kinematics(robot, state, now);
  double energy = 0;
  for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
    const SpatialInertia& inertia = robot.bodies[i].inertia;
    const Vector3 v = (after[i] * inertia.p_BC - before[i] * inertia.p_BC) / (2 * dt);
    const Eigen::AngleAxisd turn(after[i].linear() * before[i].linear().transpose());
    const Vector3 w = now[i].linear().transpose() * turn.axis() * turn.angle() / (2 * dt);
    energy += 0.5 * inertia.mass * v.squaredNorm() + 0.5 * w.dot(inertia.I_C * w);
  }
  for (int i = 0; i < robot.joint_count(); ++i) {
    energy += 0.5 * robot.joint(i).armature * state.qd[i] * state.qd[i];
  }
  return energy;
}

TEST(Multibody, JacobianAndVelocitiesAreDifferencesOfPoses) {
  constexpr double dt = 1e-5;
  const Vector3 p_BP(0.03, -0.02, 0.05);
  for (const char* name : kRobots) {
    const RobotDescription robot = load_model(name);
    std::mt19937 random(3);
    const RobotState state = random_state(robot, random);
    std::vector<Pose> before, after, now;
    std::vector<BodyVelocity> velocities;
    forward_kinematics(robot, advanced(state, -dt), before);
    forward_kinematics(robot, advanced(state, dt), after);
    forward_kinematics(robot, state, now);
    forward_velocities(robot, state, now, velocities);
    for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
      const Eigen::MatrixXd J = point_jacobian(robot, now, static_cast<int>(i), p_BP);
      const Eigen::Matrix<double, 6, 1> moved = J * velocity(state);
      const Eigen::AngleAxisd turn(after[i].linear() * before[i].linear().transpose());
      const Vector3 v = (after[i] * p_BP - before[i] * p_BP) / (2 * dt),
                    w = turn.axis() * turn.angle() / (2 * dt);
      // Third order in dt with rates up to 10 rad/s: 1e-10 * 1e3 / 6 and rounding, 1e-16 / dt.
      EXPECT_LT((moved.head<3>() - v).norm(), 1e-7) << name << i;
      EXPECT_LT((moved.tail<3>() - w).norm(), 1e-7) << name << i;
      const Vector3 at_point = velocities[i].v + velocities[i].w.cross(now[i].linear() * p_BP);
      // The same sums in another order: rounding of numbers up to 20.
      EXPECT_LT((at_point - moved.head<3>()).norm(), 1e-13) << name << i;
      EXPECT_LT((velocities[i].w - moved.tail<3>()).norm(), 1e-13) << name << i;
    }
  }
}

TEST(Multibody, PendulumHasTheTextbookInertia) {
  RobotDescription robot = pendulum_chain(1);
  robot.bodies[1].joint.armature = 0.01;
  RobotState state;
  state.q = JointVector::Constant(1, 0.7);
  // m l^2 + Iyy + armature; rounding of order-one sums.
  EXPECT_NEAR(mass_matrix(robot, state)(6, 6), 1 * 0.3 * 0.3 + 0.03 + 0.01, 1e-15);
}

TEST(Multibody, DoublePendulumHasTheTextbookMassMatrix) {
  const RobotDescription robot = pendulum_chain(2);
  RobotState state;
  state.q.resize(2);
  state.q << 0.4, 1.1;
  const Eigen::MatrixXd M = mass_matrix(robot, state);
  // Relative angles; L = 0.5, l = 0.3, m = 1, I = 0.03.
  const double L = 0.5, l = 0.3, I = 0.03, c = std::cos(1.1);
  EXPECT_NEAR(M(6, 6), l * l + I + L * L + l * l + 2 * L * l * c + I, 1e-15);  // rounding
  EXPECT_NEAR(M(6, 7), l * l + L * l * c + I, 1e-15);
  EXPECT_NEAR(M(7, 7), l * l + I, 1e-15);
  EXPECT_EQ(M(6, 7), M(7, 6));
}

TEST(Multibody, BaseBlockIsThatOfTheWholeAsOneRigidBody) {
  for (const char* name : kRobots) {
    const RobotDescription robot = load_model(name);
    std::mt19937 random(1);
    const RobotState state = random_state(robot, random);
    std::vector<Pose> poses;
    forward_kinematics(robot, state, poses);
    Vector3 first_moment = Vector3::Zero();  // about the base origin
    Matrix3 rotational = Matrix3::Zero();
    for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
      const SpatialInertia& inertia = robot.bodies[i].inertia;
      const Vector3 c = poses[i] * inertia.p_BC - state.p_WB;
      const Matrix3 R = poses[i].linear();
      first_moment += inertia.mass * c;
      rotational += R * inertia.I_C * R.transpose() +
                    inertia.mass * (c.squaredNorm() * Matrix3::Identity() - c * c.transpose());
    }
    const Eigen::MatrixXd M = mass_matrix(robot, state);
    // Rounding of sums of 21 bodies of about 1 kg.
    EXPECT_LT((M.topLeftCorner<3, 3>() - robot.total_mass() * Matrix3::Identity()).norm(), 1e-14) << name;
    EXPECT_LT((M.block<3, 3>(3, 3) - rotational).norm(), 1e-14) << name;
    const Vector3 w(0.3, -0.7, 1.1);  // turning about the base origin moves the centre of mass by w x c
    EXPECT_LT((M.block<3, 3>(0, 3) * w - w.cross(first_moment)).norm(), 1e-14) << name;
  }
}

TEST(Multibody, MassMatrixGivesTheKineticEnergy) {
  for (const char* name : kRobots) {
    const RobotDescription robot = load_model(name);
    std::mt19937 random(2);
    for (int sample = 0; sample < 20; ++sample) {
      const RobotState state = random_state(robot, random);
      const Eigen::VectorXd v = velocity(state);
      const double energy = 0.5 * v.dot(mass_matrix(robot, state) * v);
      // Central differences: truncation (3 rad/s * 1e-5 s)^2 and rounding 1e-16 / 1e-5, both near 1e-9
      // relative to some 10 J.
      EXPECT_NEAR(energy, kinetic_energy(robot, state), 1e-7) << name << ", sample " << sample;
    }
  }
}

TEST(Multibody, EveryEntryOfTheMassMatrixFollowsFromKineticEnergies) {
  // M_ij = T(e_i + e_j) - T(e_i) - T(e_j): an error of single entries cannot hide in a sum.
  const RobotDescription robot = load_model("scara_quadruped");
  std::mt19937 random(3);
  const RobotState pose = random_state(robot, random);
  const Eigen::MatrixXd M = mass_matrix(robot, pose);
  const auto energy = [&](const Eigen::VectorXd& v) {
    RobotState state = pose;
    state.v_WB = v.head<3>();
    state.w_WB = v.segment<3>(3);
    state.qd = v.tail(robot.joint_count());
    return kinetic_energy(robot, state);
  };
  const auto unit = [&](Eigen::Index i) { return Eigen::VectorXd::Unit(M.rows(), i); };
  for (Eigen::Index i = 0; i < M.rows(); ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      const double entry = energy(unit(i) + unit(j)) - energy(unit(i)) - energy(unit(j));
      // Differences of energies below 2 J, known to 1e-10; the smallest inertia of a link is 2e-6.
      EXPECT_NEAR(M(i, j), entry, 1e-9) << i << ", " << j;
      EXPECT_EQ(M(i, j), M(j, i));
    }
  }
}

TEST(Multibody, MassMatrixIsPositiveDefinite) {
  for (const char* name : kRobots) {
    const RobotDescription robot = load_model(name);
    std::mt19937 random(4);
    for (int sample = 0; sample < 20; ++sample) {
      const Eigen::LLT<Eigen::MatrixXd> llt(mass_matrix(robot, random_state(robot, random)));
      EXPECT_EQ(llt.info(), Eigen::Success) << name;
    }
  }
}

TEST(Multibody, FeetAreWhereTheDrawingsHaveThem) {
  const RobotDescription robot = load_model("scara_quadruped");
  RobotState state;
  state.q = JointVector::Zero(robot.joint_count());
  std::vector<Pose> poses;
  forward_kinematics(robot, state, poses);
  // Zero angles: the left chain hangs straight down from its shoulder at mount + (-0.010, +-0.024, -0.010),
  // links 0.045 and 0.060 long. Rounding of a handful of sums.
  EXPECT_LT((foot_position(robot, Leg::FL, poses) - Vector3(0.065, 0.062, -0.1025)).norm(), 1e-16);
  EXPECT_LT((foot_position(robot, Leg::RR, poses) - Vector3(-0.085, -0.062, -0.1025)).norm(), 1e-16);

  // Angles about +y turn the leg backwards; the elbow's angle counts from the upper link.
  const LegModel& leg = (*robot.legs)[Leg::FR];
  state.q[leg.joint("shoulder_left")] = 0.5;
  state.q[leg.joint("elbow_left")] = -1.2;
  forward_kinematics(robot, state, poses);
  const double x = 0.065 - 0.045 * std::sin(0.5) - 0.060 * std::sin(0.5 - 1.2);
  const double z = 0.0025 - 0.045 * std::cos(0.5) - 0.060 * std::cos(0.5 - 1.2);
  EXPECT_LT((foot_position(robot, Leg::FR, poses) - Vector3(x, -0.062, z)).norm(), 1e-16);

  // Tilt about +x through the mount at (0.075, -0.038, 0.0125), positive towards +y for every leg.
  state.q[leg.joint("tilt")] = 0.3;
  forward_kinematics(robot, state, poses);
  const double y = -0.038 - 0.024 * std::cos(0.3) - (z - 0.0125) * std::sin(0.3);
  const double z_tilted = 0.0125 - 0.024 * std::sin(0.3) + (z - 0.0125) * std::cos(0.3);
  EXPECT_LT((foot_position(robot, Leg::FR, poses) - Vector3(x, y, z_tilted)).norm(), 1e-16);
}

TEST(Multibody, PosesMoveWithTheBase) {
  const RobotDescription robot = load_model("scara_quadruped");
  RobotState state;
  state.q = robot.home;
  std::vector<Pose> at_origin, moved;
  forward_kinematics(robot, state, at_origin);
  state.p_WB = {1, -2, 3};
  state.q_WB = from_roll_pitch_yaw(0.1, 0.2, 2.0);
  forward_kinematics(robot, state, moved);
  for (std::size_t i = 0; i < moved.size(); ++i) {
    // Rounding of coordinates up to 3 m.
    EXPECT_LT((moved[i].matrix() - (state.X_WB() * at_origin[i]).matrix()).norm(), 1e-14);
  }
}

TEST(Multibody, LoopGapIsTheLargestDistance) {
  RobotDescription robot = load_model("scara_quadruped");
  RobotState state;
  state.q = robot.home;
  std::vector<Pose> poses;
  forward_kinematics(robot, state, poses);
  EXPECT_LT(max_loop_gap(robot, poses), 1e-15);  // rounding of lengths of 0.1 m

  state.q[(*robot.legs)[Leg::RL].joint("elbow_right")] += 0.1;  // a chord of the lower link's circle
  state.q[(*robot.legs)[Leg::FR].joint("elbow_right")] += 0.01;
  forward_kinematics(robot, state, poses);
  EXPECT_NEAR(max_loop_gap(robot, poses), 2 * 0.060 * std::sin(0.05), 1e-15);

  robot.loops.clear();
  EXPECT_EQ(max_loop_gap(robot, poses), 0);
}

TEST(Multibody, InverseWeightOfAFreeBodyIsOneOverItsMass) {
  RobotDescription robot = pendulum_chain(0);
  robot.bodies[0].inertia.mass = 4;
  EXPECT_NEAR(translational_inverse_weights(robot, false).at(0), 0.25, 1e-16);  // rounding
  EXPECT_EQ(translational_inverse_weights(robot, true), std::vector<double>{0});
}

TEST(Multibody, InverseWeightOfAPendulumFollowsFromItsInertia) {
  RobotDescription robot = pendulum_chain(1);
  robot.bodies[1].joint.armature = 0.05;
  const std::vector<double> weights = translational_inverse_weights(robot, true);
  EXPECT_EQ(weights[0], 0);
  // Only x moves, by l per radian: l^2 / (m l^2 + I + armature) / 3.
  EXPECT_NEAR(weights[1], 0.09 / (0.09 + 0.03 + 0.05) / 3, 1e-15);  // rounding
}

TEST(Multibody, InverseWeightsAreTakenAtZeroAnglesOfWhateverHome) {
  RobotDescription robot = load_model("scara_quadruped");
  const std::vector<double> weights = translational_inverse_weights(robot, false);
  robot.home.setZero();
  EXPECT_EQ(translational_inverse_weights(robot, false), weights);

  // An impulse at the centre of mass of body k changes its velocity by J M^-1 J^T, here through finite
  // differences.
  RobotState state;
  state.q = JointVector::Zero(robot.joint_count());
  const Eigen::MatrixXd inverse = mass_matrix(robot, state).inverse();
  for (std::size_t k = 0; k < robot.bodies.size(); ++k) {
    Eigen::MatrixXd J(3, inverse.rows());
    for (Eigen::Index i = 0; i < J.cols(); ++i) {
      const Eigen::VectorXd v = Eigen::VectorXd::Unit(J.cols(), i);
      RobotState moving = state;
      moving.v_WB = v.head<3>();
      moving.w_WB = v.segment<3>(3);
      moving.qd = v.tail(robot.joint_count());
      constexpr double dt = 1e-5;
      std::vector<Pose> before, after;
      forward_kinematics(robot, advanced(moving, -dt), before);
      forward_kinematics(robot, advanced(moving, dt), after);
      const Vector3 p_BC = robot.bodies[k].inertia.p_BC;
      J.col(i) = (after[k] * p_BC - before[k] * p_BC) / (2 * dt);
    }
    // Differences are good to 1e-10 of entries of order 0.1, in a product with M^-1 of up to 5e3.
    EXPECT_NEAR(weights[k], (J * inverse * J.transpose()).trace() / 3, 1e-6 * weights[k])
        << robot.bodies[k].name;
  }
}

}  // namespace
}  // namespace crossgait
