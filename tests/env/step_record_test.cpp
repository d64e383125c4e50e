// What reaches the reward: every term worked out again from what the environment shows, turned away from the
// world's axes and on rough ground, where no field of a StepRecord can stand for another.
#include <cmath>
#include <map>
#include <numeric>

#include "env/quadruped_env.h"
#include "physics/core/error.h"
#include "tests/support/engine_test.h"
#include "tests/support/environments.h"

namespace crossgait {
namespace {

constexpr double kYaw = 2.3;        // rad at the start: neither cosine nor sine is small, and they differ
constexpr double kPolicyDt = 0.02;  // s
const VelocityCommand kCommand{0.11, -0.03, 0.4};

EnvConfig turned_on_rough_ground() {
  EnvConfig config;
  config.terrain = "rough:amplitude=.006";
  config.randomisation[Randomised::kStartYaw] = {kYaw - 0.1, kYaw + 0.1};
  config.randomisation[Randomised::kStartX] = {0.2, 0.4};
  config.policy_dt = config.control_dt = kPolicyDt;  // so that one set of targets makes a policy step again
  config.episode_seconds = 2;
  config.settle_seconds = 0.2;
  config.command = kCommand;
  config.reward.fill(1);
  return config;
}

double ground_clearance(const QuadrupedEnv& env) {
  const Vector3& p = env.world().state().p_WB;
  return p.z() - env.world().spec().terrain.height(p.x(), p.y());
}

/// What an onlooker knows of one step.
struct Seen {
  RobotState before, after;
  double start_yaw, standing_height;
  std::vector<double> action, last_action;
  GaitParameters parameters, last_parameters;
  bool terminated;
  double work = 0, torque_squares = 0, slip_squares = 0;  // integrals over the step's physics steps
};

/// Makes the step again in a world that was saved before it, physics step by physics step.
void make_again(PhysicsBackend& world, const Snapshot& before, const ControlTargets& targets, Seen& seen) {
  world.restore(before);
  const double h = world.spec().physics_dt;
  seen.work = seen.torque_squares = seen.slip_squares = 0;
  for (int i = 0; i < std::lround(kPolicyDt / h); ++i) {
    const JointVector qd = world.state().qd;
    ASSERT_EQ(world.step(targets.joints), StepStatus::kOk);
    for (const int j : world.robot().actuated_joints()) {
      const double servo = world.torques()[j] + world.robot().joint(j).damping * qd[j];
      seen.work += std::abs(servo * (qd[j] + world.state().qd[j]) / 2) * h;
      seen.torque_squares += std::pow(world.torques()[j], 2) * h;
    }
    for (const FootContact& foot : world.foot_contacts()) {
      if (foot.touching) seen.slip_squares += std::pow(foot.slip_speed, 2) * h;
    }
  }
  EXPECT_TRUE(scenes::identical(world.state(), seen.after));
}

double squares(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(a[i] - b[i], 2);
  return sum;
}

// The base's forward and left direction on the ground, as its x and y axes point, by nothing but the
// quaternion.
Vector3 heading_of(const RobotState& s) {
  const Vector3 x = s.q_WB * Vector3::UnitX();
  return Vector3(x.x(), x.y(), 0).normalized();
}
Vector3 left_of(const Vector3& forward) { return Vector3::UnitZ().cross(forward); }

std::map<std::string, double> expected_terms(const QuadrupedEnv& env, const Seen& seen) {
  const RobotState &before = seen.before, &after = seen.after;
  const PhysicsBackend& world = env.world();
  const RobotDescription& robot = world.robot();
  const Vector3 start(std::cos(seen.start_yaw), std::sin(seen.start_yaw), 0), now = heading_of(after);
  const Vector3& v = after.v_WB;
  double pattern = 0;
  const LegArray<FootContact> feet = world.foot_contacts();
  for (const Leg leg : kLegs) {
    pattern += feet[leg].touching != env.gait()->is_swing(leg) ? 0.2 : -0.5;
  }
  double acceleration = 0;
  for (const int i : robot.actuated_joints())
    acceleration += std::pow((after.qd[i] - before.qd[i]) / kPolicyDt, 2);
  double adaptation = 0;
  for (const ParameterRow& row : env.gait()->adapted())
    adaptation += std::pow(seen.parameters.*row.member - seen.last_parameters.*row.member, 2);
  const Vector3 rpy = roll_pitch_yaw(after.q_WB);
  const double yaw = std::remainder(std::atan2(now.y(), now.x()) - seen.start_yaw, 2 * M_PI);
  const Vector3 gravity_in_base = after.q_WB.toRotationMatrix().transpose() * Vector3(0, 0, -1);
  const double weight = robot.total_mass() * 9.81;
  return {
      {"forward_velocity", v.dot(start)},
      {"lateral_velocity", std::abs(v.dot(left_of(start)))},
      {"contact_pattern", pattern},
      {"orientation_l2", (rpy.x() * rpy.x() + rpy.y() * rpy.y() + yaw * yaw) * std::pow(180 / M_PI, 2)},
      {"joint_acc_l2", acceleration},
      {"parameter_rate_l2", adaptation},
      {"velocity_tracking",
       std::exp(-(std::pow(v.dot(now) - kCommand.vx, 2) + std::pow(v.dot(left_of(now)) - kCommand.vy, 2)) /
                std::pow(0.1, 2))},
      {"velocity_error", std::hypot(v.dot(now) - kCommand.vx, v.dot(left_of(now)) - kCommand.vy)},
      {"forward_velocity_ratio", std::clamp(v.dot(start) / kCommand.vx, -1.0, 1.0)},
      {"yaw_rate_tracking", std::exp(-std::pow((after.w_WB.z() - kCommand.yaw_rate) / 0.5, 2))},
      {"yaw_rate_error", std::abs(after.w_WB.z() - kCommand.yaw_rate)},
      {"vertical_velocity", std::pow(v.z(), 2)},
      {"tilt_rate", std::pow(after.w_WB.x(), 2) + std::pow(after.w_WB.y(), 2)},
      {"flat_orientation_l2", std::pow(gravity_in_base.x(), 2) + std::pow(gravity_in_base.y(), 2)},
      {"base_height_l2", std::pow(ground_clearance(env) - seen.standing_height, 2)},
      {"alive", 1},
      {"termination", seen.terminated ? 1 : 0},
      {"action_rate_l2", squares(seen.action, seen.last_action)},
      {"action_l2", squares(seen.action, std::vector<double>(seen.action.size(), 0))},
      {"foot_slip", seen.slip_squares / kPolicyDt},
      {"joint_torques_l2", seen.torque_squares / kPolicyDt},
      {"power", seen.work / kPolicyDt},
      {"cost_of_transport",
       seen.work / (weight * std::max((after.p_WB - before.p_WB).head<2>().norm(), 0.02 * kPolicyDt))},
  };
}

class StepRecords : public EngineTest {
 protected:
  /// Runs until the episode ends, comparing every term of every step. @returns the sum of each term's size
  static std::map<std::string, double> compare(QuadrupedEnv& env, StepResult& result) {
    std::vector<double> observation(env.observation_size());
    env.reset(5, observation);
    Seen seen{};
    seen.start_yaw = roll_pitch_yaw(env.world().state().q_WB).z();
    seen.standing_height = ground_clearance(env);
    seen.action.assign(env.action_size(), 0);
    seen.parameters = *env.info().parameters;
    EXPECT_NEAR(seen.start_yaw, kYaw, 0.3);  // drawn within 0.1, and settled on rough ground
    std::map<std::string, double> sums;
    Random random(3);
    result = {};
    const auto other = env.engine().make(env.world().spec());
    while (!result.done()) {
      const Snapshot snapshot = env.world().save();
      seen.before = env.world().state();
      seen.last_action = seen.action;
      seen.last_parameters = seen.parameters;
      seen.action = scenes::random_action(random, env.action_size());
      result = env.step(seen.action, observation);
      seen.after = env.world().state();
      if (env.config().control_dt == kPolicyDt) make_again(*other, snapshot, env.targets(), seen);
      seen.parameters = *env.info().parameters;
      seen.terminated = result.terminated;
      for (const auto& [name, unweighted] : expected_terms(env, seen)) {
        const double value = env.config().reward[find_reward_term(name)] * unweighted;
        const double found = env.info().reward_terms[find_reward_term(name)];
        // The same few operations in another order; accelerations of 1e3 rad/s^2 are differences of speeds.
        EXPECT_NEAR(found, value, 1e-11 * (1 + std::abs(value))) << name << " at " << env.info().time << " s";
        sums[name] += std::abs(value);
      }
      const RewardTerms& terms = env.info().reward_terms;
      const double reward = std::accumulate(terms.begin(), terms.end(), 0.0);
      EXPECT_NEAR(result.reward, reward, 1e-10 * (1 + std::abs(reward)));
      if (::testing::Test::HasFailure()) break;  // one step says it all
    }
    return sums;
  }
};
CROSSGAIT_FOR_EVERY_BACKEND(StepRecords);

TEST_P(StepRecords, HoldWhatHappened) {
  QuadrupedEnv env(turned_on_rough_ground(), find_engine(GetParam()));
  StepResult result;
  const std::map<std::string, double> sums = compare(env, result);
  for (const auto& [name, sum] : sums) {
    if (name == "termination") continue;
    EXPECT_GT(sum, 0) << name << " was never put to the test";
  }
  // Across the world's axes and its own: what a turn the wrong way would give differs.
  EXPECT_GT(std::abs(env.info().lateral), 1e-4);
}

TEST_P(StepRecords, SayOfTheLastStepThatItFailed) {
  EnvConfig config = turned_on_rough_ground();
  config.tilt_limit_deg = 3;  // a trot pitches by 5 degrees
  config.control_dt = 2e-3;   // of which no step is made again: without what is summed up within it
  for (const char* name : {"foot_slip", "joint_torques_l2", "power", "cost_of_transport"})
    config.reward[find_reward_term(name)] = 0;
  QuadrupedEnv env(config, find_engine(GetParam()));
  StepResult result;
  const std::map<std::string, double> sums = compare(env, result);
  EXPECT_TRUE(result.terminated);
  EXPECT_EQ(sums.at("termination"), 1);
  EXPECT_GT(sums.at("alive"), 1);
}

TEST_P(StepRecords, DistancesAreAlongAndLeftOfTheHeadingAtTheStart) {
  QuadrupedEnv env(turned_on_rough_ground(), find_engine(GetParam()));
  std::vector<double> observation(env.observation_size());
  env.reset(5, observation);
  const RobotState start = env.world().state();
  const Vector3 forward = heading_of(start);
  for (int i = 0; i < 60; ++i) env.step(std::vector<double>(env.action_size(), 0), observation);
  const Vector3 moved = env.world().state().p_WB - start.p_WB;
  EXPECT_GT(moved.norm(), 0.03);
  // One rotation of numbers of order one.
  EXPECT_NEAR(env.info().distance, moved.dot(forward), 1e-13);
  EXPECT_NEAR(env.info().lateral, moved.dot(left_of(forward)), 1e-13);
}

}  // namespace
}  // namespace crossgait
