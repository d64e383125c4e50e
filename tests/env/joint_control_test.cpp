// Environments whose actions command joints.
#include "env/joint_control.h"

#include <algorithm>
#include <cmath>

#include "env/quadruped_env.h"
#include "policy/mlp_policy.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"
#include "tests/policy/policy_interfaces.h"
#include "tests/support/engine_test.h"
#include "tests/support/environments.h"

namespace crossgait {
namespace {

EnvConfig joints_of(const std::string& robot) {
  EnvConfig config = joint_environment();
  config.robot = robot;
  return config;
}

/// Twelve servos in an order of its own, another home and other scales: what a network from elsewhere needs.
EnvConfig foreign() {
  EnvConfig config = joints_of("serial_quadruped");
  for (const char* leg : {"RR", "RL", "FR", "FL"}) {
    for (const char* joint : {"knee", "hip_pitch", "abduction"})
      config.joints.order.push_back(std::string(leg) + "_" + joint);
  }
  config.joints.home.by_name = {{"FL_hip_pitch", 0.7}, {"RR_knee", -1.4}};
  config.joints.scale.by_name = {{"FL_hip_pitch", 0.25}};
  config.servos["kp"].all = 35;
  config.servos["kd"].all = 0;
  config.servos["damping"].all = 0.5;
  config.servos["armature"].all = 0.005;
  config.servos["friction"] = {0.3, {{"FL_knee", 1}}};
  return config;
}

/// Of a joint under `foreign()`, rad.
double foreign_home(const RobotDescription& robot, int joint) {
  const std::string& name = robot.joint(joint).name;
  return name == "FL_hip_pitch" ? 0.7 : name == "RR_knee" ? -1.4 : robot.home[joint];
}

std::string message_of(const EnvConfig& config) {
  return config_error([&] { static_cast<void>(EnvModel::make(config)); }).what();
}

class JointActions : public EngineTest {};
CROSSGAIT_FOR_EVERY_BACKEND(JointActions);

TEST_P(JointActions, AreServoTargetsAboutHome) {
  // Against the engine alone, from the same instant, on targets worked out here.
  const EnvConfig config = foreign();
  QuadrupedEnv env(config, find_engine(GetParam()));
  std::vector<double> seen(env.observation_size());
  env.reset(0, seen);
  const auto alone = find_engine(GetParam()).make(env.world().spec());
  alone->restore(env.world().save());
  const RobotDescription& robot = env.world().robot();
  const std::vector<int> servos = robot.actuated_joints();
  Random random(1);
  for (int i = 0; i < 20; ++i) {
    std::vector<double> action = scenes::random_action(random, 12);
    action[5] *= 3;  // clipped to 1
    env.step(action, seen);
    JointTargets targets;
    targets.q.resize(12);
    for (std::size_t k = 0; k < servos.size(); ++k) {
      const std::string& name = robot.joint(servos[k]).name;
      const auto at = std::find(config.joints.order.begin(), config.joints.order.end(), name);
      const double a = action[static_cast<std::size_t>(at - config.joints.order.begin())];
      const double scale = name == "FL_hip_pitch" ? 0.25 : 0.5;
      targets.q[static_cast<Eigen::Index>(k)] =
          foreign_home(robot, servos[k]) + scale * std::clamp(a, -1.0, 1.0);
    }
    ASSERT_EQ(alone->step(targets, 20), StepStatus::kOk);
    ASSERT_TRUE(scenes::identical(env.world().state(), alone->state())) << i;
  }
}

TEST_P(JointActions, AreSeenInTheirOrderAsTheFieldSeesThem) {
  const EnvConfig config = foreign();
  QuadrupedEnv env(config, find_engine(GetParam()));
  ASSERT_EQ(env.action_size(), 12U);
  ASSERT_EQ(env.observation_size(), 48U);
  EXPECT_EQ(env.action_layout().entries[10],
            (LayoutEntry{"target.FL_hip_pitch", "0.25 rad from 0.700", -1, 1}));
  std::vector<double> seen(48);
  env.reset(0, seen);
  Random random(2);
  std::vector<double> action;
  for (int i = 0; i < 10; ++i) {
    action = scenes::random_action(random, 12);
    env.step(action, seen);
  }
  const RobotState& state = env.world().state();
  const Matrix3 R_BW = state.q_WB.toRotationMatrix().transpose();
  const RobotDescription& robot = env.world().robot();
  for (Eigen::Index k = 0; k < 3; ++k) {
    const auto at = static_cast<std::size_t>(k);
    EXPECT_NEAR(seen[at], (R_BW * state.v_WB)[k], 1e-14);
    EXPECT_NEAR(seen[3 + at], (R_BW * state.w_WB)[k], 1e-14);
    EXPECT_NEAR(seen[6 + at], -R_BW(k, 2), 1e-15);
    EXPECT_EQ(seen[45 + at], k == 0 ? 0.3 : 0);
  }
  for (std::size_t k = 0; k < 12; ++k) {
    const std::string& name = config.joints.order[k];
    int joint = 0;
    while (robot.joint(joint).name != name) ++joint;
    EXPECT_EQ(seen[9 + k], state.q[joint] - foreign_home(robot, joint)) << name;
    EXPECT_EQ(seen[21 + k], state.qd[joint]) << name;
    EXPECT_EQ(seen[33 + k], action[k]) << name;
    EXPECT_EQ(env.observation_layout().entries[9 + k].name, "dq." + name);
    EXPECT_EQ(env.observation_layout().entries[33 + k].name, "last.target." + name);
  }
}

TEST(JointHome, IsHowTheRobotStandsAtFirst) {
  const auto model = EnvModel::make(foreign());
  const RobotDescription& robot = *model->world.robot;
  const RobotState state = JointControl(*model).initial_state(make_terrain("flat"), {});
  for (int i = 0; i < robot.joint_count(); ++i)
    EXPECT_EQ(state.q[i], foreign_home(robot, i)) << robot.joint(i).name;
}

TEST_P(JointActions, StandAtHomeUnderTheZeroPolicy) {
  EnvConfig bent = joints_of("scara_quadruped");
  // A five-bar's elbows follow its shoulders: chains that did not meet would jump at the first step.
  bent.joints.home.by_name = {{"FL_shoulder_left", EnvModel::make(bent)->joints.home[1] + 0.1}};
  for (const EnvConfig& config : {joints_of("scara_quadruped"), joints_of("serial_quadruped"), bent}) {
    QuadrupedEnv env(config, find_engine(GetParam()));
    std::vector<double> seen(env.observation_size());
    env.reset(0, seen);
    for (int i = 0; i < 50; ++i) ASSERT_FALSE(env.step(std::vector<double>(12, 0), seen).done());
    const MotionSummary summary = env.summary();
    EXPECT_LT(std::abs(summary.distance_m), 0.01) << config.robot;
    EXPECT_LT(summary.rms_pitch_deg, 4) << config.robot;
    EXPECT_LT(summary.max_loop_gap_m, 5e-4) << config.robot;  // 0.1 mm by the softness of loops
    for (const Leg leg : kLegs) EXPECT_TRUE(env.info().contacts[leg].touching) << name(leg);
  }
}

TEST_P(JointActions, ComeAfterTheirDelay) {
  EnvConfig config = joints_of("serial_quadruped");
  config.policy_dt = config.control_dt = 2e-3;
  config.joints.delay = 6e-3;
  QuadrupedEnv env(config, find_engine(GetParam()));
  std::vector<double> seen(env.observation_size());
  for (int episode = 0; episode < 2; ++episode) {  // what is on its way does not outlive an episode
    env.reset(0, seen);
    const double home = env.model().joints.home[0];
    for (int i = 0; i < 8; ++i) {
      env.step(std::vector<double>(12, 0.1 * (i + 1)), seen);
      const double wanted = i < 3 ? home : home + 0.5 * (0.1 * (i - 3 + 1));
      EXPECT_EQ(env.targets().joints.q[0], wanted) << i;
    }
  }
}

TEST_P(JointActions, GoBeyondOneWhereTheLimitSays) {
  EnvConfig config = joints_of("serial_quadruped");
  config.joints.limit = 2.5;
  config.joints.scale.all = 0.02;
  QuadrupedEnv env(config, find_engine(GetParam()));
  std::vector<double> seen(env.observation_size());
  env.reset(0, seen);
  env.step(std::vector<double>(12, 7), seen);
  EXPECT_EQ(seen[33], 2.5);
  EXPECT_EQ(env.targets().joints.q[0], env.model().joints.home[0] + 0.02 * 2.5);
}

TEST_P(JointActions, AreMeasuredFromAnOffsetOrWhereTheJointIs) {
  for (const JointCommand command : {JointCommand::kPosition, JointCommand::kRelative}) {
    EnvConfig config = joints_of("serial_quadruped");
    config.joints.command = command;
    config.joints.scale.all = 0.1;
    config.joints.upper.by_name = {{"FL_knee", -1.2}};
    if (command == JointCommand::kPosition) config.joints.offset.by_name = {{"FL_abduction", 0.05}};
    QuadrupedEnv env(config, find_engine(GetParam()));
    std::vector<double> seen(env.observation_size());
    env.reset(0, seen);
    for (int i = 0; i < 5; ++i) {
      const RobotState before = env.world().state();
      env.step(std::vector<double>(12, 0.5), seen);
      const std::vector<int>& servos = env.model().joints.servos;
      for (std::size_t k = 0; k < 12; ++k) {
        const std::string& name = env.world().spec().robot->joint(servos[k]).name;
        const double offset = name == "FL_abduction" ? 0.05 : env.model().joints.home[k];
        const double from = command == JointCommand::kPosition ? offset : before.q[servos[k]];
        const double wanted = name == "FL_knee" ? std::min(from + 0.05, -1.2) : from + 0.05;
        EXPECT_EQ(env.targets().joints.q[static_cast<Eigen::Index>(k)], wanted) << name << i;
      }
    }
  }
}

TEST_P(JointActions, ApproachTheirTargetsThroughTheFilter) {
  EnvConfig config = joints_of("serial_quadruped");
  config.joints.filter = 0.25;
  config.joints.scale.all = 0.2;
  QuadrupedEnv env(config, find_engine(GetParam()));
  std::vector<double> seen(env.observation_size());
  for (int episode = 0; episode < 2; ++episode) {
    env.reset(0, seen);
    const double home = env.model().joints.home[0];
    double left = 1;
    for (int i = 0; i < 4; ++i) {
      env.step(std::vector<double>(12, 0.5), seen);
      left *= 0.75;
      // Rounding of a few sums of numbers of order 1.
      EXPECT_NEAR(env.targets().joints.q[0], home + 0.1 * (1 - left), 1e-14);
    }
  }
}

// The torque that a servo gives at the target is the one that was asked for.
TEST_P(JointActions, AreTorques) {
  EnvConfig config = joints_of("serial_quadruped");
  config.joints.command = JointCommand::kTorque;
  config.joints.scale.all = 2;
  config.control_dt = config.physics_dt;
  config.policy_dt = config.physics_dt;
  QuadrupedEnv env(config, find_engine(GetParam()));
  std::vector<double> seen(env.observation_size());
  env.reset(0, seen);
  for (int i = 0; i < 5; ++i) {
    const RobotState before = env.world().state();
    env.step(std::vector<double>(12, 0.1 * (i + 1)), seen);
    const std::vector<int>& servos = env.model().joints.servos;
    for (std::size_t k = 0; k < 12; ++k) {
      const Joint& joint = env.world().spec().robot->joint(servos[k]);
      const double torque =
          joint.kp * (env.targets().joints.q[static_cast<Eigen::Index>(k)] - before.q[servos[k]]) -
          joint.kd * before.qd[servos[k]];
      // kp amplifies the rounding of angles.
      EXPECT_NEAR(torque, 0.2 * (i + 1), 1e-12 * std::max(1.0, joint.kp)) << joint.name;
    }
  }
  config.control_dt = 2 * config.physics_dt;
  config.policy_dt = config.control_dt;
  EXPECT_NE(message_of(config).find("control_dt: expected physics_dt"), std::string::npos);
}

TEST_P(JointActions, HaveNoGait) {
  QuadrupedEnv env(joints_of("serial_quadruped"), find_engine(GetParam()));
  std::vector<double> seen(env.observation_size());
  env.reset(0, seen);
  env.step(std::vector<double>(12, 0), seen);
  EXPECT_EQ(env.gait(), nullptr);
  EXPECT_FALSE(env.info().parameters);
  EXPECT_FALSE(env.targets().contact_schedule);
  ASSERT_TRUE(env.targets().velocity);
  EXPECT_EQ(env.targets().velocity->vx, 0.3);
  env.set_command({0.1, 0.2, -0.3});
  env.step(std::vector<double>(12, 0), seen);
  EXPECT_EQ(env.targets().velocity->yaw_rate, -0.3);
  EXPECT_EQ(seen[47], -0.3);
}

TEST_P(JointActions, UseTheServosThatThePolicyWasMadeFor) {
  const auto env = EnvModel::make(foreign());
  for (const int i : env->world.robot->actuated_joints()) {
    const Joint& joint = env->world.robot->joint(i);
    EXPECT_EQ(joint.kp, 35);
    EXPECT_EQ(joint.kd, 0);
    EXPECT_EQ(joint.damping, 0.5);
    EXPECT_EQ(joint.armature, 0.005);
    EXPECT_EQ(joint.friction, joint.name == "FL_knee" ? 1 : 0.3);
  }
}

class JointPolicies : public ScratchFolder, public ::testing::WithParamInterface<std::string> {};
INSTANTIATE_TEST_SUITE_P(EveryEngine, JointPolicies, ::testing::ValuesIn(available_engines()),
                         [](const auto& engine) { return test_name(engine.param); });

TEST_P(JointPolicies, OfSwishNetworksRunFromABundle) {
  const EnvConfig config = foreign();
  QuadrupedEnv env(config, find_engine(GetParam()));
  MlpNetwork network = policy_tests::random_network(env.interface(), {512, 256, 128});
  network.activation = MlpActivation::kSwish;
  network.output = MlpOutput::kTanh;
  const std::string file = path("joints.safetensors");
  write_policy_bundle(file, network, env.interface());
  const auto policy = make_policy(file, env.interface());
  std::vector<double> seen(48), action(12);
  env.reset(0, seen);
  for (int i = 0; i < 20; ++i) {
    policy->act(seen, action);
    Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(seen.data(), 48);
    x = (x - network.observation_mean).cwiseQuotient(network.observation_std).cwiseMax(-10).cwiseMin(10);
    for (std::size_t k = 0; k < network.layers.size(); ++k) {
      x = network.layers[k].weight * x + network.layers[k].bias;
      for (double& value : x)
        value = k + 1 < network.layers.size() ? value / (1 + std::exp(-value)) : std::tanh(value);
    }
    for (std::size_t k = 0; k < 12; ++k) EXPECT_NEAR(action[k], x[static_cast<Eigen::Index>(k)], 1e-5);
    env.step(action, seen);
  }
  // Another order, home, scale or limit of the same names is another meaning.
  for (const auto& change : std::vector<std::function<void(EnvConfig&)>>{
           [](EnvConfig& c) { std::swap(c.joints.order[0], c.joints.order[3]); },
           [](EnvConfig& c) { c.joints.home.by_name["FL_hip_pitch"] = 0.71; },
           [](EnvConfig& c) { c.joints.scale.all = 0.4; },
           [](EnvConfig& c) { c.observation[1].scale = {0.25}; }}) {
    EnvConfig other = config;
    change(other);
    EXPECT_THROW(static_cast<void>(make_policy(file, EnvModel::make(other)->interface)), ConfigError);
  }
}

TEST(JointActionLayout, IsTheSameForHomesThatRoundTheSame) {
  JointActionTable table{
      .servos = {0, 1, 2}, .slots = {0, 1, 2}, .home = {-1e-17, 0, 0.0004}, .scale = {0.5, 0.5, 0.5}};
  const std::vector<std::string> servos{"a", "b", "c"};
  for (const LayoutEntry& entry : joint_action_layout(servos, table, 1).entries)
    EXPECT_EQ(entry.unit, "0.5 rad from 0.000");
}

TEST(JointActionSettings, NameWhatIsWrong) {
  const auto complaint = [](const std::function<void(EnvConfig&)>& change) {
    EnvConfig config = joints_of("serial_quadruped");
    change(config);
    return message_of(config);
  };
  EXPECT_EQ(complaint([](EnvConfig& c) { c.joints.order = {"FL_hip_pitch"}; }).substr(0, 68),
            "environment: joints.order: expected each servo of the robot once: FL");
  EXPECT_NE(complaint([](EnvConfig& c) {
              c.joints.home.by_name = {{"FL_nose", 0}};
            }).find("joints.home: expected servos of the robot: "),
            std::string::npos);
  EXPECT_NE(complaint([](EnvConfig& c) {
              c.joints.home.by_name = {{"FL_knee", 9}};
            }).find("joints.home of FL_knee: expected an angle within its limits, "),
            std::string::npos);
  EXPECT_NE(complaint([](EnvConfig& c) {
              c.joints.scale.by_name = {{"knee", 1}};
            }).find("found 'knee'"),
            std::string::npos);
  EXPECT_EQ(complaint([](EnvConfig& c) { c.joints.limit = 0; }),
            "environment: joints.limit: expected a limit in (0, 1000], found 0");
  EXPECT_EQ(complaint([](EnvConfig& c) { c.joints.delay = 3e-3; }),
            "environment: joints.delay: expected a whole multiple of 0.002 s, found 0.003");
  EXPECT_EQ(complaint([](EnvConfig& c) { c.observation.emplace_back("phase"); }),
            "environment: observation: expected blocks that are there with action: joints, found phase");
  EXPECT_EQ(
      complaint([](EnvConfig& c) {
        c.joints.command = JointCommand::kTorque;
        c.control_dt = c.physics_dt;
        c.servos["kd"].all = 1;
        c.servos["implicit_damping"].all = 1;
      }),
      "environment: servos of FL_abduction: expected an explicit servo (law: explicit), which makes the "
      "torque that it is given, found implicit_stiffness 0, implicit_damping 1");
  EXPECT_NE(complaint([](EnvConfig& c) {
              c.servos["implicit_damping"].all = 1.5;
            }).find("implicit_damping, a share of at most 1"),
            std::string::npos);
  EXPECT_NE(complaint([](EnvConfig& c) { c.servos["kp"].all = -1; }).find("kp (N m/rad) >= 0"),
            std::string::npos);
  EXPECT_NE(complaint([](EnvConfig& c) {
              c.servos["effort"].by_name = {{"FL_nose", 1}};
            }).find("servos.effort: expected servos of the robot: "),
            std::string::npos);
  EXPECT_EQ(
      complaint([](EnvConfig& c) { c.servos["delay"].all = 1.5e-3; }),
      "environment: delay of joint 'FL_abduction': expected a whole number of physics steps of 0.001 s, at "
      "most 1000, found 0.0015 s");
  EXPECT_NE(complaint([](EnvConfig& c) {
              c.randomisation[Randomised::kStartPhase] = {0, 1};
            }).find("start_phase: expected action: gait"),
            std::string::npos);
}

}  // namespace
}  // namespace crossgait
