// What published policies' interfaces have beside plain joint targets: joints seen in an order of their own,
// several kinds of commands, starts elsewhere than standing.
#include <algorithm>
#include <cmath>

#include "env/quadruped_env.h"
#include "motion/standing.h"
#include "tests/physics/core/config_error.h"
#include "tests/support/engine_test.h"
#include "tests/support/environments.h"

namespace crossgait {
namespace {

EnvConfig interface_of(const std::string& robot) {
  EnvConfig config = joint_environment();
  config.robot = robot;
  return config;
}

std::string complaint_of(const EnvConfig& config) {
  return config_error([&] { static_cast<void>(EnvModel::make(config)); }).what();
}

int joint_of(const RobotDescription& robot, const std::string& name) {
  int joint = 0;
  while (robot.joint(joint).name != name) ++joint;
  return joint;
}

class ObservedJoints : public EngineTest {};
CROSSGAIT_FOR_EVERY_BACKEND(ObservedJoints);

TEST_P(ObservedJoints, HaveAnOrderOfTheirOwnAndNeedNoServos) {
  // A five-bar's elbows have none; at home they are where its servos' home has them.
  EnvConfig config = interface_of("scara_quadruped");
  config.joints.home.by_name = {{"FL_shoulder_left", EnvModel::make(config)->joints.home[1] + 0.1}};
  const auto model = EnvModel::make(config);
  const RobotDescription& robot = *model->robot;
  for (int i = robot.joint_count() - 1; i >= 0; --i) config.joints.observed.push_back(robot.joint(i).name);
  config.observation = {"joint_positions", "joint_velocities", "joint_offsets", "last_action"};
  QuadrupedEnv env(config, find_engine(GetParam()));
  const auto joints = static_cast<std::size_t>(robot.joint_count());
  ASSERT_EQ(env.observation_size(), 3 * joints + 12);
  std::vector<double> seen(env.observation_size());
  env.reset(0, seen);
  Random random(1);
  const std::vector<double> action = scenes::random_action(random, 12);
  env.step(action, seen);
  const RobotState home = JointControl(env.model()).initial_state(make_terrain("flat"), {});
  const RobotState& state = env.world().state();
  for (std::size_t k = 0; k < joints; ++k) {
    const int joint = joint_of(robot, config.joints.observed[k]);
    EXPECT_EQ(seen[k], state.q[joint]);
    EXPECT_EQ(seen[joints + k], state.qd[joint]);
    EXPECT_EQ(seen[2 * joints + k], state.q[joint] - home.q[joint]);
    EXPECT_EQ(env.observation_layout().entries[k].name, "q." + robot.joint(joint).name);
  }
  for (std::size_t k = 0; k < 12; ++k) EXPECT_EQ(seen[3 * joints + k], action[k]);
}

class JointCommands : public EngineTest {};
CROSSGAIT_FOR_EVERY_BACKEND(JointCommands);

TEST_P(JointCommands, AreOfSeveralKinds) {
  // What the servos' law makes of the targets is worked out here from the state before each step.
  EnvConfig config = interface_of("serial_quadruped");
  config.joints.commands = {{"FL_knee", JointCommand::kVelocity}, {"RR_knee", JointCommand::kTorque}};
  config.joints.scale = {0.1, {{"FL_knee", 8}, {"RR_knee", 2}}};
  config.joints.upper.by_name = {{"FL_knee", 3}};
  config.control_dt = config.policy_dt = config.physics_dt;
  config.joints.delay = 2 * config.physics_dt;
  QuadrupedEnv env(config, find_engine(GetParam()));
  std::vector<double> seen(env.observation_size());
  for (int episode = 0; episode < 2; ++episode) {
    env.reset(0, seen);
    for (int i = 0; i < 6; ++i) {
      const RobotState before = env.world().state();
      env.step(std::vector<double>(12, 0.1 * (i + 1)), seen);
      const double action = i < 2 ? 0 : 0.1 * (i - 1);
      for (std::size_t k = 0; k < 12; ++k) {
        const int servo = env.model().joints.servos[k];
        const Joint& joint = env.world().robot().joint(servo);
        const double target = env.targets().joints.q[env.model().joints.slots[k]], qd = before.qd[servo];
        const double torque = joint.kp * (target - before.q[servo]) - joint.kd * qd;
        // kp amplifies the rounding of angles.
        const double rounding = 1e-12 * std::max(1.0, joint.kp);
        if (joint.name == "FL_knee") {
          EXPECT_NEAR(torque, joint.kd * (std::min(8 * action, 3.0) - qd), rounding) << i;
        } else if (joint.name == "RR_knee") {
          EXPECT_NEAR(torque, 2 * action, rounding) << i;
        } else {
          EXPECT_EQ(target, env.model().joints.home[k] + 0.1 * action) << joint.name << i;
        }
      }
    }
  }
}

TEST(JointInterface, IsWrittenAndReadBack) {
  EnvConfig config = interface_of("serial_quadruped");
  config.joints.commands = {{"FL_knee", JointCommand::kVelocity}};
  config.joints.observed = {"RR_knee", "FL_knee"};
  config.control_dt = config.physics_dt;
  config.settle_seconds = 0;
  config.start = {.height = 0.5,
                  .velocity = {0.1, 0, 0},
                  .angular_velocity = {0, 0, 0.3},
                  .joint_offsets = {0.1, {{"FL_knee", -0.1}}},
                  .joint_velocities = {1, {}}};
  const EnvConfig again = parse_env_config(to_yaml(config), "again");
  EXPECT_EQ(again.joints, config.joints);
  EXPECT_EQ(again.start, config.start);
  EXPECT_EQ(to_yaml(again), to_yaml(config));
}

class Starts : public EngineTest {};
CROSSGAIT_FOR_EVERY_BACKEND(Starts);

TEST_P(Starts, AreWhereTheSettingsSay) {
  EnvConfig config = interface_of("scara_quadruped");
  config.settle_seconds = 0;
  config.terminations = OutcomeSet::of_names({});
  config.randomisation[Randomised::kStartYaw] = {0.5, 0.5};
  config.start = {.height = 0.6,
                  .velocity = {0.3, 0.1, -0.2},
                  .angular_velocity = {0, 0.4, 0},
                  .joint_offsets = {0, {{"FL_shoulder_left", 0.1}}},
                  .joint_velocities = {0, {{"FL_shoulder_left", 0.5}}}};
  QuadrupedEnv env(config, find_engine(GetParam()));
  std::vector<double> seen(env.observation_size());
  env.reset(0, seen);
  const RobotState& state = env.world().state();
  const RobotDescription& robot = env.world().robot();
  const int moved = joint_of(robot, "FL_shoulder_left");
  // A rotation's rounding in double precision; some engines keep the state in their own form and precision,
  // of which some ten operations are made on the way.
  const double rounding = 1e-12 + 10 * epsilon(env.world().info().capabilities.precision);
  EXPECT_NEAR(state.p_WB.z(), 0.6, rounding);
  EXPECT_NEAR(state.v_WB.x(), 0.3 * std::cos(0.5) - 0.1 * std::sin(0.5), rounding);
  EXPECT_NEAR(state.v_WB.y(), 0.3 * std::sin(0.5) + 0.1 * std::cos(0.5), rounding);
  EXPECT_NEAR(state.v_WB.z(), -0.2, rounding);
  EXPECT_NEAR(state.w_WB.x(), -0.4 * std::sin(0.5), rounding);
  EXPECT_NEAR(state.w_WB.y(), 0.4 * std::cos(0.5), rounding);
  EXPECT_NEAR(state.q[moved], robot.home[moved] + 0.1, rounding);
  EXPECT_NEAR(state.qd[moved], 0.5, rounding);
  // The elbows follow: in a millisecond their chains are as closed as at first.
  RobotState later = state;
  later.q += 1e-3 * state.qd;
  const JointVector closed = with_legs_closed(robot, later.q, "test");
  EXPECT_LT((closed - later.q).cwiseAbs().maxCoeff(), 1e-5);  // the square of 0.5 mrad, some times
  EXPECT_GT((state.qd.array() != 0).count(), 1);
  for (const Leg leg : kLegs) EXPECT_FALSE(env.info().contacts[leg].touching);
}

TEST_P(Starts, FallFreelyUntilTheFeetTouch) {
  // With its joints held at home the whole robot falls like a stone: sqrt(2 h / g).
  EnvConfig config = interface_of("serial_quadruped");
  config.settle_seconds = 0;
  config.policy_dt = config.control_dt = config.physics_dt;
  config.terminations = OutcomeSet::of_names({});
  config.randomisation[Randomised::kStartLift] = {0.1, 0.1};
  QuadrupedEnv env(config, find_engine(GetParam()));
  std::vector<double> seen(env.observation_size());
  env.reset(0, seen);
  const auto touching = [&env] {
    return std::any_of(kLegs.begin(), kLegs.end(),
                       [&](Leg leg) { return env.info().contacts[leg].touching; });
  };
  double time = 0;
  while (!touching() && time < 1) {
    env.step(std::vector<double>(12, 0), seen);
    time += config.physics_dt;
  }
  // 0.1 mm of clearance takes 0.07 ms more; contact shows in the step after it began, and is seen by steps.
  EXPECT_NEAR(time, std::sqrt(2 * 0.1 / 9.81), 3 * config.physics_dt);
}

TEST(Starts, AreDrawnWithinTheirRangesEachServoItsOwn) {
  EnvConfig config = interface_of("serial_quadruped");
  config.settle_seconds = 0;
  config.randomisation[Randomised::kStartJointOffset] = {-0.1, 0.1};
  config.randomisation[Randomised::kStartJointVelocity] = {-1, 1};
  config.randomisation[Randomised::kStartVx] = {0.2, 0.4};
  QuadrupedEnv env(config, find_engine(available_engines().front()));
  std::vector<double> seen(env.observation_size());
  std::vector<RobotState> states;
  for (const std::uint64_t seed : {1U, 2U, 1U}) {
    env.reset(seed, seen);
    const RobotState& state = env.world().state();
    const JointVector moved = state.q - env.world().robot().home;
    EXPECT_LE(moved.cwiseAbs().maxCoeff(), 0.1);
    EXPECT_GT((moved.array() - moved.mean()).abs().maxCoeff(), 0.02);  // no one number for all
    EXPECT_GT((state.qd.array() - state.qd.mean()).abs().maxCoeff(), 0.2);
    EXPECT_GE(state.v_WB.x(), 0.2 - 1e-12);
    EXPECT_LE(state.v_WB.x(), 0.4 + 1e-12);
    states.push_back(state);
  }
  EXPECT_TRUE(scenes::identical(states[0], states[2]));
  EXPECT_FALSE(scenes::identical(states[0], states[1]));
}

TEST(JointInterface, NamesWhatIsWrong) {
  const auto complaint = [](const std::function<void(EnvConfig&)>& change) {
    EnvConfig config = interface_of("serial_quadruped");
    change(config);
    return complaint_of(config);
  };
  EXPECT_NE(complaint([](EnvConfig& c) {
              c.joints.observed = {"FL_knee", "FL_knee"};
            }).find("joints.observed: expected joints of the robot, each once, found 'FL_knee' twice"),
            std::string::npos);
  EXPECT_NE(complaint([](EnvConfig& c) {
              c.joints.commands = {{"FL_nose", JointCommand::kTorque}};
              c.control_dt = c.physics_dt;
            }).find("joints.command: expected servos of the robot"),
            std::string::npos);
  EXPECT_NE(complaint([](EnvConfig& c) {
              c.joints.command = JointCommand::kVelocity;
              c.control_dt = c.physics_dt;
              c.servos["kd"].all = 0;
            }).find("servos.kd of FL_abduction: expected a damping above 0"),
            std::string::npos);
  EXPECT_NE(complaint([](EnvConfig& c) { c.start.height = 0.5; }).find("settle_seconds: expected 0 s where"),
            std::string::npos);
  const auto at_reset = [](const std::function<void(EnvConfig&)>& change) {
    EnvConfig config = interface_of("serial_quadruped");
    config.settle_seconds = 0;
    change(config);
    QuadrupedEnv env(config, find_engine(available_engines().front()));
    std::vector<double> seen(env.observation_size());
    return std::string(config_error([&] { env.reset(0, seen); }).what());
  };
  EXPECT_NE(at_reset([](EnvConfig& c) { c.start.height = 0.05; }).find("start: height: expected at least "),
            std::string::npos);
  EXPECT_NE(at_reset([](EnvConfig& c) {
              c.start.joint_offsets.all = 6;
            }).find("joint_offsets of FL_abduction: expected an angle within its limits"),
            std::string::npos);
  EXPECT_NE(at_reset([](EnvConfig& c) {
              c.start.joint_offsets.by_name = {{"nose", 0}};
            }).find("start: joint_offsets: expected servos of the robot, found 'nose'"),
            std::string::npos);
  EnvConfig elbows = interface_of("scara_quadruped");
  elbows.joints.observed = {"FL_elbow_left"};
  elbows.observation = {"joint_targets"};
  EXPECT_NE(complaint_of(elbows).find("joints.observed of servos alone, beside joint_targets"),
            std::string::npos);
}

}  // namespace
}  // namespace crossgait
