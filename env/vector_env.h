// Many environments stepped at once, on several threads, into the caller's arrays.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "env/quadruped_env.h"
#include "physics/core/progress.h"
#include "physics/core/worker_pool.h"

namespace crossgait {

/// Says what happens when an episode ends; Gymnasium's AutoresetMode.
enum class AutoReset {
  kNextStep,  ///< the step after it ignores its action, resets and returns the first observation, reward 0
  kSameStep,  ///< the step that ends it returns the next episode's first observation; the last one of the
              ///< ended episode is in `final_observations`
  kDisabled,  ///< nothing: an episode that has ended stays as it is until `reset_some`
};

struct VectorEnvOptions {
  std::size_t environments = 1;
  std::size_t workers = 1;  ///< threads, the caller's included
  AutoReset auto_reset = AutoReset::kNextStep;
  Progress progress = {};  ///< of making them; called by the caller's thread
};

/// Largest number of environments at once.
inline constexpr std::size_t kMaxEnvironments = 100'000;

/// Holds the caller's arrays, row-major with one row per environment. A caller may keep them between steps.
struct VectorStep {
  std::span<double> observations;  ///< environments x observation_size
  std::span<double> rewards;       ///< environments
  /// environments; 0 or 1
  std::span<std::uint8_t> terminated, truncated;
  /// environments x observation_size, or empty; rows of environments whose episode ended in this step under
  /// kSameStep, others untouched
  std::span<double> final_observations = {};
  /// environments, or empty; what the step that ended the episode did, where `final_observations` has a row
  std::span<StepInfo> final_infos = {};
};

/// Runs N environments of one configuration. Results are the same bit for bit for any number of workers:
/// environment i draws from derived_seed(seed, i), its k-th episode from derived_seed of that and k.
class VectorEnv {
 public:
  /// @throws ConfigError for a bad configuration, no workers, no environments or more than kMaxEnvironments;
  /// and what `progress` throws
  VectorEnv(const EnvConfig& config, const Engine& engine, const VectorEnvOptions& options);

  std::size_t size() const noexcept { return environments_.size(); }
  std::size_t workers() const noexcept { return pool_.workers(); }
  std::size_t observation_size() const noexcept { return environments_.front()->observation_size(); }
  std::size_t action_size() const noexcept { return environments_.front()->action_size(); }
  const QuadrupedEnv& environment(std::size_t i) const { return *environments_.at(i); }
  /// Returns an environment to be changed between steps: its state, command, world. Not to be reset, restored
  /// or ended but by the functions below, which this has to know of.
  QuadrupedEnv& edit(std::size_t i) {
    ++revision_;
    return *environments_.at(i);
  }
  /// Grows whenever something may have changed.
  const std::uint64_t& revision() const noexcept { return revision_; }
  /// Returns the seed of the environment's episode: what `QuadrupedEnv::reset` takes to repeat it.
  /// @throws ConfigError before the first `reset`
  std::uint64_t episode_seed(std::size_t i) const;

  /// Begins an episode everywhere. @throws ConfigError for a wrong size or an impossible draw
  void reset(std::uint64_t seed, std::span<double> observations);
  /// Begins an episode everywhere, that of environment i as QuadrupedEnv::reset(seeds[i]) does; its k-th,
  /// from 0, draws from derived_seed of that and k where k > 0.
  void reset(std::span<const std::uint64_t> seeds, std::span<double> observations);

  /// Begins the next episode of those that `which` has a 1 for; other rows of `observations` stay as they
  /// are.
  /// @throws ConfigError as `reset` does, and before the first
  void reset_some(std::span<const std::uint8_t> which, std::span<double> observations);
  /// Begins an episode of those as `reset` of the same seed, or seeds, does; others' seeds are not looked at.
  void reset_some(std::span<const std::uint8_t> which, std::uint64_t seed, std::span<double> observations);
  void reset_some(std::span<const std::uint8_t> which, std::span<const std::uint64_t> seeds,
                  std::span<double> observations);

  /// Ends an episode between two steps, as QuadrupedEnv::end_episode does: the next step says so, without a
  /// reward, and begins another one as after any end.
  void end_episode(std::size_t i, bool terminated);
  /// Continues one environment where `saved` was; its next episodes are those that they were.
  /// @throws ConfigError as QuadrupedEnv::restore does
  void restore(std::size_t i, const QuadrupedEnv::Saved& saved);

  /// Makes one policy step in every environment. @param actions  environments x action_size
  /// @throws ConfigError for a wrong size (before anything changes), or if a reset makes an impossible draw
  void step(std::span<const double> actions, const VectorStep& out);

  /// Asks one environment for another velocity, until its episode ends. @throws ConfigError if it is not
  /// finite
  void set_command(std::size_t i, const VelocityCommand& command) { edit(i).set_command(command); }

  /// Counts episodes ended because the engine diverged. Each began anew like any other.
  std::uint64_t diverged() const noexcept;
  /// Counts episodes begun so far, those of `reset` included.
  std::uint64_t episodes() const noexcept;

 private:
  struct Slot {
    std::uint64_t seed = 0, episode = 0, episodes = 0, diverged = 0;
    bool is_first_seed = false;  // `seed` is that of episode 0 itself
    bool ended = false;

    std::uint64_t episode_seed(std::uint64_t of) const noexcept {
      return is_first_seed && of == 0 ? seed : derived_seed(seed, of);
    }
  };
  void begin_anew(std::size_t i, std::uint64_t seed, bool is_first_seed, std::span<double> observations);
  template <typename Begin>
  void begin_some(std::span<const std::uint8_t> which, std::span<double> observations, const Begin& begin);
  void begin_episode(std::size_t i, std::span<double> observation);
  void step_one(std::size_t i, std::span<const double> actions, const VectorStep& out);
  std::span<double> row(std::span<double> matrix, std::size_t i) const noexcept {
    return matrix.subspan(i * observation_size(), observation_size());
  }

  AutoReset auto_reset_;
  std::uint64_t revision_ = 0;
  std::vector<std::unique_ptr<QuadrupedEnv>> environments_;
  std::vector<Slot> slots_;
  WorkerPool pool_;
};

}  // namespace crossgait
