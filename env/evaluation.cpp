#include "env/evaluation.h"

#include <algorithm>

#include "physics/core/error.h"
#include "physics/core/worker_pool.h"

namespace crossgait {
namespace {

// Two streams of random numbers from one seed: the world's and the policy's.
constexpr std::uint64_t kPolicyStream = 0x706f6c696379;  // "policy"

void check_interface(const Policy& policy, const QuadrupedEnv& env) {
  const PolicyInterface &a = policy.interface(), &b = env.interface();
  const std::string difference = layout_difference(b.observation.names(), a.observation.names()) +
                                 layout_difference(b.action.names(), a.action.names());
  if (!difference.empty())
    throw ConfigError(policy.name(), "layout", "a policy for this environment", difference);
}

std::vector<OwnRewardTerm> own_terms_of(const QuadrupedEnv& env) {
  std::vector<OwnRewardTerm> terms;
  if (env.extension() == nullptr) return terms;
  for (const std::string& name : env.config().extension->reward_terms) terms.push_back({name, 0});
  return terms;
}

}  // namespace

EpisodeSummary run_episode(QuadrupedEnv& env, Policy& policy, std::uint64_t seed,
                           const EpisodeObserver& observer) {
  check_interface(policy, env);
  EpisodeSummary s;
  s.seed = seed;
  std::vector<double> observation(env.observation_size()), action(env.action_size());
  env.forget();  // an episode follows from its seed alone, whoever had which before
  env.reset(seed, observation);
  policy.reset(derived_seed(seed, kPolicyStream));
  s.own_reward_terms = own_terms_of(env);
  StepResult result;
  while (!result.done()) {
    policy.act(observation, action);
    if (policy.has_failed()) break;
    result = env.step(action, observation);
    const StepInfo& info = env.info();
    ++s.steps;
    s.total_reward += result.reward;
    for (std::size_t i = 0; i < s.reward_terms.size(); ++i) s.reward_terms[i] += info.reward_terms[i];
    for (std::size_t i = 0; i < s.own_reward_terms.size(); ++i)
      s.own_reward_terms[i].sum += env.extension()->reward_terms()[i];
    s.invalid_actions += info.invalid_actions;
    if (observer && !observer(env)) break;
  }
  s.clipped_actions.add(policy.interface().action, policy.clipped(), s.steps);
  s.motion = env.summary();
  s.parameters = env.info().parameters;
  return s;
}

std::vector<EpisodeSummary> evaluate_policy(const EnvFactory& make_env, const PolicyFactory& make_policy,
                                            std::size_t episodes, std::uint64_t seed, std::size_t workers,
                                            const Progress& progress) {
  std::vector<std::unique_ptr<QuadrupedEnv>> envs;
  std::vector<std::unique_ptr<Policy>> policies;
  for (std::size_t w = 0; w < std::max<std::size_t>(1, std::min(workers, episodes)); ++w) {
    envs.push_back(make_env());
    policies.push_back(make_policy(envs.back()->interface()));
  }
  std::vector<std::optional<EpisodeSummary>> finished(episodes);
  SharedProgress shared(progress, episodes);
  WorkerPool pool(envs.size());
  pool.run(envs.size(), [&](std::size_t w) {
    for (std::size_t k = w; k < episodes && !shared.interrupted(); k += envs.size()) {
      finished[k] = run_episode(*envs[w], *policies[w], derived_seed(seed, k));
      shared.part_done();
    }
  });
  std::vector<EpisodeSummary> summaries;
  summaries.reserve(episodes);
  for (std::optional<EpisodeSummary>& one : finished) {
    if (one) summaries.push_back(std::move(*one));
  }
  return summaries;
}

std::size_t Evaluation::ended_early() const noexcept {
  std::size_t sum = 0;
  for (const OutcomeRow& row : outcome_rows()) sum += ends_early(row.outcome) ? count(row.outcome) : 0;
  return sum;
}

Evaluation sum_up(const std::vector<EpisodeSummary>& episodes) {
  Evaluation all;
  all.episodes = episodes.size();
  if (episodes.empty()) return all;
  std::vector<double> rewards;
  std::vector<const MotionSummary*> motions;
  for (const EpisodeSummary& e : episodes) {
    rewards.push_back(e.total_reward);
    motions.push_back(&e.motion);
  }
  all.total_reward = mean_and_deviation(rewards);
  all.motion = MotionAverages(motions);
  for (const OwnRewardTerm& term : episodes.front().own_reward_terms)
    all.own_reward_terms.push_back({term.name, 0});
  for (const EpisodeSummary& e : episodes) {
    for (std::size_t i = 0; i < all.reward_terms.size(); ++i)
      all.reward_terms[i] += e.reward_terms[i] / static_cast<double>(episodes.size());
    for (std::size_t i = 0; i < all.own_reward_terms.size(); ++i)
      all.own_reward_terms[i].sum += e.own_reward_terms[i].sum / static_cast<double>(episodes.size());
    all.simulated_seconds += e.motion.simulated_seconds;
    all.steps += e.steps;
    all.invalid_actions += e.invalid_actions;
    all.clipped_actions.add(e.clipped_actions);
    ++all.outcomes[static_cast<std::size_t>(e.motion.outcome)];
  }
  return all;
}

}  // namespace crossgait
