// Bodies in the air: Newton's and Euler's laws, without any help from the ground.
#include <algorithm>
#include <cmath>
#include <utility>

#include "conformance/topics.h"
#include "physics/robot/multibody.h"
#include "scenes/analytic.h"

namespace crossgait::conformance {
namespace {

std::vector<double> free_fall(const Subject& subject) {
  const Vector3 p0(0.1, -0.2, 30), v0(0.3, 0.2, 1);
  double apart = 0, late = 0, turning = 0;
  for (const double h : {1e-3, 5e-4}) {
    WorldSpec spec = scenes::world_of(scenes::tumbling_body());
    spec.physics_dt = h;
    spec.gravity = {0.5, -0.25, -9.81};
    const auto world = subject.make(spec);
    RobotState start = world->home_state();
    start.p_WB = p0;
    start.v_WB = v0;
    start.q_WB = from_roll_pitch_yaw(0.3, 0.2, -2);
    world->reset(start);
    while (world->state().time < 1 - h / 2) {
      advance(*world, {});
      const RobotState& s = world->state();
      const Vector3 p = p0 + v0 * s.time + spec.gravity * (s.time * (s.time + h) / 2);
      apart = std::max({apart, (s.v_WB - (v0 + spec.gravity * s.time)).norm(), (s.p_WB - p).norm()});
    }
    const Vector3 parabola = p0 + v0 + spec.gravity / 2;
    late = std::max(late, std::abs((world->state().p_WB - parabola).norm() - spec.gravity.norm() * h / 2));
    turning = std::max(turning, world->state().w_WB.norm());
  }
  return {apart, late, turning};
}

std::vector<double> robot_falls_as_one(const Subject& subject) {
  const auto world = subject.make(scenes::quadruped());
  RobotState start = world->home_state();
  start.p_WB.z() = 3;
  world->reset(start);
  advance(*world, scenes::home_targets(world->robot()), 500);
  const double t = 0.5, h = 1e-3;
  const RobotState& s = world->state();
  return {std::abs(s.p_WB.z() - (3 - kGravity * t * (t + h) / 2)), std::abs(s.v_WB.z() + kGravity * t),
          (s.q - start.q).lpNorm<Eigen::Infinity>()};
}

std::vector<double> tumbling(const Subject& subject) {
  const auto drift = [&](double h) { return scenes::measure_tumbling(subject.engine, h); };
  const scenes::TumblingDrift coarse = drift(1e-3), fine = drift(5e-4), finest = drift(2.5e-4);
  const double eps = epsilon(subject.precision()),
               rounding = 500 * eps;  // of 4000 steps; energy's is of squares
  return {coarse.momentum,
          convergence(fine.momentum, coarse.momentum, 0.5, rounding),
          convergence(finest.momentum, fine.momentum, 0.5, rounding),
          convergence(finest.energy, fine.energy, 0.5, 4 * rounding),
          std::abs(coarse.energy / coarse.predicted_energy),
          coarse.velocity,
          coarse.position};
}

/// Columns of `mass_matrix`: [v_WB, w_WB, qd].
Eigen::VectorXd velocities(const RobotState& s) {
  Eigen::VectorXd v(6 + s.qd.size());
  v << s.v_WB, s.w_WB, s.qd;
  return v;
}

/// Linear (kg m/s) and angular (about the centre of mass, kg m^2/s) momentum of a whole robot.
std::pair<Vector3, Vector3> momenta(const RobotDescription& robot, const RobotState& s) {
  RobotDescription bare = robot;  // the rotors that armature stands for carry no momentum of the robot's
  for (Body& body : bare.bodies) body.joint.armature = 0;
  const Eigen::VectorXd p = mass_matrix(bare, s) * velocities(s);
  std::vector<Pose> poses;
  forward_kinematics(robot, s, poses);
  Vector3 c = Vector3::Zero();
  for (std::size_t i = 0; i < poses.size(); ++i)
    c += robot.bodies[i].inertia.mass * (poses[i] * robot.bodies[i].inertia.p_BC);
  c = c / robot.total_mass() - s.p_WB;
  return {p.head<3>(), p.segment<3>(3) - c.cross(p.head<3>())};
}

struct Drift {
  double momentum = 0, angular_momentum = 0;  // relative
};

Drift drift_in_the_air(const Subject& subject, const scenes::RobotPtr& robot, double h) {
  WorldSpec spec = scenes::world_of(robot);
  spec.physics_dt = h;
  spec.gravity.setZero();
  const auto world = subject.make(spec);
  const scenes::Swing swing(*scenes::quadruped());
  RobotState start = world->home_state();
  start.p_WB.z() = 2;
  start.v_WB = {0.4, -0.3, 0.2};
  start.w_WB = {3, 6, 9};
  world->reset(start);
  const auto [p0, L0] = momenta(*robot, world->state());
  Drift result;
  for (long i = 0; i < std::lround(0.4 / h); ++i) {
    advance(*world, swing.targets(world->state().time));
    const auto [p, L] = momenta(*robot, world->state());
    result.momentum = std::max(result.momentum, (p - p0).norm() / p0.norm());
    result.angular_momentum = std::max(result.angular_momentum, (L - L0).norm() / L0.norm());
  }
  return result;
}

std::vector<double> robot_in_the_air(const Subject& subject) {
  const scenes::RobotPtr tree = scenes::without_loops(scenes::quadruped());
  const Drift coarse = drift_in_the_air(subject, tree, 1e-3), fine = drift_in_the_air(subject, tree, 5e-4);
  // A soft loop pulls at two points that are a gap apart: a couple, so that its angular momentum does not
  // converge.
  const scenes::RobotPtr loops = scenes::quadruped();
  const Drift coarse_loops = drift_in_the_air(subject, loops, 1e-3),
              fine_loops = drift_in_the_air(subject, loops, 5e-4);
  const double rounding = 500 * epsilon(subject.precision());  // of 800 steps of 21 bodies
  return {convergence(fine.momentum, coarse.momentum, 0.5, rounding),
          convergence(fine.angular_momentum, coarse.angular_momentum, 0.5, rounding), coarse.angular_momentum,
          convergence(fine_loops.momentum, coarse_loops.momentum, 0.5, rounding)};
}

std::vector<double> push(const Subject& subject) {
  WorldSpec spec = scenes::world_of(scenes::tumbling_body());
  spec.gravity.setZero();
  const auto body = subject.make(spec);
  RobotState start = body->home_state();
  start.p_WB.z() = 2;
  start.q_WB = from_roll_pitch_yaw(0.5, -0.4, 0.3);
  body->reset(start);
  const Vector3 impulse(0.3, -0.2, 0.1);
  body->apply_push(impulse / 2);
  body->apply_push(impulse / 2);  // pushes add up
  advance(*body, {}, 2);          // the second step is not pushed
  const SpatialInertia& inertia = body->robot().bodies[0].inertia;
  const RobotState& s = body->state();
  const Vector3 v = s.v_WB + s.w_WB.cross(s.q_WB * inertia.p_BC);
  const double velocity = (v - impulse / inertia.mass).norm(), turning = s.w_WB.norm();

  spec.robot = scenes::quadruped();
  const auto robot = subject.make(spec);
  start = robot->home_state();
  start.p_WB.z() = 2;
  robot->reset(start);
  robot->apply_push({0.05, -0.02, 0.03});
  advance(*robot, scenes::home_targets(*spec.robot));
  // After one step from rest the momentum is M(q0) v, to rounding.
  const Eigen::VectorXd p = mass_matrix(*spec.robot, start) * velocities(robot->state());

  body->apply_push({1, 0, 0});
  body->reset();
  advance(*body, {});
  return {velocity, turning, (p.head<3>() - Vector3(0.05, -0.02, 0.03)).norm(),
          std::abs(body->state().v_WB.x())};
}

std::vector<double> wrench(const Subject& subject) {
  WorldSpec spec = scenes::world_of(scenes::assortment());
  spec.gravity.setZero();
  const auto world = subject.make(spec);
  RobotState start = world->home_state();
  start.p_WB.z() = 2;
  start.q_WB = from_roll_pitch_yaw(0.5, -0.4, 0.3);
  start.q.setConstant(0.2);
  const JointTargets held{start.q};
  const BodyWrench pull{2, {{3, -2, 5}, {0.1, 0.2, -0.3}}, {0.02, -0.01, -0.1}};

  world->reset(start);
  world->apply_wrench(pull);
  advance(*world, held);
  // After one step from rest M(q0) v = h J^T (f, t), to rounding.
  std::vector<Pose> poses;
  forward_kinematics(*spec.robot, start, poses);
  Eigen::Matrix<double, 6, 1> of_body;
  of_body << pull.wrench.force, pull.wrench.torque;
  const Eigen::MatrixXd J = point_jacobian(*spec.robot, poses, pull.body, pull.p_BP);
  const Eigen::VectorXd expected = spec.physics_dt * (J.transpose() * of_body);
  // The state's velocity is of the base's origin where the step has turned it to; of what the base's centre
  // of mass has, that of the origin where it began is asked.
  RobotState after = world->state();
  const Vector3 p_BC = spec.robot->bodies[0].inertia.p_BC;
  after.v_WB += after.w_WB.cross(after.q_WB * p_BC - start.q_WB * p_BC);
  const Eigen::VectorXd made = mass_matrix(*spec.robot, start) * velocities(after);

  world->reset(start);  // which forgets it
  advance(*world, held);
  const double after_reset = velocities(world->state()).lpNorm<Eigen::Infinity>();
  world->reset(start);
  world->apply_wrench(pull);
  world->clear_wrenches();
  advance(*world, held);
  return {(made - expected).lpNorm<Eigen::Infinity>(), after_reset,
          velocities(world->state()).lpNorm<Eigen::Infinity>()};
}

}  // namespace

std::vector<Check> free_motion_checks() {
  return {
      {"free_fall",
       "Gravity and the integrator are semi-implicit Euler; the base moves as its centre of mass does",
       {rounds_to(16000, "off v = v0 + g t, p = p0 + v0 t + g t (t + h) / 2", "m, m/s",
                  "2000 additions to a number of size 30, each rounded by up to 8 eps"),
        rounds_to(16000, "behind the parabola, other than by |g| t h / 2", "m", "the same"),
        rounds_to(1000, "turning", "rad/s", "nothing turns it: rounding")},
       free_fall},
      {"robot_falls_as_one",
       "Gravity pulls at every body; servos and closed loops push nothing outwards",
       {with_rounding(at_most(1e-9, "height off", "m",
                              "loops are closed at home to 1e-9 m, and pull at that; 500 additions to 3 m"),
                      1000),
        with_rounding(at_most(1e-8, "velocity off", "m/s", "the same"), 1000),
        with_rounding(at_most(1e-6, "joints moved", "rad", "the same"), 1000)},
       robot_falls_as_one},
      {"tumbling",
       "Euler's equations of a free body: gyroscopic torque, frames of angular velocity and inertia",
       {at_most(0.5e-3 * 11.2 * 11.2, "angular momentum drifts, relative, h = 1 ms", "",
                "(h / 2) |w| T |w|, were all of w to turn"),
        between(0.48, 0.52, "the same at h / 2 over h", "", "first order; the next one is h |w| = 1 %"),
        between(0.48, 0.52, "the same at h / 4 over h / 2", "", "first order"),
        between(0.48, 0.52, "energy's drift at h / 4 over h / 2", "", "first order"),
        at_most(1.05, "energy's drift, either way, over that of explicit steps of the gyroscopic torque", "",
                "which is counted at the ends of steps; implicit ones lose what these gain"),
        rounds_to(2000, "velocity of the centre of mass off", "m/s", "rounding of some thousand steps"),
        rounds_to(2000, "centre of mass off its line", "m", "the same")},
       tumbling},
      {"robot_in_the_air",
       "A kicking robot keeps its momenta: dynamics of the tree, and what loops make of them",
       {between(0.45, 0.55, "momentum's drift at h / 2 over h", "",
                "a step conserves M(q) v; that q moves is first order in all"),
        between(0.45, 0.55, "angular momentum's drift at h / 2 over h", "", "the same"),
        at_most(0.5e-3 * 11.2 * 11.2, "angular momentum drifts, relative, h = 1 ms", "", "as `tumbling`"),
        between(0.45, 0.55, "with loops, momentum's drift at h / 2 over h", "", "loops only pull inside")},
       robot_in_the_air},
      {"push",
       "A push is an impulse at the base's centre of mass, spread over one step, then gone",
       {rounds_to(50, "body's velocity off impulse over mass", "m/s", "rounding"),
        rounds_to(50, "body turns", "rad/s", "rounding: no lever"),
        rounds_to(400, "robot's momentum off the impulse", "kg m/s", "rounding of 21 bodies"),
        rounds_to(4, "left of a push after a reset", "m/s", "1.4 if it were remembered")},
       push},
      {"wrench",
       "A wrench on a body moves the robot as its generalised forces do, until it is taken away",
       {rounds_to(400, "momenta of base and joints off h J^T (f, t)", "kg m/s, kg m^2/s",
                  "rounding of 5 bodies, of numbers up to 0.01"),
        rounds_to(4, "left of a wrench after a reset", "m/s, rad/s", "rounding: nothing else moves it"),
        rounds_to(4, "left of one that was taken away", "m/s, rad/s", "the same")},
       wrench},
  };
}

}  // namespace crossgait::conformance
