#include "env/vector_env.h"

#include <algorithm>
#include <string>

#include "physics/core/check_size.h"
#include "physics/engine/world_group.h"

namespace crossgait {
namespace {

constexpr std::string_view kVectorEnv = "vector environment";

std::size_t checked(std::string_view what, std::size_t count, std::size_t most) {
  if (count > most)
    throw ConfigError(kVectorEnv, what, "at most " + std::to_string(most), std::to_string(count));
  if (count == 0) throw ConfigError(kVectorEnv, what, "at least 1", "0");
  return count;
}

}  // namespace

VectorEnv::VectorEnv(const EnvConfig& config, const Engine& engine, const VectorEnvOptions& options)
    : auto_reset_(options.auto_reset),
      environments_(checked("environments", options.environments, kMaxEnvironments)),
      slots_(options.environments),
      pool_(checked("workers", options.workers, kMaxWorkers)) {
  const auto model = EnvModel::make(config);
  // With fewer environments than threads there is nothing to share.
  const auto group = size() > workers() ? std::make_shared<WorldGroup>(workers()) : nullptr;
  constexpr std::size_t kAtOnce = 64;  // between which `progress` is told: some tens of milliseconds
  for (std::size_t begin = 0; begin < size(); begin += kAtOnce) {
    if (options.progress) options.progress(static_cast<double>(begin) / static_cast<double>(size()));
    pool_.run(std::min(kAtOnce, size() - begin), [&](std::size_t i) {
      environments_[begin + i] = std::make_unique<QuadrupedEnv>(model, engine, group);
    });
  }
}

void VectorEnv::begin_episode(std::size_t i, std::span<double> observation) {
  Slot& slot = slots_[i];
  environments_[i]->reset(slot.episode_seed(slot.episode), observation);
  ++slot.episode;
  ++slot.episodes;
  slot.ended = false;
}

void VectorEnv::begin_anew(std::size_t i, std::uint64_t seed, bool is_first_seed,
                           std::span<double> observations) {
  Slot& slot = slots_[i];
  slot.seed = seed;
  slot.is_first_seed = is_first_seed;
  slot.episode = 0;
  begin_episode(i, row(observations, i));
}

void VectorEnv::reset(std::uint64_t seed, std::span<double> observations) {
  check_size(kVectorEnv, "observations", observations.size(), size() * observation_size());
  ++revision_;
  pool_.run(size(), [&](std::size_t i) { begin_anew(i, derived_seed(seed, i), false, observations); });
}

void VectorEnv::reset(std::span<const std::uint64_t> seeds, std::span<double> observations) {
  check_size(kVectorEnv, "seeds", seeds.size(), size());
  check_size(kVectorEnv, "observations", observations.size(), size() * observation_size());
  ++revision_;
  pool_.run(size(), [&](std::size_t i) { begin_anew(i, seeds[i], true, observations); });
}

template <typename Begin>
void VectorEnv::begin_some(std::span<const std::uint8_t> which, std::span<double> observations,
                           const Begin& begin) {
  check_size(kVectorEnv, "which", which.size(), size());
  check_size(kVectorEnv, "observations", observations.size(), size() * observation_size());
  if (slots_.front().episode == 0) throw ConfigError(kVectorEnv, "reset_some", "a reset before it", "none");
  ++revision_;
  pool_.run(size(), [&](std::size_t i) {
    if (which[i] != 0) begin(i);
  });
}

void VectorEnv::reset_some(std::span<const std::uint8_t> which, std::span<double> observations) {
  begin_some(which, observations, [&](std::size_t i) { begin_episode(i, row(observations, i)); });
}

void VectorEnv::reset_some(std::span<const std::uint8_t> which, std::uint64_t seed,
                           std::span<double> observations) {
  begin_some(which, observations,
             [&](std::size_t i) { begin_anew(i, derived_seed(seed, i), false, observations); });
}

void VectorEnv::reset_some(std::span<const std::uint8_t> which, std::span<const std::uint64_t> seeds,
                           std::span<double> observations) {
  check_size(kVectorEnv, "seeds", seeds.size(), size());
  begin_some(which, observations, [&](std::size_t i) { begin_anew(i, seeds[i], true, observations); });
}

void VectorEnv::end_episode(std::size_t i, bool terminated) { edit(i).end_episode(terminated); }

void VectorEnv::restore(std::size_t i, const QuadrupedEnv::Saved& saved) {
  edit(i).restore(saved);
  slots_[i].ended = environments_[i]->result().done();
}

void VectorEnv::step(std::span<const double> actions, const VectorStep& out) {
  check_size(kVectorEnv, "actions", actions.size(), size() * action_size());
  check_size(kVectorEnv, "observations", out.observations.size(), size() * observation_size());
  check_size(kVectorEnv, "rewards", out.rewards.size(), size());
  check_size(kVectorEnv, "terminated", out.terminated.size(), size());
  check_size(kVectorEnv, "truncated", out.truncated.size(), size());
  if (!out.final_observations.empty())
    check_size(kVectorEnv, "final_observations", out.final_observations.size(), size() * observation_size());
  if (!out.final_infos.empty()) check_size(kVectorEnv, "final_infos", out.final_infos.size(), size());
  ++revision_;
  pool_.run(size(), [&](std::size_t i) { step_one(i, actions, out); });
}

void VectorEnv::step_one(std::size_t i, std::span<const double> actions, const VectorStep& out) {
  Slot& slot = slots_[i];
  const std::span<double> observation = row(out.observations, i);
  if (slot.ended && auto_reset_ == AutoReset::kNextStep) {
    begin_episode(i, observation);
    out.rewards[i] = 0;
    out.terminated[i] = out.truncated[i] = 0;
    return;
  }
  const StepResult result =
      environments_[i]->step(actions.subspan(i * action_size(), action_size()), observation);
  out.rewards[i] = result.reward;
  out.terminated[i] = result.terminated ? 1 : 0;
  out.truncated[i] = result.truncated ? 1 : 0;
  if (!result.done() || slot.ended) return;
  slot.diverged += environments_[i]->info().outcome == Outcome::kDiverged ? 1 : 0;
  slot.ended = true;
  if (auto_reset_ != AutoReset::kSameStep) return;
  if (!out.final_observations.empty())
    std::copy(observation.begin(), observation.end(), row(out.final_observations, i).begin());
  if (!out.final_infos.empty()) out.final_infos[i] = environments_[i]->info();
  begin_episode(i, observation);
}

std::uint64_t VectorEnv::episode_seed(std::size_t i) const {
  const Slot& slot = slots_.at(i);
  if (slot.episode == 0) throw ConfigError(kVectorEnv, "episode_seed", "a reset before it", "none");
  return slot.episode_seed(slot.episode - 1);
}

std::uint64_t VectorEnv::diverged() const noexcept {
  std::uint64_t sum = 0;
  for (const Slot& slot : slots_) sum += slot.diverged;
  return sum;
}

std::uint64_t VectorEnv::episodes() const noexcept {
  std::uint64_t sum = 0;
  for (const Slot& slot : slots_) sum += slot.episodes;
  return sum;
}

}  // namespace crossgait
