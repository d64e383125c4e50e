// What an engine made of the description: masses, inertias, frames, axes, armature, gravity.
#include <algorithm>
#include <random>

#include <Eigen/Eigenvalues>

#include "conformance/topics.h"
#include "physics/robot/multibody.h"

namespace crossgait::conformance {
namespace {

std::vector<scenes::RobotPtr> robots() {
  return {scenes::quadruped(), scenes::long_quadruped(), scenes::awkward_robot(), scenes::tumbling_body()};
}

std::vector<double> mass_properties(const Subject& subject) {
  double mass = 0, inertia = 0, centre = 0;
  for (const scenes::RobotPtr& robot : robots()) {
    const auto world = subject.make(robot);
    for (int i = 0; i <= robot->joint_count(); ++i) {
      const SpatialInertia expected = robot->bodies[static_cast<std::size_t>(i)].inertia;
      const SpatialInertia found = world->body_inertia(i);
      mass = std::max(mass, std::abs(found.mass / expected.mass - 1));
      inertia = std::max(
          inertia, (found.I_C - expected.I_C).cwiseAbs().maxCoeff() / expected.I_C.cwiseAbs().maxCoeff());
      centre = std::max(centre, (found.p_BC - expected.p_BC).norm());
    }
  }
  return {mass, inertia, centre};
}

std::vector<double> frames(const Subject& subject) {
  std::mt19937 random(1);
  double worst = 0;
  for (const bool fixed : {false, true}) {
    for (const scenes::RobotPtr& robot : robots()) {
      WorldSpec spec = scenes::world_of(robot);
      spec.fixed_base = fixed;
      const auto world = subject.make(spec);
      for (int n = 0; n < 20; ++n) {
        const RobotState state = scenes::random_state(*robot, random);
        world->reset(state);
        std::vector<Pose> poses;
        forward_kinematics(*robot, state, poses);
        for (int i = 0; i <= robot->joint_count(); ++i) {
          const Pose found = world->body_pose(i), expected = poses[static_cast<std::size_t>(i)];
          worst = std::max(worst, (found.matrix() - expected.matrix()).cwiseAbs().maxCoeff());
        }
      }
    }
  }
  return {worst};
}

std::vector<double> reset_state(const Subject& subject) {
  std::mt19937 random(3);
  double position = 0, attitude = 0, velocity = 0, joints = 0;
  for (const scenes::RobotPtr& robot : robots()) {
    const auto world = subject.make(robot);
    RobotState state = scenes::random_state(*robot, random);
    state.time = 12.5;
    world->reset(state);
    const RobotState& found = world->state();
    position = std::max({position, (found.p_WB - state.p_WB).norm(), std::abs(found.time - state.time)});
    attitude = std::max(attitude, (found.q_WB.toRotationMatrix() - state.q_WB.toRotationMatrix()).norm());
    velocity = std::max({velocity, (found.v_WB - state.v_WB).norm(), (found.w_WB - state.w_WB).norm()});
    joints =
        std::max({joints, relative_difference(found.q, state.q), relative_difference(found.qd, state.qd)});
  }
  return {position, attitude, velocity, joints};
}

std::vector<double> fixed_base(const Subject& subject) {
  WorldSpec spec = scenes::world_of(scenes::awkward_robot());
  spec.fixed_base = true;
  const auto world = subject.make(spec);
  RobotState state = world->home_state();
  state.p_WB = {0.3, -0.2, 2};
  state.q_WB = from_roll_pitch_yaw(0.2, -0.5, 1);
  state.v_WB = {1, 2, 3};  // which a fixed base does not have
  state.w_WB = {1, 2, 3};
  world->reset(state);
  advance(*world, {JointVector::Zero(3)}, 100);
  const RobotState& s = world->state();
  return {(s.p_WB - state.p_WB).norm(), (s.q_WB.toRotationMatrix() - state.q_WB.toRotationMatrix()).norm(),
          s.v_WB.norm() + s.w_WB.norm(), s.qd.norm()};
}

std::vector<double> inertia(const Subject& subject) {
  std::mt19937 random(4);
  double worst = 0, asymmetry = 0, least = std::numeric_limits<double>::infinity();
  for (const bool fixed : {false, true}) {
    for (const scenes::RobotPtr& robot : robots()) {
      if (fixed && robot->joint_count() == 0) continue;  // nothing moves
      WorldSpec spec = scenes::world_of(robot);
      spec.fixed_base = fixed;
      const auto world = subject.make(spec);
      for (int n = 0; n < 100; ++n) {
        world->reset(scenes::random_state(*robot, random));
        const Eigen::MatrixXd all = crossgait::mass_matrix(*robot, world->state()), M = world->mass_matrix();
        const Eigen::Index size = all.rows() - (fixed ? 6 : 0);
        if (M.rows() != size || M.cols() != size) return {HUGE_VAL, HUGE_VAL, HUGE_VAL};
        const Eigen::MatrixXd expected = all.bottomRightCorner(size, size);
        const double scale = expected.cwiseAbs().maxCoeff();
        worst = std::max(worst, (M - expected).cwiseAbs().maxCoeff() / scale);
        asymmetry = std::max(asymmetry, (M - M.transpose()).cwiseAbs().maxCoeff() / scale);
        least = std::min(least, Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(M).eigenvalues()[0]);
      }
    }
  }
  return {worst, asymmetry, least};
}

// One step from rest: M qd' = h times the slope of the potential.
std::vector<double> gravity(const Subject& subject) {
  const scenes::RobotPtr robot = scenes::without_loops(scenes::awkward_robot());
  WorldSpec spec = scenes::world_of(robot);
  spec.fixed_base = true;
  spec.gravity = {1, -2, -9};
  const auto world = subject.make(spec);
  std::mt19937 random(5);
  RobotState state = scenes::random_state(*robot, random);
  state.p_WB.z() = 2;  // clear of the ground
  state.v_WB = state.w_WB = Vector3::Zero();
  state.qd.setZero();
  world->reset(state);
  const Eigen::MatrixXd M = world->mass_matrix();
  JointTargets where_they_are;
  const std::vector<int> servos = robot->actuated_joints();
  where_they_are.q.resize(static_cast<Eigen::Index>(servos.size()));
  for (std::size_t i = 0; i < servos.size(); ++i)
    where_they_are.q[static_cast<Eigen::Index>(i)] = state.q[servos[i]];
  advance(*world, where_they_are);

  const auto potential = [&](const RobotState& s) {
    std::vector<Pose> poses;
    forward_kinematics(*robot, s, poses);
    double sum = 0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const SpatialInertia& body = robot->bodies[i].inertia;
      sum -= body.mass * spec.gravity.dot(poses[i] * body.p_BC);
    }
    return sum;
  };
  const Eigen::VectorXd torque = M * world->state().qd / spec.physics_dt;
  double worst = 0;
  for (int i = 0; i < robot->joint_count(); ++i) {
    RobotState plus = state, minus = state;
    plus.q[i] += 1e-5;
    minus.q[i] -= 1e-5;
    worst = std::max(worst, std::abs(torque[i] - (potential(minus) - potential(plus)) / 2e-5));
  }
  return {worst};
}

}  // namespace

std::vector<Check> model_checks() {
  return {
      {"mass_properties",
       "Bodies have the masses, centres of mass and inertias of the description",
       {rounds_to(1, "mass, off, relative", "", "the number next to it, or the inverse of its inverse"),
        rounds_to(100, "inertia, off, relative", "", "principal moments and axes come back by a rotation"),
        rounds_to(4, "centre of mass, off", "m", "rounding of centimetres")},
       mass_properties},
      {"frames",
       "Bodies are where forward kinematics puts them: placement of joints, axes, attitude of the base",
       {rounds_to(100, "poses, off", "m, -", "rounding along five joints, of places 2 m up")},
       frames},
      {"reset_state",
       "A state comes back as it was given",
       {rounds_to(4, "position and time, off", "m, s", "rounding of 2 m and of a lever of centimetres"),
        rounds_to(20, "attitude, off", "", "rounding of a turn to the principal axes and back"),
        rounds_to(20, "velocity of the base's origin and turning, off", "m/s, rad/s",
                  "rounding of some m/s and rad/s"),
        rounds_to(0.5, "joints, off, relative", "", "the numbers next to them: half an eps")},
       reset_state},
      {"fixed_base",
       "A fixed base stays where a reset put it, and its joints move",
       {rounds_to(4, "position, off", "m", "rounding of 2 m and of a lever of centimetres"),
        rounds_to(20, "attitude, off", "", "rounding of a turn to the principal axes and back"),
        at_most(0, "velocities", "m/s, rad/s", "it has none"),
        at_least(1e-3, "speed of the joints", "rad/s", "gravity pulls at them")},
       fixed_base},
      {"inertia",
       "The joint-space inertia that the engine steps with is the description's, for [v_WB, w_WB, qd]",
       {with_rounding(at_most(1e-10, "off the composite-rigid-body algorithm, relative", "",
                              "may be the inverse of an inverse of condition 1e5; rounding of 21 bodies"),
                      100),
        rounds_to(100, "asymmetry, relative", "", "rounding of 21 bodies"),
        at_least(1e-9, "least eigenvalue", "kg, kg m^2", "positive, well above rounding")},
       inertia},
      {"gravity",
       "Gravity pulls at every centre of mass, in any direction",
       {with_rounding(at_most(2e-9, "torque in a step from rest, off the potential's slope", "N m",
                              "central differences of 40 J over 2e-5 rad; rounding of some N m"),
                      1000)},
       gravity},
  };
}

}  // namespace crossgait::conformance
