#include "env/env_config.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "motion/time_steps.h"
#include "physics/core/error.h"
#include "physics/engine/world_spec.h"

namespace crossgait {
namespace {

void require(bool ok, std::string_view source, std::string_view element, std::string_view expected,
             double found) {
  if (!ok) throw ConfigError(source, element, expected, fmt::format("{:g}", found));
}

constexpr double kMostSteps = 1e9;  // of one kind inside another: counts are int
// Of one call, which nothing interrupts: some seconds.
constexpr double kMostPhysicsSteps = 1e5;

void require_multiple(std::string_view source, std::string_view element, double longer, double shorter) {
  require(is_whole_multiple(longer, shorter), source, element,
          fmt::format("a whole multiple of {:g} s", shorter), longer);
}

// What is remembered of a delay is one row per control step.
constexpr double kLongestDelay = 1000;  // control steps
constexpr int kLongestHistory = 1000;   // policy steps

void require_delay(std::string_view source, std::string_view element, double delay, double control_dt) {
  require_multiple(source, element, delay, control_dt);
  require(delay / control_dt <= kLongestDelay, source, element,
          fmt::format("at most {:g} control steps of {:g} s", kLongestDelay, control_dt), delay);
}

void validate_gait(const EnvConfig& c, std::string_view source) {
  if (c.residual_scale)
    require(*c.residual_scale >= 0 && *c.residual_scale <= 1, source, "residual_scale",
            "a length in [0, 1] m", *c.residual_scale);
  validate(c.parameters, source);
  c.adaptation.validate(source);
  for (std::size_t i = 0; i < c.adapt.size(); ++i) {
    static_cast<void>(c.adaptation.row(c.adapt[i]));
    if (std::find(c.adapt.begin(), c.adapt.begin() + static_cast<std::ptrdiff_t>(i), c.adapt[i]) !=
        c.adapt.begin() + static_cast<std::ptrdiff_t>(i))
      throw ConfigError(source, "adapt", "every parameter once", fmt::format("{} twice", c.adapt[i]));
  }
  static_cast<void>(find_gait(c.gait));
}

void validate_joints(const EnvConfig& c, std::string_view source) {
  const JointActionSettings& j = c.joints;
  constexpr double kLargestAction = 1e3;
  require(j.limit > 0 && j.limit <= kLargestAction, source, "joints.limit",
          fmt::format("a limit in (0, {:g}]", kLargestAction), j.limit);
  if (j.delay != 0) require_delay(source, "joints.delay", j.delay, c.control_dt);
  require(j.filter > 0 && j.filter <= 1, source, "joints.filter", "a share in (0, 1]", j.filter);
  if (j.commands_torques())
    require(c.control_dt == c.physics_dt, source, "control_dt",
            fmt::format("physics_dt, {:g} s, where servos are made to give torques (joints.command: torque, "
                        "velocity; joints.actuator)",
                        c.physics_dt),
            c.control_dt);
  if (c.randomisation.is_on(Randomised::kStartPhase))
    throw ConfigError(source, "start_phase", "action: gait, whose clock it sets", "action: joints");
}

void validate_term(const EnvConfig& c, const ObservationTerm& term, std::string_view source) {
  const auto check = [&](bool ok, std::string_view what, std::string_view expected, double found) {
    require(ok, source, fmt::format("observation, {} of {}", what, term.block), expected, found);
  };
  const ObservationBlock& block = find_observation_block(term.block);
  if (block.needs_gait && c.action == ActionKind::kJoints)
    throw ConfigError(source, "observation", "blocks that are there with action: joints", term.block);
  for (const double scale : term.scale)
    check(std::isfinite(scale) && scale != 0, "scale", "a finite number but 0", scale);
  check(term.clip > 0, "clip", "a number above 0", term.clip);
  check(term.clip_unscaled > 0, "clip_unscaled", "a number above 0", term.clip_unscaled);
  check(term.noise >= 0 && std::isfinite(term.noise), "noise", "a number of 0 or more", term.noise);
  check(term.history >= 1 && term.history <= kLongestHistory, "history",
        fmt::format("1 to {} policy steps", kLongestHistory), term.history);
  if (term.delay != 0)
    require_delay(source, fmt::format("observation, delay of {}", term.block), term.delay, c.control_dt);
}

bool sees(const EnvConfig& c, std::string_view block) {
  return std::any_of(c.observation.begin(), c.observation.end(),
                     [block](const ObservationTerm& term) { return term.block == block; });
}

// What blocks are made of, and that nothing is said which no block shows.
void validate_settings(const EnvConfig& c, std::string_view source) {
  const ObservationSettings& s = c.observing;
  constexpr std::size_t kMostPoints = 4096;
  const auto check = [&](bool seen, bool said, const char* key, const char* blocks) {
    if (seen && !said) throw ConfigError(source, key, fmt::format("what {} shows", blocks), "nothing");
    if (said && !seen) throw ConfigError(source, key, fmt::format("{} in the observation", blocks), "none");
  };
  check(sees(c, "clock_sin") || sees(c, "clock_cos"), !s.clock.phases.empty(), "clock",
        "clock_sin or clock_cos");
  require(s.clock.phases.empty() || (s.clock.frequency > 0 && s.clock.frequency <= 1e3), source,
          "clock.frequency", "0 to 1e3 Hz, and above 0", s.clock.frequency);
  const std::size_t points = s.height_scan.x.size() * s.height_scan.y.size();
  check(sees(c, "height_scan"), points > 0, "height_scan", "height_scan");
  require(points <= kMostPoints, source, "height_scan", fmt::format("at most {} points", kMostPoints),
          static_cast<double>(points));
  check(sees(c, "constants"), !s.constants.empty(), "constants", "constants");
}

void validate_frames(const EnvConfig& c, std::string_view source) {
  const int history = c.observation.front().history;
  for (const ObservationTerm& term : c.observation) {
    if (term.history != history)
      throw ConfigError(
          source, "history.by", "as many instants of every block, where frames are whole",
          fmt::format("{} of {}, {} of {}", history, c.observation.front().block, term.history, term.block));
  }
  require(history > 1, source, "history.by", "blocks with a history of 2 or more", history);
}

void validate_observation(const EnvConfig& c, std::string_view source) {
  if (c.observation.empty()) throw ConfigError(source, "observation", "at least one block", "none");
  for (std::size_t i = 0; i < c.observation.size(); ++i) {
    const ObservationTerm& term = c.observation[i];
    validate_term(c, term, source);
    for (std::size_t j = 0; j < i; ++j) {
      if (term.block == c.observation[j].block && term.delay == c.observation[j].delay)
        throw ConfigError(source, "observation", "every block once", fmt::format("{} twice", term.block));
    }
  }
  validate_settings(c, source);
  if (c.observing.history.by == HistorySettings::By::kFrame) validate_frames(c, source);
}

}  // namespace

std::string_view name(ActionKind kind) noexcept { return kind == ActionKind::kJoints ? "joints" : "gait"; }

void EnvConfig::validate(std::string_view origin) const {
  require(physics_dt >= kShortestPhysicsStep && physics_dt <= kLongestPhysicsStep, origin, "physics_dt",
          fmt::format("a time step in [{:g}, {:g}] s", kShortestPhysicsStep, kLongestPhysicsStep),
          physics_dt);
  require_multiple(origin, "control_dt", control_dt, physics_dt);
  require(policy_dt / physics_dt <= kMostPhysicsSteps, origin, "policy_dt",
          fmt::format("at most {:g} physics steps", kMostPhysicsSteps), policy_dt);
  require_multiple(origin, "policy_dt", policy_dt, control_dt);
  require(episode_seconds >= policy_dt && episode_seconds <= 1e6, origin, "episode_seconds",
          "at least one policy step and at most 1e6 s", episode_seconds);
  require(settle_seconds >= 0 && settle_seconds <= 1e3, origin, "settle_seconds", "0 to 1e3 s",
          settle_seconds);
  require(settle_seconds / physics_dt <= kMostPhysicsSteps, origin, "settle_seconds",
          fmt::format("at most {:g} physics steps", kMostPhysicsSteps), settle_seconds);
  require(tilt_limit_deg > 0 && tilt_limit_deg <= 180, origin, "tilt_limit_deg",
          "an angle in (0, 180] degrees", tilt_limit_deg);
  require(episode_seconds / policy_dt <= kMostSteps, origin, "episode_seconds",
          fmt::format("at most {:g} policy steps", kMostSteps), episode_seconds);
  require(episode_seconds / physics_dt < std::numeric_limits<int>::max(), origin, "physics_dt",
          "a time step of which fewer than 2^31 make an episode", physics_dt);
  if (action == ActionKind::kGait) {
    validate_gait(*this, origin);
  } else {
    validate_joints(*this, origin);
  }
  if (command && !command->is_finite())
    throw ConfigError(origin, "command", "finite velocities", "values that are not");
  validate_observation(*this, origin);
  for (std::size_t i = 0; i < reward.size(); ++i)
    require(std::isfinite(reward[i]), origin, reward_terms()[i].name, "a finite weight", reward[i]);
  randomisation.validate();
  start.validate(origin);
  const bool stands = start == StartSettings() && !randomises_start(randomisation);
  require(stands || settle_seconds == 0, origin, "settle_seconds",
          "0 s where an episode begins otherwise than standing (start), which settling would end",
          settle_seconds);
}

EnvConfig guide_environment() {
  EnvConfig config;
  config.gait = "trot:guide";
  config.adaptation = guide_ranges();
  return config;
}

EnvConfig joint_environment() {
  EnvConfig config;
  config.action = ActionKind::kJoints;
  config.observation = joint_policy_observation();
  config.command = VelocityCommand{0.3, 0, 0};
  config.policy_dt = 0.02;
  config.reward.fill(0);
  for (const auto& [term, weight] : {std::pair{"velocity_tracking", 1.0},
                                     {"yaw_rate_tracking", 0.3},
                                     {"flat_orientation_l2", -2.0},
                                     {"action_rate_l2", -0.01},
                                     {"foot_slip", -1.0},
                                     {"termination", -10.0}})
    config.reward[find_reward_term(term)] = weight;
  return config;
}

void EnvConfig::fail_at_its_place(const std::string& value, const ConfigError& error) const {
  for (const Place& place : places) {
    if (place.value != value) continue;
    throw ConfigError(place.source, fmt::format("{}: {}: {}", place.element, error.source(), error.element()),
                      error.expected(), error.found());
  }
  throw error;
}

}  // namespace crossgait
