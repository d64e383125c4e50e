#include "crossgait/env/evaluation.h"

#include <cmath>
#include <mutex>

#include "crossgait/env/worker_pool.h"
#include "crossgait/physics/error.h"

namespace crossgait {
namespace {

constexpr double kDegrees = 180 / M_PI;
constexpr double kMovedDistance = 1e-3;  // m, below which a cost per distance means nothing

// Two streams of random numbers from one seed: the world's and the policy's.
constexpr std::uint64_t kPolicyStream = 0x706f6c696379;  // "policy"

void check_interface(const Policy& policy, const AdaptiveGaitEnv& env) {
  const PolicyInterface &a = policy.interface(), &b = env.interface();
  const std::string difference = layout_difference(b.observation.names(), a.observation.names()) +
                                 layout_difference(b.action.names(), a.action.names());
  if (!difference.empty())
    throw ConfigError(policy.name(), "layout", "a policy for this environment", difference);
}

Evaluation::Spread spread(const std::vector<EpisodeSummary>& episodes, double EpisodeSummary::*member) {
  const auto n = static_cast<double>(episodes.size());
  double sum = 0, squares = 0;
  for (const EpisodeSummary& e : episodes) sum += e.*member;
  const double mean = sum / n;
  for (const EpisodeSummary& e : episodes) squares += (e.*member - mean) * (e.*member - mean);
  return {mean, n > 1 ? std::sqrt(squares / (n - 1)) : 0};
}

}  // namespace

EpisodeSummary run_episode(AdaptiveGaitEnv& env, Policy& policy, std::uint64_t seed,
                           const EpisodeObserver& observer) {
  check_interface(policy, env);
  EpisodeSummary s;
  s.seed = seed;
  std::vector<double> observation(env.observation_size()), action(env.action_size());
  env.reset(seed, observation);
  policy.reset(derived_seed(seed, kPolicyStream));
  const double dt = env.config().policy_dt;
  double roll2 = 0, pitch2 = 0, work = 0, path = 0;
  Vector3 last = env.backend().state().p_WB;
  StepResult result;
  while (!result.done()) {
    policy.act(observation, action);
    result = env.step(action, observation);
    const StepInfo& info = env.info();
    ++s.steps;
    s.total_reward += result.reward;
    for (std::size_t i = 0; i < s.reward_terms.size(); ++i) s.reward_terms[i] += info.reward_terms[i];
    roll2 += info.roll_pitch_yaw.x() * info.roll_pitch_yaw.x();
    pitch2 += info.roll_pitch_yaw.y() * info.roll_pitch_yaw.y();
    work += info.power * dt;
    const Vector3& p = env.backend().state().p_WB;
    path += (p - last).head<2>().norm();
    last = p;
    for (const FootContact& foot : info.contacts) s.slip_m += foot.touching ? foot.slip_speed * dt : 0;
    s.ik_clamped += info.ik_clamped;
    s.invalid_actions += info.invalid_actions;
    if (observer && !observer(env)) break;
  }
  const StepInfo& info = env.info();
  const auto n = static_cast<double>(s.steps);
  s.simulated_seconds = n * dt;
  s.distance_m = info.distance;
  s.lateral_m = info.lateral;
  s.mean_speed_mps = s.distance_m / s.simulated_seconds;
  s.rms_roll_deg = std::sqrt(roll2 / n) * kDegrees;
  s.rms_pitch_deg = std::sqrt(pitch2 / n) * kDegrees;
  const WorldSpec& world = env.backend().spec();
  if (path > kMovedDistance)
    s.cost_of_transport = work / (world.robot->total_mass() * world.gravity.norm() * path);
  s.fell = info.fell;
  s.left_terrain = info.left_terrain;
  s.diverged = info.diverged;
  s.parameters = info.parameters;
  return s;
}

std::vector<EpisodeSummary> evaluate_policy(const EnvFactory& make_env, const PolicyFactory& make_policy,
                                            std::size_t episodes, std::uint64_t seed, std::size_t workers,
                                            const std::function<void(double)>& progress) {
  std::vector<std::unique_ptr<AdaptiveGaitEnv>> envs;
  std::vector<std::unique_ptr<Policy>> policies;
  for (std::size_t w = 0; w < std::max<std::size_t>(1, std::min(workers, episodes)); ++w) {
    envs.push_back(make_env());
    policies.push_back(make_policy(envs.back()->interface()));
  }
  std::vector<EpisodeSummary> summaries(episodes);
  std::mutex progress_mutex;
  std::size_t done = 0;
  WorkerPool pool(envs.size());
  pool.run(envs.size(), [&](std::size_t w) {
    for (std::size_t k = w; k < episodes; k += envs.size()) {
      summaries[k] = run_episode(*envs[w], *policies[w], derived_seed(seed, k));
      const std::scoped_lock lock(progress_mutex);
      ++done;
      if (progress) progress(static_cast<double>(done) / static_cast<double>(episodes));
    }
  });
  return summaries;
}

Evaluation sum_up(const std::vector<EpisodeSummary>& episodes) {
  Evaluation all;
  all.episodes = episodes.size();
  if (episodes.empty()) return all;
  all.total_reward = spread(episodes, &EpisodeSummary::total_reward);
  all.speed = spread(episodes, &EpisodeSummary::mean_speed_mps);
  all.distance = spread(episodes, &EpisodeSummary::distance_m);
  all.rms_roll_deg = spread(episodes, &EpisodeSummary::rms_roll_deg).mean;
  all.rms_pitch_deg = spread(episodes, &EpisodeSummary::rms_pitch_deg).mean;
  all.slip_m = spread(episodes, &EpisodeSummary::slip_m).mean;
  all.cost_of_transport = spread(episodes, &EpisodeSummary::cost_of_transport).mean;
  for (const EpisodeSummary& e : episodes) {
    for (std::size_t i = 0; i < all.reward_terms.size(); ++i)
      all.reward_terms[i] += e.reward_terms[i] / static_cast<double>(episodes.size());
    all.simulated_seconds += e.simulated_seconds;
    all.steps += e.steps;
    all.ik_clamped += e.ik_clamped;
    all.invalid_actions += e.invalid_actions;
    all.falls += e.fell ? 1 : 0;
    all.diverged += e.diverged ? 1 : 0;
    all.left_terrain += e.left_terrain ? 1 : 0;
  }
  return all;
}

}  // namespace crossgait
