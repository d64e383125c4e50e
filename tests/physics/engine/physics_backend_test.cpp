// What every engine shares, around an engine that does as it is told and remembers what it was asked for.
#include "physics/engine/physics_backend.h"

#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "physics/robot/actuator.h"
#include "physics/robot/multibody.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/robot_files/scratch_robot.h"
#include "tests/support/constants.h"

namespace crossgait {
namespace {

using test::kInfinity;
using test::kNaN;

class Puppet : public PhysicsBackend {
 public:
  explicit Puppet(WorldSpec world, const std::string& name = "puppet", std::size_t remembered = 2)
      : PhysicsBackend(std::move(world)), memory(remembered, 0.0) {
    info_.name = name;
  }
  const EngineInfo& info() const override { return info_; }

  RobotState now;                         // what the engine would say
  std::function<void(RobotState&)> move;  // what a step does to it
  StepStatus answer = StepStatus::kOk;    // to every step
  ContactList touches;                    // after every step
  std::vector<double> memory;             // that the engine saves
  std::vector<JointVector> torques_seen;  // step by step
  std::vector<Vector3> pushes_seen;       // likewise
  std::vector<Vector3> turns_seen;        // torques on the base, likewise
  mutable std::vector<int> bodies_seen;

 private:
  void do_reset(const RobotState& state) override { now = state; }
  StepStatus do_step(const JointVector& tau, const Wrench& base) noexcept override {
    torques_seen.push_back(tau);
    pushes_seen.push_back(base.force);
    turns_seen.push_back(base.torque);
    if (move) move(now);
    return answer;
  }
  void do_read_state(RobotState& state) const noexcept override {
    state = now;
    state.time = -1;  // clocks are no engine's business
  }
  void do_read_contacts(ContactList& contacts) const noexcept override { contacts = touches; }
  double do_terrain_height(double x, double y) const override { return x + 2 * y; }
  Pose do_body_pose(int body) const override {
    bodies_seen.push_back(body);
    return Pose::Identity();
  }
  Eigen::MatrixXd do_mass_matrix() const override { return Eigen::MatrixXd::Identity(2, 2); }
  SpatialInertia do_body_inertia(int body) const override {
    bodies_seen.push_back(body);
    return {};
  }
  void do_save(std::vector<double>& engine) const override { engine = memory; }
  void do_restore(const std::vector<double>& engine) override { memory = engine; }

  EngineInfo info_;
};

// Two pendulums, the first with a servo.
RobotDescription servo_and_pendulum() {
  RobotDescription robot = pendulum_chain(2);
  Joint& servo = robot.bodies[1].joint;
  servo.actuated = true;
  servo.kp = 2;
  servo.kd = 0.5;
  servo.effort_limit = 3;
  servo.lower = -1;
  servo.upper = 1.5;
  servo.damping = 0.25;
  robot.bodies[2].joint.damping = 0.125;
  robot.home << 0.5, -0.25;
  robot.home_height = 0.375;
  return robot;
}

WorldSpec puppet_world(const RobotDescription& robot = servo_and_pendulum()) {
  WorldSpec world;
  world.robot = std::make_shared<const RobotDescription>(robot);
  world.physics_dt = 0.0625;  // a binary fraction: sums of it are exact
  return world;
}

RobotState turning() {
  RobotState state;
  state.q = state.qd = JointVector::Zero(2);
  state.q << 0.5, 0.25;
  state.qd << 0.5, -2;
  return state;
}

JointTargets target(double angle) { return {JointVector::Constant(1, angle)}; }

TEST(ServoTorque, IsSpringAndDamperWithinTheEffortLimit) {
  const Joint servo = servo_and_pendulum().joint(0);
  EXPECT_EQ(servo_torque(servo, 0.75, 0.5, 0), 0.5);
  EXPECT_EQ(servo_torque(servo, 0.75, 0.5, 0.25), 0.375);
  EXPECT_EQ(servo_torque(servo, 0, 0, -1), 0.5);
  EXPECT_EQ(servo_torque(servo, 10, 0, 0), 3);
  EXPECT_EQ(servo_torque(servo, -10, 0, 0), -3);
  EXPECT_EQ(servo_torque(servo, 10, 0, 36), 2);  // the damper is inside the limit
}

TEST(ServoTorque, FallsWithTheSpeedInItsDirection) {
  Joint servo = servo_and_pendulum().joint(0);  // effort 3
  servo.kd = 0;
  servo.corner_speed = 2;
  servo.no_load_speed = 6;
  EXPECT_EQ(servo_torque(servo, 10, 0, 2), 3);
  EXPECT_EQ(servo_torque(servo, 10, 0, 4), 1.5);
  EXPECT_EQ(servo_torque(servo, 10, 0, 6), 0);
  EXPECT_EQ(servo_torque(servo, 10, 0, 8), 0);
  EXPECT_EQ(servo_torque(servo, -10, 0, -5), -0.75);
  EXPECT_EQ(servo_torque(servo, -10, 0, 8), -3);      // it brakes with all that it has
  EXPECT_EQ(servo_torque(servo, 0.75, 0.5, 4), 0.5);  // and only the largest torque is less
}

TEST(ServoTorque, HasNoneWithinThePlay) {
  Joint servo = servo_and_pendulum().joint(0);  // kp 2, kd 0.5
  servo.backlash = 0.5;
  EXPECT_EQ(servo_torque(servo, 1.25, 1, 3), 0);
  EXPECT_EQ(servo_torque(servo, 0.75, 1, 3), 0);
  EXPECT_EQ(servo_torque(servo, 1.5, 1, 0), 0.5);
  EXPECT_EQ(servo_torque(servo, 0.5, 1, 0), -0.5);
  EXPECT_EQ(servo_torque(servo, 1.5, 1, 0.5), 0.25);
  EXPECT_EQ(servo_torque(servo, 1.5, 1, 4), 0);  // the damper would pull it back through the play
}

WorldSpec world_with(const std::function<void(Joint&)>& change) {
  RobotDescription robot = servo_and_pendulum();
  change(robot.bodies[1].joint);
  WorldSpec world = puppet_world();
  world.robot = std::make_shared<const RobotDescription>(std::move(robot));
  return world;
}

TEST(Drives, TargetsComeAfterTheirDelay) {
  // kp 2 at rest: a torque tells its target.
  Puppet world(world_with([](Joint& joint) { joint.delay = 3 * 0.0625; }));
  RobotState rest;
  rest.q = rest.qd = JointVector::Zero(2);
  for (int episode = 0; episode < 2; ++episode) {  // what is on its way does not outlive a reset
    world.torques_seen.clear();
    world.reset(rest);
    for (int i = 0; i < 3; ++i) ASSERT_EQ(world.step(target(0.125 * (i + 1)), 2), StepStatus::kOk);
    std::vector<double> torques;
    for (const JointVector& tau : world.torques_seen) torques.push_back(tau[0] / 2);
    EXPECT_EQ(torques, (std::vector<double>{0.125, 0.125, 0.125, 0.125, 0.125, 0.25}));
  }
}

TEST(Drives, ASnapshotKeepsWhatIsOnItsWay) {
  const WorldSpec spec = world_with([](Joint& joint) {
    joint.delay = 3 * 0.0625;
    joint.sensor_noise = 0.01;
  });
  Puppet world(spec), other(spec);
  RobotState rest;
  rest.q = rest.qd = JointVector::Zero(2);
  world.reset(rest);
  for (int i = 0; i < 5; ++i) ASSERT_EQ(world.step(target(0.125 * i)), StepStatus::kOk);
  const Snapshot saved = world.save();
  const auto go_on = [](Puppet& w) {
    w.torques_seen.clear();
    for (int i = 0; i < 5; ++i) EXPECT_EQ(w.step(target(-0.125 * i)), StepStatus::kOk);
    return w.torques_seen;
  };
  const auto first = go_on(world);
  other.reset(rest);  // a puppet's engine has no state that a snapshot could bring
  other.restore(saved);
  EXPECT_EQ(go_on(other), first);
  world.restore(saved);
  EXPECT_EQ(go_on(world), first);
  Puppet without(world_with([](Joint&) {}));
  EXPECT_THROW(without.restore(saved), ConfigError);
}

TEST(Drives, RefuseNumbersThatNoneSaved) {
  Puppet world(world_with([](Joint& joint) { joint.delay = 3 * 0.0625; }));
  RobotState rest;
  rest.q = rest.qd = JointVector::Zero(2);
  world.reset(rest);
  ASSERT_EQ(world.step(target(0.5)), StepStatus::kOk);
  const Snapshot saved = world.save();
  for (const double number : {-1.0, 1e18, std::numeric_limits<double>::quiet_NaN()}) {
    Snapshot tampered = saved;
    tampered.drives.front() = number;  // steps that were counted
    EXPECT_EQ(config_error([&] { world.restore(tampered); }).element(), "robot") << number;
  }
  Snapshot longer = saved;
  longer.drives.push_back(0);
  EXPECT_EQ(config_error([&] { world.restore(longer); }).element(), "robot");
  world.restore(saved);
}

TEST(Drives, MeasureWithUniformErrors) {
  Puppet world(world_with([](Joint& joint) { joint.sensor_noise = 0.25; }));
  RobotState rest;
  rest.q = rest.qd = JointVector::Zero(2);
  world.reset(rest);
  ASSERT_EQ(world.step(target(0), 4000), StepStatus::kOk);
  double sum = 0, squares = 0, least = 0, most = 0;
  for (const JointVector& tau : world.torques_seen) {
    const double n = -tau[0] / 2;  // kp 2
    sum += n;
    squares += n * n;
    least = std::min(least, n);
    most = std::max(most, n);
  }
  EXPECT_GT(least, -0.25);
  EXPECT_LT(least, -0.24);
  EXPECT_LT(most, 0.25);
  EXPECT_GT(most, 0.24);
  // Of 4000: within four standard errors of 0, and within 10 % of the variance of the uniform law.
  EXPECT_LT(std::abs(sum / 4000), 4 * 0.25 / std::sqrt(3 * 4000.0));
  EXPECT_NEAR(squares / 4000, 0.25 * 0.25 / 3, 0.1 * 0.25 * 0.25 / 3);
}

TEST(Drives, RefuseDelaysOfPartsOfAStep) {
  const auto message = [](double delay) {
    return std::string(
        config_error([&] { Puppet(world_with([delay](Joint& joint) { joint.delay = delay; })); }).what());
  };
  EXPECT_NE(
      message(0.1).find("expected a whole number of physics steps of 0.0625 s, at most 1000, found 0.1 s"),
      std::string::npos)
      << message(0.1);
  EXPECT_NE(message(-1).find("delay (s) >= 0"), std::string::npos) << message(-1);
  EXPECT_NE(message(0.01).find("found 0.01 s"), std::string::npos);
}

TEST(SharedStep, AppliesServosAndDampingAnewInEveryPhysicsStep) {
  Puppet world(puppet_world());
  world.reset(turning());
  EXPECT_EQ(world.torques(), JointVector(JointVector::Zero(2)));
  world.move = [](RobotState& s) { s.qd[0] = 0; };
  ASSERT_EQ(world.step(target(1), 2), StepStatus::kOk);
  ASSERT_EQ(world.torques_seen.size(), 2U);
  EXPECT_EQ(Eigen::Vector2d(world.torques_seen[0]),
            Eigen::Vector2d(2 * 0.5 - 0.5 * 0.5 - 0.25 * 0.5, 0.125 * 2));
  EXPECT_EQ(Eigen::Vector2d(world.torques_seen[1]), Eigen::Vector2d(2 * 0.5, 0.125 * 2));
  EXPECT_EQ(world.torques(), world.torques_seen[1]);
}

TEST(SharedStep, KeepsTargetsWithinTheJointsLimits) {
  Puppet world(puppet_world());
  world.reset(turning());
  world.move = [](RobotState& s) { s.qd.setZero(); };
  ASSERT_EQ(world.step(target(0)), StepStatus::kOk);
  ASSERT_EQ(world.step(target(1.75)), StepStatus::kOk);
  ASSERT_EQ(world.step(target(-1.75)), StepStatus::kOk);
  EXPECT_EQ(world.torques_seen[1][0], 2 * (1.5 - 0.5));
  EXPECT_EQ(world.torques_seen[2][0], 2 * (-1 - 0.5));
}

TEST(SharedStep, CountsTheTimeFromWhereItWasReset) {
  Puppet world(puppet_world());
  RobotState state = turning();
  state.time = 5;
  world.reset(state);
  EXPECT_EQ(world.state().time, 5);
  ASSERT_EQ(world.step(target(0), 3), StepStatus::kOk);
  EXPECT_EQ(world.state().time, 5 + 3 * 0.0625);
  EXPECT_EQ(world.torques_seen.size(), 3U);
  ASSERT_EQ(world.step(target(0), 0), StepStatus::kOk);
  EXPECT_EQ(world.torques_seen.size(), 3U);
  world.reset();
  EXPECT_EQ(world.state().time, 0);
}

TEST(SharedStep, DoesNothingForTargetsThatAreNone) {
  Puppet world(puppet_world());
  world.reset(turning());
  const JointTargets bad[] = {{}, {JointVector::Zero(2)}, target(kNaN), target(kInfinity)};
  for (const JointTargets& targets : bad) EXPECT_EQ(world.step(targets), StepStatus::kInvalidTargets);
  EXPECT_TRUE(world.torques_seen.empty());
  EXPECT_EQ(world.state().time, 0);
  EXPECT_EQ(world.step(target(0)), StepStatus::kOk);
}

TEST(SharedStep, ShowsTheContactsOfTheLastPhysicsStep) {
  Puppet world(puppet_world());
  world.reset(turning());
  world.touches.add({.body = 2});
  EXPECT_EQ(world.contacts().count, 0);
  ASSERT_EQ(world.step(target(0), 2), StepStatus::kOk);
  ASSERT_EQ(world.contacts().count, 1);
  EXPECT_EQ(world.contacts().points[0].body, 2);
  world.reset();
  EXPECT_EQ(world.contacts().count, 0);
  EXPECT_EQ(world.torques(), JointVector(JointVector::Zero(2)));
}

// What a state can be that no robot is in.
struct Runaway {
  const char* name;
  std::function<void(RobotState&, double)> set;
  double limit;
};

const Runaway kRunaways[] = {
    {"position x", [](RobotState& s, double x) { s.p_WB.x() = x; }, 1e6},
    {"position z", [](RobotState& s, double x) { s.p_WB.z() = x; }, 1e6},
    {"velocity y", [](RobotState& s, double x) { s.v_WB.y() = x; }, 340},
    {"angular velocity", [](RobotState& s, double x) { s.w_WB.z() = x; }, 1e4},
    {"joint velocity", [](RobotState& s, double x) { s.qd[1] = x; }, 1e4},
};

TEST(SharedDivergence, IsAStateNoRobotIsIn) {
  for (const Runaway& r : kRunaways) {
    for (const double value : {r.limit, -r.limit, 2 * r.limit, kNaN, kInfinity}) {
      Puppet world(puppet_world());
      world.reset(turning());
      world.move = [&](RobotState& s) { r.set(s, value); };
      EXPECT_EQ(world.step(target(0)), StepStatus::kDiverged) << r.name << " " << value;
      RobotState bad = turning();
      r.set(bad, value);
      EXPECT_EQ(config_error([&] { world.reset(bad); }).element(), "state") << r.name << " " << value;
    }
    Puppet world(puppet_world());
    world.reset(turning());
    world.move = [&](RobotState& s) { r.set(s, 0.999 * r.limit); };
    EXPECT_EQ(world.step(target(0)), StepStatus::kOk) << r.name;
    EXPECT_NO_THROW(world.reset(world.state())) << r.name;
  }
}

TEST(SharedDivergence, KeepsTheLastGoodStateUntilAReset) {
  Puppet world(puppet_world());
  world.reset(turning());
  world.move = [](RobotState& s) { s.p_WB.x() += 1; };
  ASSERT_EQ(world.step(target(0), 2), StepStatus::kOk);
  world.answer = StepStatus::kDiverged;  // the engine itself notices
  EXPECT_EQ(world.step(target(0), 5), StepStatus::kDiverged);
  EXPECT_EQ(world.torques_seen.size(), 3U);
  EXPECT_EQ(world.state().p_WB.x(), 2);
  EXPECT_EQ(world.state().time, 2 * 0.0625);
  world.answer = StepStatus::kOk;
  EXPECT_EQ(world.step(target(0)), StepStatus::kDiverged);
  EXPECT_EQ(world.torques_seen.size(), 3U);
  world.reset();
  EXPECT_EQ(world.step(target(0)), StepStatus::kOk);
}

TEST(SharedReset, RefusesStatesOfOtherRobotsAndOfNone) {
  Puppet world(puppet_world());
  const auto refusal = [&world](const std::function<void(RobotState&)>& change) {
    RobotState state = turning();
    change(state);
    return config_error([&] { world.reset(state); }).element();
  };
  EXPECT_EQ(refusal([](RobotState& s) { s.q = JointVector::Zero(1); }), "joint vectors");
  EXPECT_EQ(refusal([](RobotState& s) { s.qd = JointVector::Zero(3); }), "joint vectors");
  EXPECT_EQ(refusal([](RobotState& s) { s.time = kNaN; }), "state");
  EXPECT_EQ(refusal([](RobotState& s) { s.q[1] = kInfinity; }), "state");
  EXPECT_EQ(refusal([](RobotState& s) { s.q_WB.x() = kNaN; }), "state");
  for (const double norm : {1 + 2e-6, 1 - 2e-6, 2.0, 0.0})
    EXPECT_EQ(refusal([norm](RobotState& s) { s.q_WB = Quaternion(0, norm, 0, 0); }), "q_WB") << norm;
  RobotState nearly = turning();
  nearly.q_WB = Quaternion(0, 1 + 5e-7, 0, 0);
  EXPECT_NO_THROW(world.reset(nearly));
}

TEST(SharedReset, HomeIsAtRestOverTheHighestGroundWithinReach) {
  const double clearance = 1e-4, height = 0.375, spike = 0.0625;
  Puppet flat(puppet_world());
  flat.reset();
  EXPECT_EQ(flat.state().q, servo_and_pendulum().home);
  EXPECT_EQ(flat.state().qd, JointVector(JointVector::Zero(2)));
  EXPECT_EQ(flat.state().p_WB, Vector3(0, 0, height + clearance));
  EXPECT_EQ(flat.state().v_WB, Vector3(0, 0, 0));
  // Samples every 3 cm, one of them a spike: four in each direction are within reach.
  const auto home_over = [&](int column, int row) {
    std::vector<float> heights(17 * 17, 0);
    heights[static_cast<std::size_t>((8 + row) * 17 + 8 + column)] = static_cast<float>(spike);
    WorldSpec world = puppet_world();
    world.terrain = Terrain("spike", std::make_shared<const HeightField>(17, 17, 0.48, 0.48, heights));
    return Puppet(world).home_state().p_WB.z();
  };
  using Places = std::vector<std::pair<int, int>>;
  for (const auto& [column, row] : Places{{0, 0}, {4, 4}, {-4, 4}, {4, -4}, {-4, -4}, {3, 0}, {0, -1}})
    EXPECT_NEAR(home_over(column, row), spike + height + clearance, 1e-12) << column << " " << row;
  for (const auto& [column, row] : Places{{5, 0}, {-5, 0}, {0, 5}, {0, -5}})
    EXPECT_NEAR(home_over(column, row), height + clearance, 1e-12) << column << " " << row;
}

TEST(SharedPush, IsSpreadOverTheNextPhysicsStep) {
  Puppet world(puppet_world());
  world.reset(turning());
  world.apply_push({1, 0, 0});
  world.apply_push({0, 0.5, -2});
  ASSERT_EQ(world.step(target(0), 2), StepStatus::kOk);
  EXPECT_EQ(world.pushes_seen, (std::vector<Vector3>{{16, 8, -32}, {0, 0, 0}}));
  world.apply_push({1, 0, 0});
  world.reset();
  ASSERT_EQ(world.step(target(0)), StepStatus::kOk);
  EXPECT_EQ(world.pushes_seen.back(), Vector3(0, 0, 0));
  EXPECT_EQ(config_error([&] { world.apply_push({0, kNaN, 0}); }).element(), "impulse");
}

TEST(SharedWrench, HasThePowerOfItsGeneralisedForces) {
  Puppet world(puppet_world());
  RobotState state = turning();
  state.q << 0.7, -0.4;
  state.qd << 1.5, -2;
  world.reset(state);
  const BodyWrench pull{2, {{3, -2, 5}, {0.1, 0.2, -0.3}}, {0.02, -0.01, -0.1}};
  world.apply_wrench(pull);
  ASSERT_EQ(world.step(target(0), 2), StepStatus::kOk);
  world.clear_wrenches();
  ASSERT_EQ(world.step(target(0)), StepStatus::kOk);
  // The puppet does not move: what is different between the steps is the wrench.
  const JointVector tau = world.torques_seen[0] - world.torques_seen[2];
  EXPECT_EQ(world.torques_seen[1], world.torques_seen[0]);
  EXPECT_EQ(world.torques(), world.torques_seen[2]);  // of servos and damping alone
  std::vector<Pose> poses;
  std::vector<BodyVelocity> velocities;
  forward_kinematics(world.robot(), state, poses);
  forward_velocities(world.robot(), state, poses, velocities);
  const auto velocity = [&](std::size_t body, const Vector3& p_BP) {
    return Vector3(velocities[body].v + velocities[body].w.cross(poses[body].linear() * p_BP));
  };
  const double of_body =
      pull.wrench.force.dot(velocity(2, pull.p_BP)) + pull.wrench.torque.dot(velocities[2].w);
  const double of_robot = world.pushes_seen[0].dot(velocity(0, world.robot().bodies[0].inertia.p_BC)) +
                          world.turns_seen[0].dot(velocities[0].w) + tau.dot(state.qd);
  EXPECT_NEAR(of_robot, of_body, 1e-13);  // rounding of sums of some 10 W
  EXPECT_GT(tau.norm(), 0.1);
  EXPECT_EQ(world.turns_seen[2], Vector3(0, 0, 0));
}

TEST(SharedWrench, IsOfABodyFiniteAndOneOfSoMany) {
  Puppet world(puppet_world());
  world.reset(turning());
  EXPECT_EQ(config_error([&] { world.apply_wrench({3, {}}); }).element(), "body");
  EXPECT_EQ(config_error([&] { world.apply_wrench({0, {{kNaN, 0, 0}}}); }).element(), "wrench");
  for (std::size_t i = 0; i < kMaxWrenches; ++i) world.apply_wrench({0, {{1, 0, 0}}});
  EXPECT_EQ(config_error([&] { world.apply_wrench({0, {{1, 0, 0}}}); }).element(), "wrenches");
  const Snapshot saved = world.save();
  world.reset();
  ASSERT_EQ(world.step(target(0)), StepStatus::kOk);
  EXPECT_EQ(world.pushes_seen.back(), Vector3(0, 0, 0));
  world.restore(saved);
  ASSERT_EQ(world.step(target(0)), StepStatus::kOk);
  EXPECT_EQ(world.pushes_seen.back(), Vector3(64, 0, 0));
}

Contact touch_of(int leg, double distance, const Vector3& force, double slip = 0) {
  Contact c;
  c.leg = leg;
  c.distance = distance;
  c.force = force;
  c.p_WP = {distance, 0, 0};
  c.slip_speed = slip;
  return c;
}

TEST(FootContacts, AddUpForcesAndTakeTheDeepestPoint) {
  Puppet world(puppet_world());
  world.reset(turning());
  world.touches.add(touch_of(-1, -1, {0, 0, 100}));  // no foot
  world.touches.add(touch_of(0, -0.25, {1, 0, 4}, 0.1));
  world.touches.add(touch_of(0, -0.5, {0, 2, 8}, 0.2));
  world.touches.add(touch_of(0, -0.375, {0, 0, 16}, 0.3));
  world.touches.add(touch_of(0, -0.75, {0, 4, 0}, 0.4));    // grazes: a force, but none that carries
  world.touches.add(touch_of(1, 0.125, {0, 0, 2}, 0.5));    // carries before it touches
  world.touches.add(touch_of(2, -0.125, {0, 0, -1}, 0.6));  // sticks
  ASSERT_EQ(world.step(target(0)), StepStatus::kOk);
  const LegArray<FootContact> feet = world.foot_contacts();
  EXPECT_TRUE(feet[Leg::FL].touching);
  EXPECT_EQ(feet[Leg::FL].force, Vector3(1, 6, 28));
  EXPECT_EQ(feet[Leg::FL].penetration, 0.5);
  EXPECT_EQ(feet[Leg::FL].p_WP, Vector3(-0.5, 0, 0));
  EXPECT_EQ(feet[Leg::FL].slip_speed, 0.2);
  EXPECT_TRUE(feet[Leg::FR].touching);
  EXPECT_EQ(feet[Leg::FR].penetration, 0);
  EXPECT_EQ(feet[Leg::FR].slip_speed, 0.5);
  EXPECT_FALSE(feet[Leg::RL].touching);
  EXPECT_EQ(feet[Leg::RL].force, Vector3(0, 0, -1));
  EXPECT_EQ(feet[Leg::RL].penetration, 0);
  EXPECT_FALSE(feet[Leg::RR].touching);
  EXPECT_EQ(feet[Leg::RR].force, Vector3(0, 0, 0));
}

TEST(SharedQuestions, AreOfBodiesThatThereAre) {
  const Puppet world(puppet_world());
  for (const int body : {-1, 3}) {
    EXPECT_EQ(config_error([&] { static_cast<void>(world.body_pose(body)); }).found(), std::to_string(body));
    EXPECT_EQ(config_error([&] { static_cast<void>(world.body_inertia(body)); }).found(),
              std::to_string(body));
  }
  EXPECT_TRUE(world.bodies_seen.empty());
  for (const int body : {0, 2}) {
    static_cast<void>(world.body_pose(body));
    static_cast<void>(world.body_inertia(body));
  }
  EXPECT_EQ(world.bodies_seen, (std::vector<int>{0, 0, 2, 2}));
  EXPECT_EQ(world.terrain_height(1, 2), 5);
}

TEST(SharedSnapshots, HoldAllThatAnInstantIs) {
  Puppet world(puppet_world());
  world.reset(turning());
  world.touches.add({.body = 1});
  world.move = [](RobotState& s) { s.p_WB.x() += 1; };
  ASSERT_EQ(world.step(target(0)), StepStatus::kOk);
  world.apply_push({1, 2, 3});
  world.memory = {7, 8};
  const Snapshot saved = world.save();
  world.touches.clear();
  world.answer = StepStatus::kDiverged;
  ASSERT_EQ(world.step(target(1)), StepStatus::kDiverged);
  const Snapshot diverged = world.save();
  world.memory.clear();
  world.memory = {0, 0};

  world.restore(saved);
  world.answer = StepStatus::kOk;
  EXPECT_EQ(world.memory, (std::vector<double>{7, 8}));
  EXPECT_EQ(world.state().p_WB.x(), 1);
  EXPECT_EQ(world.contacts().count, 1);
  EXPECT_EQ(world.torques(), saved.torques);
  EXPECT_EQ(world.torques(), world.torques_seen[0]);
  ASSERT_EQ(world.step(target(1)), StepStatus::kOk);
  EXPECT_EQ(world.pushes_seen.back(), Vector3(16, 32, 48));

  world.restore(diverged);
  EXPECT_EQ(world.step(target(1)), StepStatus::kDiverged);
}

TEST(SharedSnapshots, OfOthersAreRefused) {
  Puppet world(puppet_world()), other(puppet_world(), "marionette"), larger(puppet_world(), "puppet", 3),
      longer(puppet_world(pendulum_chain(3)));
  for (Puppet* p : {&world, &other, &larger, &longer}) p->reset();
  EXPECT_EQ(config_error([&] { world.restore(other.save()); }).found(), "marionette");
  EXPECT_EQ(config_error([&] { world.restore(larger.save()); }).element(), "robot");
  EXPECT_EQ(config_error([&] { world.restore(longer.save()); }).found(), "3 joints");
}

TEST(SharedWorlds, AreValidated) {
  WorldSpec bad = puppet_world();
  bad.physics_dt = -1;
  EXPECT_EQ(config_error([&] { Puppet world(bad); }).element(), "physics_dt");
}

}  // namespace
}  // namespace crossgait
