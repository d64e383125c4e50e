#include "diagnosis/standing_tests.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "diagnosis/joint_orders.h"
#include "diagnosis/walk_score.h"
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "env/quadruped_env.h"
#include "study/robot_quantities.h"
#include "study/rollout.h"

namespace crossgait {
namespace {

// An environment that starts at one heading, with a policy in it.
class Stand {
 public:
  Stand(const LoadedEnv& environment, const RelabelledPolicy& policy, const VelocityCommand& command,
        double heading, std::uint64_t seed)
      : seed_(seed),
        env_(env_factory(environment.with(at(environment.config, command, heading)))()),
        policy_(policy.make(env_->interface())),
        observation(env_->observation_size()),
        action(env_->action_size()) {
    env_->reset(seed, observation);
    policy_->reset(seed);
  }

  const QuadrupedEnv& env() const { return *env_; }
  void act(std::span<const double> seen, std::span<double> out) { policy_->act(seen, out); }
  /// Acts on what is seen. @returns whether the episode goes on
  bool step() {
    policy_->act(observation, action);
    return step(action);
  }
  /// Forgets what the policy remembers.
  void restart() { policy_->reset(seed_); }
  bool step(std::span<const double> with) { return !env_->step(with, observation).done(); }

 private:
  static EnvConfig at(EnvConfig config, const VelocityCommand& command, double heading) {
    constexpr double kSeconds = 2;
    config = test_episode(std::move(config), command, kSeconds);
    config.randomisation[Randomised::kStartYaw] = {heading, heading};
    return config;
  }

  std::uint64_t seed_;
  std::unique_ptr<QuadrupedEnv> env_;
  std::unique_ptr<Policy> policy_;

 public:
  std::vector<double> observation, action;
};

struct Subject {
  const LoadedEnv& environment;
  const RelabelledPolicy& policy;
  std::uint64_t seed;

  Stand stand(const VelocityCommand& command = {}, double heading = 0) const {
    return {environment, policy, command, heading, seed};
  }
};

StandingTest hold(const Subject& s) {
  constexpr double kFarthest = 0.05, kTilt = 0.15;  // m, rad: more than a robot sinks into its servos
  Stand stand = s.stand();
  const std::vector<double> zero(stand.action.size(), 0);
  while (stand.step(zero)) {
  }
  const StepInfo& info = stand.env().info();
  const double way = std::hypot(info.distance, info.lateral);
  const double tilt = std::hypot(info.roll_pitch_yaw.x(), info.roll_pitch_yaw.y());
  return {.name = "hold",
          .proves = "the zero action rests at the default pose: pose, offset and gains fit the robot",
          .limits = "says nothing of order, signs and observation; a policy may stand otherwise",
          .passed = !is_failure(info.outcome) && way < kFarthest && tilt < kTilt,
          .found = fmt::format("{:.3f} m and {:.3f} rad in 2 s", way, tilt),
          .suspects = {"joints.home", "joints.offset", "servos.k"}};
}

// A target, rad, or whatever the scale is of, by joint.
std::map<std::string, double> commanded(const Stand& stand, std::span<const double> action) {
  const EnvModel& model = stand.env().model();
  std::map<std::string, double> targets;
  for (std::size_t i = 0; i < action.size(); ++i)
    targets[model.world.robot->joint(model.joints.servos[i]).name] = model.joints.scale[i] * action[i];
  return targets;
}

StandingTest symmetry(const Subject& s) {
  constexpr double kMost = 0.25;  // rad: trained policies stand lopsided by a tenth
  Stand stand = s.stand();
  stand.act(stand.observation, stand.action);
  const auto targets = commanded(stand, stand.action);
  const RobotDescription& robot = *stand.env().model().world.robot;
  std::map<std::pair<bool, int>, std::array<double, 2>> pairs;  // front, depth: left, right
  for (const ServoPlace& servo : servo_places(robot))
    pairs[{is_front(servo.leg), servo.depth}][is_left(servo.leg) ? 0 : 1] = targets.at(servo.joint);
  double worst = 0;
  for (const auto& [place, sides] : pairs) {
    // Which way the right one turns against the left one is the robot's; the nearer of both counts.
    worst = std::max(worst, std::min(std::abs(sides[0] - sides[1]), std::abs(sides[0] + sides[1])));
  }
  return {
      .name = "symmetry at rest",
      .proves = "left and right legs are commanded alike at rest, as order and signs would have it",
      .limits = "legs that are exchanged left for right, or front for rear, pass; some true policies do not",
      .passed = worst < kMost,
      .found = fmt::format("{:.3f} rad between left and right at most", worst)};
}

StandingTest yaw_invariance(const Subject& s) {
  constexpr double kMost = 0.05;  // of the actions' size: ground and robot are the same from every side
  constexpr int kSteps = 15;
  const VelocityCommand turning{0.3, 0, 0.4};
  Stand a = s.stand(turning, 0), b = s.stand(turning, M_PI / 2);
  double difference = 0, size = 1e-9;
  for (int k = 0; k < kSteps; ++k) {
    const bool on = a.step(), also = b.step();
    for (std::size_t i = 0; i < a.action.size(); ++i) {
      difference = std::max(difference, std::abs(a.action[i] - b.action[i]));
      size = std::max(size, std::abs(a.action[i]));
    }
    if (!on || !also) break;
  }
  return {
      .name = "yaw invariance",
      .proves = "the same actions after the world is turned by 90 deg: nothing is seen in the world's frame",
      .limits = "says nothing of frames that turn with the robot",
      .passed = difference < kMost * size,
      .found = fmt::format("actions of {:.3g} differ by {:.3g} at most", size, difference),
      .suspects = {"observation.base_"}};
}

// What the newest offsets of joints, or the angles, are called in the observation.
std::optional<std::size_t> entry_of(const Layout& layout, const std::string& joint) {
  for (const char* quantity : {"dq", "q"}) {
    if (const auto at = layout.find(fmt::format("{}.{}", quantity, joint))) return at;
  }
  return std::nullopt;
}

// Not judged: of networks that walk some answer all joints this way, some hardly one.
StandingTest feedback(const Subject& s) {
  constexpr double kNudge = 0.1;  // of the observation, in its unit: rad times its scale
  Stand stand = s.stand();
  std::vector<double> action(stand.action.size());
  stand.act(stand.observation, stand.action);
  const auto before = commanded(stand, stand.action);
  std::size_t back = 0, seen = 0;
  for (const auto& [joint, target] : before) {
    const auto at = entry_of(stand.env().observation_layout(), joint);
    if (!at) continue;
    ++seen;
    std::vector<double> moved = stand.observation;
    moved[*at] += kNudge;
    stand.restart();
    stand.act(moved, action);
    if (commanded(stand, action).at(joint) < target) ++back;
  }
  return {.name = "negative feedback",
          .proves = "a joint that is seen too far is commanded back, as order and signs would have it",
          .limits = "policies that walk answer as they like, so that it is not judged",
          .judged = false,
          .found = seen == 0 ? "no joint angles in the observation"
                             : fmt::format("{} of {} joints are commanded back", back, seen)};
}

StandingTest last_action(const Subject& s) {
  Stand stand = s.stand({0.3, 0, 0});
  StandingTest test{.name = "last action",
                    .proves = "the block of the last action shows the last output, and no clip changes that",
                    .limits = "whether the policy was trained on raw or processed actions is not seen"};
  const Layout& layout = stand.env().observation_layout();
  const auto first = layout.find("last." + stand.env().action_layout().entries.front().name);
  test.judged = first.has_value();
  std::size_t clipped = 0, all = 0;
  for (int k = 0; k < 25 && stand.step(); ++k) {
    for (std::size_t i = 0; i < stand.action.size(); ++i, ++all)
      clipped += std::abs(stand.action[i]) >= stand.env().config().joints.limit ? 1 : 0;
  }
  const double share = static_cast<double>(clipped) / static_cast<double>(std::max<std::size_t>(1, all));
  constexpr double kMost = 0.1;  // of all numbers
  test.passed = share <= kMost;
  test.found = !test.judged ? "no last action in the observation"
                            : fmt::format("{:.0f} % of the actions are clipped at +-{:g}", 100 * share,
                                          stand.env().config().joints.limit);
  return test;
}

StandingTest range(const Subject& s) {
  constexpr double kMost = 5;  // standard deviations, root mean square over a block
  StandingTest test{.name = "range of observations",
                    .proves = "what is seen lies where it lay in training: scales, offsets and order fit",
                    .limits = "a second from standing; only for networks whose normaliser is known"};
  Stand stand = s.stand({0.3, 0, 0});
  const Eigen::VectorXd &mean = s.policy.observation_mean, &deviation = s.policy.observation_std;
  test.judged =
      static_cast<std::size_t>(mean.size()) == stand.observation.size() && deviation.size() == mean.size();
  if (!test.judged) {
    test.found = "no normaliser is known";
    return test;
  }
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(mean.size());
  int steps = 0;
  do {
    const Eigen::Map<const Eigen::VectorXd> seen(stand.observation.data(), mean.size());
    squares += (seen - mean).cwiseQuotient(deviation).cwiseAbs2();
  } while (++steps < 50 && stand.step());
  Eigen::Index at = 0;
  const double worst = std::sqrt(squares.maxCoeff(&at) / steps);
  test.passed = worst < kMost;
  test.found =
      fmt::format("{} is {:.1f} of its deviations from the mean of training at most",
                  stand.env().observation_layout().entries[static_cast<std::size_t>(at)].name, worst);
  return test;
}

StandingTest servo_stability(const Subject& s) {
  const auto model = EnvModel::make(s.environment);
  const std::string warning = servo_loop_warning(*model->world.robot, s.environment.config.physics_dt);
  return {.name = "servo stability",
          .proves = "gains and time step make servos that do not swing by themselves",
          .limits = "of single joints, linear, without contact",
          .passed = warning.empty(),
          .found = warning.empty() ? "stable" : warning};
}

StandingTest stated_layout(const Subject& s) {
  const auto model = EnvModel::make(s.environment);
  StandingTest test{.name = "stated layout",
                    .proves = "order, names, scales, pose and rate are those that the policy's file states",
                    .limits = "the file may have been written for a wrong environment"};
  test.judged = s.policy.layout_hash.has_value();
  const bool same_rate =
      !s.policy.policy_dt || std::abs(*s.policy.policy_dt - s.environment.config.policy_dt) < 1e-9;
  test.passed = !test.judged || (*s.policy.layout_hash == model->layout && same_rate);
  test.found = !test.judged  ? "the file states none"
               : test.passed ? "the same"
                             : "another: the environment is not the one that it was made for";
  return test;
}

}  // namespace

std::vector<StandingTest> run_standing_tests(const LoadedEnv& environment, const RelabelledPolicy& policy,
                                             std::uint64_t seed) {
  const Subject subject{environment, policy, seed};
  std::vector<StandingTest> tests;
  for (const auto& test :
       {hold, symmetry, yaw_invariance, feedback, last_action, range, servo_stability, stated_layout})
    tests.push_back(test(subject));
  return tests;
}

}  // namespace crossgait
