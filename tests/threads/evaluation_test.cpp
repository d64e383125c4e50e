#include "env/evaluation.h"

#include <algorithm>
#include <cmath>

#include "physics/core/error.h"
#include "tests/support/engine_test.h"
#include "tests/support/environments.h"

namespace crossgait {
namespace {

// Fails at its third action, as one whose own code throws.
class FailingPolicy final : public Policy {
 public:
  explicit FailingPolicy(const PolicyInterface& interface) : Policy("failing", interface) {}
  bool has_failed() const noexcept override { return acts_ >= 3; }

 private:
  void do_reset(std::uint64_t) noexcept override { acts_ = 0; }
  void do_act(std::span<const double>, std::span<double> action) noexcept override {
    ++acts_;
    std::fill(action.begin(), action.end(), 0.0);
  }

  int acts_ = 0;
};

class Evaluations : public EngineTest {
 protected:
  static EnvConfig config() {
    EnvConfig c;
    c.episode_seconds = 1;
    c.settle_seconds = 0.1;
    c.randomisation[Randomised::kStartYaw] = {-1, 1};
    return c;
  }
  static std::vector<EpisodeSummary> evaluate(const EnvConfig& config, const std::string& policy,
                                              std::size_t workers) {
    return evaluate_policy([&] { return std::make_unique<QuadrupedEnv>(config, find_engine(GetParam())); },
                           [&](const PolicyInterface& interface) { return make_policy(policy, interface); },
                           4, 5, workers);
  }
};
CROSSGAIT_FOR_EVERY_BACKEND(Evaluations);

TEST_P(Evaluations, AddUpWhatTheEpisodesDid) {
  QuadrupedEnv env(config(), find_engine(GetParam()));
  const auto zero = make_policy("zero", env.interface());
  double reward = 0;
  int steps = 0;
  const EpisodeSummary s = run_episode(env, *zero, 3, [&](const QuadrupedEnv& e) {
    ++steps;
    for (const double term : e.info().reward_terms) reward += term;
    return true;
  });
  EXPECT_EQ(steps, 500);
  EXPECT_EQ(s.steps, 500);
  EXPECT_DOUBLE_EQ(s.motion.simulated_seconds, 1);
  EXPECT_NEAR(s.total_reward, reward, 1e-9 * std::abs(reward));  // rounding of another order of sums
  double terms = 0;
  for (const double term : s.reward_terms) terms += term;
  EXPECT_NEAR(terms, reward, 1e-9 * std::abs(reward));
  EXPECT_EQ(s.motion.distance_m, env.info().distance);
  EXPECT_DOUBLE_EQ(s.motion.mean_speed_mps, s.motion.distance_m);
  EXPECT_GT(s.motion.distance_m, 0.05);
  EXPECT_GT(s.motion.cost_of_transport.value(), 0.5);  // a trot of scara_quadruped: 2 to 3
  EXPECT_GT(s.motion.slip_m, 0);
  EXPECT_EQ(s.motion.outcome, Outcome::kWalked);
}

TEST_P(Evaluations, AreTheSameForAnyNumberOfWorkersAndWorldsForAnyPolicy) {
  const auto one = evaluate(config(), "random", 1), three = evaluate(config(), "random", 3),
             zero = evaluate(config(), "zero", 2);
  for (std::size_t k = 0; k < one.size(); ++k) {
    EXPECT_EQ(one[k].total_reward, three[k].total_reward);
    EXPECT_EQ(one[k].seed, zero[k].seed);
    EXPECT_NE(one[k].total_reward, zero[k].total_reward);
  }
  EXPECT_NE(one[0].total_reward, one[1].total_reward);
}

TEST_P(Evaluations, NeedOneWorkerAtLeast) {
  EnvConfig brief = config();
  brief.episode_seconds = 0.02;
  int made = 0;
  const auto episodes_of = [&](std::size_t episodes, std::size_t workers) {
    made = 0;
    const EnvFactory factory = [&] {
      ++made;
      return std::make_unique<QuadrupedEnv>(brief, find_engine(GetParam()));
    };
    const PolicyFactory zero = [](const PolicyInterface& interface) {
      return make_policy("zero", interface);
    };
    return evaluate_policy(factory, zero, episodes, 5, workers).size();
  };
  EXPECT_EQ(episodes_of(1, 0), 1U);
  EXPECT_EQ(made, 1);
  EXPECT_EQ(episodes_of(2, 5), 2U);
  EXPECT_EQ(made, 2);  // no more than there are episodes
  EXPECT_EQ(episodes_of(0, 5), 0U);
  EXPECT_EQ(made, 1);  // which says whether environment and policy can be made at all
}

TEST_P(Evaluations, RefuseAPolicyOfAnotherLayout) {
  QuadrupedEnv env(config(), find_engine(GetParam()));
  EnvConfig other = config();
  other.adapt = {"step_length"};
  const QuadrupedEnv narrower(other, find_engine(GetParam()));
  const auto policy = make_policy("zero", narrower.interface());
  EXPECT_THROW(run_episode(env, *policy, 0), ConfigError);
}

TEST_P(Evaluations, EndWithAPolicyThatHasFailed) {
  QuadrupedEnv env(config(), find_engine(GetParam()));
  FailingPolicy policy(env.interface());
  EXPECT_EQ(run_episode(env, policy, 3).steps, 2);
}

TEST(SumUp, IsMeansAndSampleDeviations) {
  std::vector<EpisodeSummary> episodes(3);
  for (std::size_t i = 0; i < 3; ++i) {
    episodes[i].total_reward = static_cast<double>(i);  // 0, 1, 2
    episodes[i].reward_terms[0] = 3;
    episodes[i].steps = 10;
    episodes[i].invalid_actions = 2;
    episodes[i].clipped_actions = {{"a", "b"}, {static_cast<std::int64_t>(i), 2}, 10};
    episodes[i].motion.ik_clamped = 5;
    episodes[i].motion.simulated_seconds = 1.5;
    episodes[i].motion.distance_m = 0.5;
    episodes[i].motion.mean_speed_mps = 0.25;
    episodes[i].motion.path_m = 0.75;
    episodes[i].motion.rms_roll_deg = 1.25;
    episodes[i].motion.rms_pitch_deg = 2.25;
    episodes[i].motion.slip_m = 0.125;
  }
  episodes[0].motion.cost_of_transport = 2;
  episodes[2].motion.cost_of_transport = 4;
  episodes[0].motion.slip_per_path = 0.2;
  episodes[1].motion.slip_per_path = 0.3;
  episodes[1].motion.heading_error_deg = 4;
  episodes[2].motion.heading_error_deg = 6;
  episodes[1].motion.outcome = Outcome::kFell;
  episodes[2].motion.outcome = Outcome::kSlid;
  for (EpisodeSummary& e : episodes) e.motion.duty_factor.fill(0.25);
  episodes[2].motion.duty_factor[Leg::RR] = 0.85;
  using M = MotionSummary;
  const Evaluation all = sum_up(episodes);
  EXPECT_DOUBLE_EQ(all.total_reward.mean, 1);
  EXPECT_DOUBLE_EQ(all.total_reward.deviation, 1);
  EXPECT_DOUBLE_EQ(all.reward_terms[0], 3);
  EXPECT_EQ(all.steps, 30);
  EXPECT_EQ(all.invalid_actions, 6);
  EXPECT_EQ(all.clipped_actions.clipped, (std::vector<std::int64_t>{3, 6}));
  EXPECT_EQ(all.clipped_actions.ratio(), 9. / 60);
  EXPECT_EQ(all.clipped_actions.worst()->name, "b");
  EXPECT_EQ(all.clipped_actions.worst()->ratio, 6. / 30);
  EXPECT_EQ(all.motion.of(&M::ik_clamped), 15);
  EXPECT_EQ(all.simulated_seconds, 4.5);
  EXPECT_EQ(all.motion.of(&M::distance_m).mean, 0.5);
  EXPECT_EQ(all.motion.of(&M::mean_speed_mps).mean, 0.25);
  EXPECT_EQ(all.motion.of(&M::path_m).mean, 0.75);
  EXPECT_EQ(all.motion.of(&M::rms_roll_deg).mean, 1.25);
  EXPECT_EQ(all.motion.of(&M::rms_pitch_deg).mean, 2.25);
  EXPECT_EQ(all.motion.of(&M::slip_m).mean, 0.125);
  EXPECT_EQ(all.count(Outcome::kFell), 1U);
  EXPECT_EQ(all.count(Outcome::kSlid), 1U);
  EXPECT_EQ(all.count(Outcome::kWalked), 1U);
  EXPECT_EQ(all.ended_early(), 1U);
  ASSERT_TRUE(all.motion.of(&M::cost_of_transport).has_value());  // of the two that have one
  EXPECT_DOUBLE_EQ(all.motion.of(&M::cost_of_transport)->mean, 3);
  EXPECT_DOUBLE_EQ(all.motion.of(&M::cost_of_transport)->deviation, std::sqrt(2.0));
  EXPECT_FALSE(all.motion.of(&M::swing_contact_ratio).has_value());
  EXPECT_FALSE(all.motion.of(&M::swing_contact_ratio_inner).has_value());
  ASSERT_TRUE(all.motion.of(&M::slip_per_path).has_value());
  EXPECT_DOUBLE_EQ(all.motion.of(&M::slip_per_path)->mean, 0.25);
  ASSERT_TRUE(all.motion.of(&M::heading_error_deg).has_value());
  EXPECT_DOUBLE_EQ(all.motion.of(&M::heading_error_deg)->mean, 5);
  EXPECT_DOUBLE_EQ(all.motion.of(&M::duty_factor).mean, 0.3);
  EXPECT_EQ(sum_up({}).episodes, 0U);
  episodes.resize(1);
  EXPECT_EQ(sum_up(episodes).total_reward.deviation, 0);
}

}  // namespace
}  // namespace crossgait
