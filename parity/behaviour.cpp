#include "parity/behaviour.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "gait/scale.h"
#include "motion/statistic_rows.h"
#include "motion/time_steps.h"
#include "physics/core/find_row.h"

namespace crossgait {
namespace {

// What a margin for the reference robot is worth for this one.
double scale_of(MarginScale scale, const RobotDescription& robot) {
  switch (scale) {
    case MarginScale::kLength:
      return gait_scale(robot).length;
    case MarginScale::kSpeed:
      return gait_scale(robot).time();
    case MarginScale::kFixed:
      break;
  }
  return 1;
}

// Where nothing is planned, what compares with a plan says nothing.
bool is_judged(const StatisticJudged& judged, bool planned) { return planned || !judged.needs_plan; }

// The statistics that every behaviour is judged by; `values_of` in the same order.
// @param planned  there is a plan of swing and stance to compare with
std::vector<Statistic> motion_statistics(const RobotDescription& robot, bool planned) {
  std::vector<Statistic> all;
  for (const StatisticRow* row : judged_statistics()) {
    const StatisticJudged& judged = row->judged;
    if (!is_judged(judged, planned)) continue;
    const Margin margin{judged.relative_margin, judged.absolute_margin * scale_of(judged.scale, robot),
                        judged.per_second, std::string(judged.reason)};
    all.push_back({std::string(row->key), std::string(judged.name), std::string(row->unit), margin});
  }
  return all;
}

BehaviourRun run_of(const MotionSummary& m, bool planned) {
  BehaviourRun run{{}, m.outcome, m.simulated_seconds};
  for (const StatisticRow* row : judged_statistics()) {
    if (is_judged(row->judged, planned)) run.values.push_back(number_of(*row, m));
  }
  return run;
}

// How many steps of `dt` fit into a time that may be without end.
std::int64_t steps_in(double horizon, double dt) {
  const double steps = std::floor(horizon / dt + kStepRounding);
  return steps < 9e18 ? std::max<std::int64_t>(1, static_cast<std::int64_t>(steps))
                      : std::numeric_limits<std::int64_t>::max();
}

std::vector<double> delays_of(const RobotDescription& robot) {
  std::vector<double> delays;
  for (const int i : robot.actuated_joints()) {
    if (robot.joint(i).delay > 0) delays.push_back(robot.joint(i).delay);
  }
  return delays;
}

Start draw_start(const Randomisation& randomisation, std::uint64_t seed) {
  Random random(seed);
  const RandomDraw draw = crossgait::draw(randomisation, random);
  return {placement_of(draw), 0, pushes_of(randomisation, draw, random)};
}

// @param horizon  s of motion, at most
// @param sink     takes every control step if not null
MotionSummary walk_once(const WorldSpec& world, const WalkSetup& setup, const Start& start,
                        const Engine& engine, double horizon, TraceSink* sink = nullptr) {
  const std::unique_ptr<PhysicsBackend> instance = engine.make(world);
  const WalkObserver observer =
      [sink, left = steps_in(horizon, setup.timing.control_dt)](const WalkSample& sample) mutable {
        if (sink != nullptr) sink->add({sample.world, sample.targets});
        return --left > 0;
      };
  return run_walk(*instance, setup.make_controller(world), setup.timing, observer, start, setup.terminations);
}

// A policy in an environment whose world is varied.
class PolicyRuns {
 public:
  PolicyRuns(LoadedEnv environment, PolicyFactory policy, std::uint64_t seed)
      : environment_(std::move(environment)), policy_(std::move(policy)), seed_(seed) {
    environment_.config.terminations = OutcomeSet::of_episodes();  // whatever it asks for is among them
  }

  EpisodeSummary run(const Engine& engine, const Variation& variation, std::size_t k, double horizon,
                     TraceSink* sink = nullptr) const {
    LoadedEnv varied = environment_;  // what is varied is in no file
    varied.config.physics_dt *= variation.step;
    varied.config.terrain_seed = terrain_seed_of_start(varied.config.terrain_seed, k);
    Variation others = variation;
    others.step = 1;  // the configuration has it already
    const double asked = environment_.config.physics_dt;
    QuadrupedEnv env(varied, with_change(engine, [&](WorldSpec& w) { others.apply(w, asked); }));
    const std::unique_ptr<Policy> own = policy_(env.interface());
    const EpisodeObserver observer =
        [sink, left = steps_in(horizon, varied.config.policy_dt)](const QuadrupedEnv& e) mutable {
          if (sink != nullptr) sink->add({e.world(), e.targets()});
          return --left > 0;
        };
    return run_episode(env, *own, derived_seed(seed_, k), observer);
  }

 private:
  LoadedEnv environment_;
  PolicyFactory policy_;
  std::uint64_t seed_;
};

}  // namespace

std::uint64_t terrain_seed_of_start(std::uint64_t terrain_seed, std::size_t k) noexcept {
  constexpr std::uint64_t kGrounds = 0x67726f756e64;  // "ground": none of an episode's streams
  return derived_seed(derived_seed(terrain_seed, k), kGrounds);
}

std::vector<std::string> keys_of(const Behaviour& behaviour) {
  std::vector<std::string> keys;
  for (const Statistic& s : behaviour.statistics) keys.push_back(s.key);
  return keys;
}

Behaviour with_margins(Behaviour behaviour, const Margins& margins) {
  for (const auto& [key, margin] : margins) {
    const Statistic& known = find_row(behaviour.statistics, key, "verdict", "margin", &Statistic::key);
    behaviour.statistics[static_cast<std::size_t>(&known - behaviour.statistics.data())].margin = margin;
  }
  return behaviour;
}

std::string Behaviour::why_not(const Variation& variation) const {
  const double step = physics_dt * variation.step;
  const bool whole =
      is_whole_multiple(control_dt, step) &&
      std::all_of(delays.begin(), delays.end(), [step](double d) { return is_whole_multiple(d, step); });
  if (!whole) return "the control step would not be a whole number of steps";
  const double simulated = time_constant_in_steps(contact.softness.time_constant, physics_dt),
               softened = simulated * variation.softness;
  if (variation.softness < 1 && time_constant_in_steps(softened, physics_dt) > (1 + 1e-9) * softened)
    return "contacts are as stiff as the step lets them be";
  if (variation.erp > 1 && contact.erp == 0) return "no penetration is undone";
  if (variation.erp * contact.erp > 1) return "a step undoes more than half of a penetration";
  return "";
}

StartRanges StartRanges::with_defaults(const RobotDescription& robot) const {
  const GaitScale scale = gait_scale(robot);
  StartRanges all = *this;
  all.position_m = position_m.value_or(0.1 * scale.length);
  all.push_mps = push_mps.value_or(0.02 * scale.time());
  return all;
}

Randomisation StartRanges::over(Randomisation base, const RobotDescription& robot) const {
  using enum Randomised;
  const auto fill = [&base](Randomised what, double low, double high) {
    if (!base.is_on(what)) base[what] = {low, high};
  };
  const StartRanges own = with_defaults(robot);
  const double position = *own.position_m, push = *own.push_mps;
  fill(kStartX, -position, position);
  fill(kStartY, -position, position);
  fill(kStartYaw, -heading_rad, heading_rad);
  fill(kStartRoll, -tilt_rad, tilt_rad);
  fill(kStartPitch, -tilt_rad, tilt_rad);
  if (push > 0 && !base.is_on(kPushImpulse)) {
    const double impulse = push * robot.total_mass();
    base[kPushImpulse] = {impulse, impulse};
    base[kPushInterval] = {0, 1};
    base[kPushCount] = {1, 1};
  }
  return base;
}

Behaviour walk_behaviour(const WorldSpec& world, const WalkSetup& setup, const TerrainOfStart& terrain,
                         const StartRanges& ranges, std::uint64_t seed) {
  Behaviour behaviour;
  behaviour.name = fmt::format("{} on {}, {:g} s", setup.gait, world.terrain.name(), setup.timing.seconds);
  behaviour.statistics = motion_statistics(*world.robot, true);
  behaviour.physics_dt = world.physics_dt;
  behaviour.contact = world.contact;
  behaviour.control_dt = setup.timing.control_dt;
  behaviour.delays = delays_of(*world.robot);
  const Randomisation starts = ranges.over({}, *world.robot);
  behaviour.seconds = setup.timing.seconds;
  behaviour.cut_dt = setup.timing.control_dt;
  WalkSetup until_failure = setup;
  until_failure.terminations = OutcomeSet::of_episodes();  // whatever it asks for is among them
  behaviour.run = [world, setup = until_failure, terrain, starts, seed](
                      const Engine& engine, const Variation& variation, std::size_t k, double horizon) {
    WorldSpec varied = world;
    varied.terrain = terrain(k);
    variation.apply(varied, world.physics_dt);
    return run_of(walk_once(varied, setup, draw_start(starts, derived_seed(seed, k)), engine, horizon), true);
  };
  behaviour.trace = [world, setup, terrain, starts, seed](const Engine& engine, std::size_t k) {
    WorldSpec own = world;
    own.terrain = terrain(k);
    WalkSetup at_once = setup;
    at_once.timing.settle_seconds = 0;
    TraceRecorder recorder;
    walk_once(own, at_once, draw_start(starts, derived_seed(seed, k)), engine, kToTheEnd, &recorder);
    return recorder.take();
  };
  return behaviour;
}

Behaviour policy_behaviour(LoadedEnv environment, PolicyFactory policy, const std::string& name,
                           const StartRanges& ranges, std::uint64_t seed) {
  const WorldSpec world = EnvModel::make(environment)->world;
  const std::shared_ptr<const RobotDescription>& robot = world.robot;
  EnvConfig& config = environment.config;
  const bool planned = config.action == ActionKind::kGait;
  config.randomisation = ranges.over(config.randomisation, *robot);
  Behaviour behaviour;
  behaviour.name = fmt::format("policy {} on {}, {:g} s", name, config.terrain, config.episode_seconds);
  behaviour.statistics = motion_statistics(*robot, planned);
  const Margin reward{0.02, 0.002, true, "a fiftieth of the reward"};
  behaviour.statistics.push_back({"total_reward", "total reward", "-", reward});
  behaviour.seconds = config.episode_seconds;
  behaviour.cut_dt = config.policy_dt;
  behaviour.physics_dt = config.physics_dt;
  behaviour.contact = world.contact;
  behaviour.control_dt = config.control_dt;
  behaviour.delays = delays_of(*robot);
  const PolicyRuns runs(environment, std::move(policy), seed);
  behaviour.run = [runs, planned](const Engine& engine, const Variation& variation, std::size_t k,
                                  double horizon) {
    const EpisodeSummary episode = runs.run(engine, variation, k, horizon);
    BehaviourRun run = run_of(episode.motion, planned);
    run.values.emplace_back(episode.total_reward);
    return run;
  };
  behaviour.notes = [runs, name](const Engine& engine) {
    const EpisodeSummary first = runs.run(engine, nominal_variation(), 0, kToTheEnd);
    const std::string note = note_on_clipping(name, first.clipped_actions);
    return note.empty() ? std::vector<std::string>() : std::vector{note};
  };
  behaviour.trace = [runs](const Engine& engine, std::size_t k) {
    TraceRecorder recorder;
    runs.run(engine, nominal_variation(), k, kToTheEnd, &recorder);
    return recorder.take();
  };
  return behaviour;
}

}  // namespace crossgait
