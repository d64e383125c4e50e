// How well a policy does what it is asked, as one number: not falls alone, since half of all wrong interfaces
// never make a robot fall.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "env/loaded_env.h"
#include "policy/relabelled_policy.h"

namespace crossgait {

/// Sums up one walk: what was asked, and what came of it after the first second, in which the robot sets off.
struct WalkMeasure {
  VelocityCommand asked;
  double speed = 0;           ///< |mean velocity| along the ground, m/s
  double speed_error = 0;     ///< |mean velocity in the heading's frame - asked|, m/s
  double yaw_rate_error = 0;  ///< |mean yaw rate - asked|, rad/s
  double jitter = 0;          ///< mean |second difference of servo targets| over policy_dt^2, rad/s^2
  double effort = 0;          ///< mean power of the servos over weight and reference speed
  double tilt = 0;            ///< root mean square of roll and pitch together, rad
  double lasted = 1;          ///< share of the walk before a fall or another end; 1: all of it
  double upright = 1;  ///< the same before it first leans by more than 0.3 rad, roll and pitch together
  bool fell = false;   ///< it ended before its time
};

/// Returns the environment for one episode of a test: of so long (s, whole policy steps), under one command,
/// ended by failures alone. Nothing is randomised.
EnvConfig test_episode(EnvConfig config, const VelocityCommand& command, double seconds);

/// Names a command to walk by: straight, turning left and right, standing.
struct WalkCommand {
  std::string name;
  VelocityCommand velocity;
};

/// Says what a policy is asked.
struct WalkTest {
  std::vector<WalkCommand> commands;
  std::size_t seeds = 1;  ///< of each command: another heading and a little tilt at the start
  double seconds = 3;     ///< of a walk
  std::size_t first = 0;  ///< the first of the seeds
};

/// Lists commands straight ahead, to both sides and standing, about what `config` asks for.
/// @returns speeds in m/s: its own forward speed (half a metre a second if that is less than a tenth), turns
///          of 0.4 rad/s
std::vector<WalkCommand> walk_commands(const EnvConfig& config);

/// Bounds how far a walk that counts as asked may be from it.
struct WalkTolerance {
  double speed_share = 0.2, speed = 0.05;        ///< of what is asked, and m/s on top of it
  double yaw_rate_share = 0.2, yaw_rate = 0.12;  ///< the same, rad/s on top of it
};

/// Scores a walk, 0 for what was asked to the letter without effort. The sum of
///   speed error over the larger of the command and 0.3 m/s, at most 1,
///   yaw rate error over the larger of the command and 0.4 rad/s, at most 1,
///   0.3 jitter over 500 rad/s^2, 0.2 effort over 3 and 0.3 tilt over 0.2 rad, each at most 1,
/// for a walk that lasts, and for one that does not 3 plus the share of its time that was left: half of that
/// after its end, half of that after it first leaned.
double walk_score(const WalkMeasure& walk) noexcept;

/// Holds the walks of one configuration.
struct WalkResult {
  std::vector<WalkMeasure> walks;  ///< command by command, seed by seed
  std::vector<double> scores;      ///< of the same

  double mean() const noexcept;  ///< of the scores
  /// Averages over commands, seed by seed.
  std::vector<double> by_seed(std::size_t seeds) const;
  std::size_t falls() const noexcept;
};

/// Sums up what came of one command, over its seeds.
struct CommandResult {
  VelocityCommand asked;
  std::size_t falls = 0;
  double speed_error = 0, yaw_rate_error = 0;  ///< means: m/s, rad/s
  double score = 0;                            ///< the same
  std::size_t worst = 0;                       ///< the seed with the highest score
  bool done = false;                           ///< no walk fell, and the means are within the tolerance
};
/// Sums up the walks of `result`, command by command.
std::vector<CommandResult> by_command(const WalkResult& result, std::size_t seeds,
                                      const WalkTolerance& tolerance = {});

/// Tells if every command was done: no walk fell, and the mean of the seeds of each is within the tolerance.
bool does_what_is_asked(const WalkResult& result, std::size_t seeds, const WalkTolerance& tolerance = {});
/// Says in words what is worst about it: "falls in 3 of 8 walks", "walks straight ahead at 0.2 m/s instead of
/// 0.5".
std::string what_is_wrong(const WalkResult& result, const WalkTest& test,
                          const WalkTolerance& tolerance = {});

/// Makes the environment in which `run_walks` walks a command of `test`. What it randomises is replaced by
/// the test's own starts; walk k is that of derived_seed(seed, test.first + k).
/// @throws ConfigError for a configuration that cannot be
LoadedEnv walk_environment(const LoadedEnv& environment, const WalkTest& test, const WalkCommand& command);

/// Runs every command and seed of `test` in this configuration, in its engine, on the caller's thread.
/// @throws ConfigError for a configuration that cannot be
WalkResult run_walks(const LoadedEnv& environment, const RelabelledPolicy& policy, const WalkTest& test,
                     std::uint64_t seed);

}  // namespace crossgait
