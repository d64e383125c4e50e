#include "diagnosis/walk_score.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "backends/registry.h"
#include "env/evaluation.h"
#include "physics/core/heading.h"
#include "physics/core/random.h"
#include "study/rollout.h"

namespace crossgait {
namespace {

constexpr double kSetOffSeconds = 1;     // in which a robot comes from standing to its speed
constexpr double kReferenceSpeed = 0.3;  // m/s, where next to none is asked for
constexpr double kReferenceTurn = 0.4;   // rad/s
constexpr double kLean = 0.3;            // rad, beyond what walking robots do

double capped(double value, double most) { return std::min(1.0, value / most); }

// Sums up what is seen after every policy step.
class WalkMeter {
 public:
  explicit WalkMeter(const QuadrupedEnv& env)
      : dt_(env.config().policy_dt),
        weight_(env.model().world.robot->total_mass() * kGravity),
        last_(env.targets().joints.q),
        before_(last_) {}

  void add(const QuadrupedEnv& env) {
    const JointVector& targets = env.targets().joints.q;
    if (++steps_ > 2) {
      jitter_ += (targets - 2 * last_ + before_).cwiseAbs().mean() / (dt_ * dt_);
      ++jitters_;
    }
    before_ = last_;
    last_ = targets;
    const RobotState& state = env.world().state();
    const Vector3 rpy = roll_pitch_yaw(state.q_WB);
    power_ += env.info().power;
    tilt_squares_ += rpy.x() * rpy.x() + rpy.y() * rpy.y();
    if (leaned_after_ == 0 && std::hypot(rpy.x(), rpy.y()) > kLean) leaned_after_ = steps_;
    if (env.info().time < kSetOffSeconds) return;
    const Vector3 velocity = Heading(state.q_WB).components(state.v_WB);
    vx_ += velocity.x();
    vy_ += velocity.y();
    yaw_rate_ += state.w_WB.z();
    ++walked_;
  }

  WalkMeasure measure(const VelocityCommand& asked, double seconds, bool fell) const {
    WalkMeasure m{.asked = asked};
    const double n = std::max(1, walked_), all = std::max(1, steps_);
    m.speed = std::hypot(vx_, vy_) / n;
    m.speed_error = std::hypot(vx_ / n - asked.vx, vy_ / n - asked.vy);
    m.yaw_rate_error = std::abs(yaw_rate_ / n - asked.yaw_rate);
    m.jitter = jitters_ > 0 ? jitter_ / jitters_ : 0;
    const double speed = std::max(kReferenceSpeed, std::hypot(asked.vx, asked.vy));
    m.effort = power_ / all / (weight_ * speed);
    m.tilt = std::sqrt(tilt_squares_ / all);
    m.fell = fell;
    m.lasted = fell ? std::min(1.0, steps_ * dt_ / seconds) : 1;
    m.upright = leaned_after_ > 0 ? std::min(1.0, leaned_after_ * dt_ / seconds) : m.lasted;
    return m;
  }

 private:
  double dt_, weight_;
  JointVector last_, before_;
  double jitter_ = 0, power_ = 0, tilt_squares_ = 0, vx_ = 0, vy_ = 0, yaw_rate_ = 0;
  int steps_ = 0, jitters_ = 0, walked_ = 0, leaned_after_ = 0;
};

// The test's own starts in the place of what is randomised: the world's axes are not the robot's, so that
// what is seen in the wrong frame shows.
EnvConfig tested(EnvConfig config, const WalkTest& test, const VelocityCommand& command) {
  constexpr double kTilt = 0.05;  // rad
  config = test_episode(std::move(config), command, test.seconds);
  config.randomisation[Randomised::kStartYaw] = {-M_PI, M_PI};
  config.randomisation[Randomised::kStartRoll] =
      config.randomisation[Randomised::kStartPitch] = {-kTilt, kTilt};
  return config;
}

WalkMeasure run_walk(QuadrupedEnv& env, Policy& policy, std::uint64_t seed, double seconds) {
  std::vector<double> observation(env.observation_size()), action(env.action_size());
  env.reset(seed, observation);
  policy.reset(seed);
  WalkMeter meter(env);
  StepResult result;
  while (!result.done()) {
    policy.act(observation, action);
    result = env.step(action, observation);
    meter.add(env);
  }
  return meter.measure(*env.config().command, seconds, result.terminated);
}

}  // namespace

EnvConfig test_episode(EnvConfig config, const VelocityCommand& command, double seconds) {
  config.randomisation = {};
  config.command = command;
  config.episode_seconds = std::ceil(seconds / config.policy_dt) * config.policy_dt;
  config.terminations = OutcomeSet::of_episodes();
  return config;
}

std::vector<WalkCommand> walk_commands(const EnvConfig& config) {
  constexpr double kSpeed = 0.5, kLeastSpeed = 0.1, kTurn = 0.4;
  double vx = config.command ? config.command->vx : kSpeed;
  if (std::abs(vx) < kLeastSpeed) vx = kSpeed;
  return {{"straight ahead", {vx, 0, 0}},
          {"turning left", {vx, 0, kTurn}},
          {"turning right", {vx, 0, -kTurn}},
          {"standing", {0, 0, 0}}};
}

double walk_score(const WalkMeasure& walk) noexcept {
  if (walk.fell) return 3 + (1 - (walk.lasted + walk.upright) / 2);
  const double speed = std::max(kReferenceSpeed, std::hypot(walk.asked.vx, walk.asked.vy));
  const double turn = std::max(kReferenceTurn, std::abs(walk.asked.yaw_rate));
  return capped(walk.speed_error, speed) + capped(walk.yaw_rate_error, turn) +
         0.3 * capped(walk.jitter, 500) + 0.2 * capped(walk.effort, 3) + 0.3 * capped(walk.tilt, 0.2);
}

double WalkResult::mean() const noexcept {
  return std::accumulate(scores.begin(), scores.end(), 0.0) /
         static_cast<double>(std::max<std::size_t>(1, scores.size()));
}

std::vector<double> WalkResult::by_seed(std::size_t seeds) const {
  std::vector<double> means(seeds, 0);
  for (std::size_t i = 0; i < scores.size(); ++i)
    means[i % seeds] += scores[i] * static_cast<double>(seeds) / static_cast<double>(scores.size());
  return means;
}

std::size_t WalkResult::falls() const noexcept {
  return static_cast<std::size_t>(
      std::count_if(walks.begin(), walks.end(), [](const WalkMeasure& walk) { return walk.fell; }));
}

namespace {

double speed_bound(const VelocityCommand& asked, const WalkTolerance& t) {
  return t.speed_share * std::hypot(asked.vx, asked.vy) + t.speed;
}
double turn_bound(const VelocityCommand& asked, const WalkTolerance& t) {
  return t.yaw_rate_share * std::abs(asked.yaw_rate) + t.yaw_rate;
}

}  // namespace

std::vector<CommandResult> by_command(const WalkResult& result, std::size_t seeds,
                                      const WalkTolerance& tolerance) {
  std::vector<CommandResult> commands;
  const double n = static_cast<double>(seeds);
  for (std::size_t first = 0; first < result.walks.size(); first += seeds) {
    CommandResult& c = commands.emplace_back(CommandResult{.asked = result.walks[first].asked});
    for (std::size_t k = 0; k < seeds; ++k) {
      const WalkMeasure& walk = result.walks[first + k];
      c.speed_error += walk.speed_error / n;
      c.yaw_rate_error += walk.yaw_rate_error / n;
      c.score += result.scores[first + k] / n;
      c.falls += walk.fell ? 1 : 0;
      if (result.scores[first + k] > result.scores[first + c.worst]) c.worst = k;
    }
    c.done = c.falls == 0 && c.speed_error <= speed_bound(c.asked, tolerance) &&
             c.yaw_rate_error <= turn_bound(c.asked, tolerance);
  }
  return commands;
}

bool does_what_is_asked(const WalkResult& result, std::size_t seeds, const WalkTolerance& tolerance) {
  const std::vector<CommandResult> commands = by_command(result, seeds, tolerance);
  return std::all_of(commands.begin(), commands.end(), [](const CommandResult& c) { return c.done; });
}

std::string what_is_wrong(const WalkResult& result, const WalkTest& test, const WalkTolerance& tolerance) {
  if (const std::size_t falls = result.falls(); falls > 0)
    return fmt::format("falls in {} of {} walks", falls, result.walks.size());
  double worst = 1;
  std::string words = "does what it is asked";
  const std::vector<CommandResult> commands = by_command(result, test.seeds, tolerance);
  for (std::size_t c = 0; c < test.commands.size(); ++c) {
    const CommandResult& means = commands[c];
    const VelocityCommand& asked = test.commands[c].velocity;
    const double speed = means.speed_error / speed_bound(asked, tolerance),
                 turn = means.yaw_rate_error / turn_bound(asked, tolerance);
    if (speed > worst && speed >= turn) {
      worst = speed;
      words = fmt::format("misses the speed by {:.2f} m/s {}", means.speed_error, test.commands[c].name);
    } else if (turn > worst) {
      worst = turn;
      words =
          fmt::format("misses the yaw rate by {:.2f} rad/s {}", means.yaw_rate_error, test.commands[c].name);
    }
  }
  return words;
}

LoadedEnv walk_environment(const LoadedEnv& environment, const WalkTest& test, const WalkCommand& command) {
  return environment.with(tested(environment.config, test, command.velocity));
}

WalkResult run_walks(const LoadedEnv& environment, const RelabelledPolicy& policy, const WalkTest& test,
                     std::uint64_t seed) {
  WalkResult result;
  for (const WalkCommand& command : test.commands) {
    const LoadedEnv loaded = walk_environment(environment, test, command);
    const auto env = env_factory(loaded)();
    const auto own = policy.make(env->interface());
    for (std::size_t k = 0; k < test.seeds; ++k) {
      result.walks.push_back(run_walk(*env, *own, derived_seed(seed, test.first + k), test.seconds));
      result.scores.push_back(walk_score(result.walks.back()));
    }
  }
  return result;
}

}  // namespace crossgait
