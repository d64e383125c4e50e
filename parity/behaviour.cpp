#include "parity/behaviour.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "gait/scale.h"
#include "motion/statistic_rows.h"
#include "motion/time_steps.h"

namespace crossgait {
namespace {

// What a floor for the reference robot is worth for this one.
double scale_of(FloorScale scale, const RobotDescription& robot) {
  switch (scale) {
    case FloorScale::kLength:
      return gait_scale(robot).length;
    case FloorScale::kSpeed:
      return gait_scale(robot).time();
    case FloorScale::kFixed:
      break;
  }
  return 1;
}

// Where nothing is planned, what compares with a plan says nothing.
bool is_judged(const StatisticJudged& judged, bool planned) { return planned || !judged.needs_plan; }

// The statistics that every behaviour is judged by, and whether it failed; `values_of` in the same order.
// @param planned  there is a plan of swing and stance to compare with
std::vector<Statistic> motion_statistics(const RobotDescription& robot, bool planned) {
  std::vector<Statistic> all;
  for (const StatisticRow* row : judged_statistics()) {
    const StatisticJudged& judged = row->judged;
    if (!is_judged(judged, planned)) continue;
    all.push_back({std::string(judged.name), std::string(row->unit), judged.relative_floor,
                   judged.absolute_floor * scale_of(judged.scale, robot)});
  }
  all.push_back({"failures", "fraction", 0, 0.05, true});
  return all;
}

// A robot that went nowhere has no cost of transport; it differs from one that did in distance already. So
// with the others that may be missing.
std::vector<double> values_of(const MotionSummary& m, bool planned) {
  std::vector<double> all;
  for (const StatisticRow* row : judged_statistics()) {
    if (is_judged(row->judged, planned)) all.push_back(number_of(*row, m).value_or(0));
  }
  all.push_back(m.failed() ? 1.0 : 0.0);
  return all;
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

MotionSummary walk_once(const WorldSpec& world, const WalkSetup& setup, const Start& start,
                        const Engine& engine, TraceSink* sink = nullptr) {
  return record_walk(*engine.make(world), setup, {}, sink, start).summary;
}

}  // namespace

void Variation::apply(WorldSpec& world) const {
  world.physics_dt *= step;
  world.solver.tolerance *= tolerance;
  world.solver.iterations = std::max(1, static_cast<int>(std::lround(world.solver.iterations * iterations)));
}

const std::vector<Variation>& variations() {
  using enum Variation::Kind;
  static const std::vector<Variation> kVariations{{"as asked", kNominal, 1, 1, 1},
                                                  {"half the time step", kTimeStep, 0.5, 1, 1},
                                                  {"twice the time step", kTimeStep, 2, 1, 1},
                                                  {"loose solver", kSolver, 1, 100, 0.5},
                                                  {"tight solver", kSolver, 1, 0.01, 2}};
  return kVariations;
}

bool Behaviour::allows(const Variation& variation) const {
  const double step = physics_dt * variation.step;
  return is_whole_multiple(control_dt, step) &&
         std::all_of(delays.begin(), delays.end(), [step](double d) { return is_whole_multiple(d, step); });
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
  behaviour.control_dt = setup.timing.control_dt;
  behaviour.delays = delays_of(*world.robot);
  const Randomisation starts = ranges.over({}, *world.robot);
  behaviour.run = [world, setup, terrain, starts, seed](const Engine& engine, const Variation& variation,
                                                        std::size_t k) {
    WorldSpec varied = world;
    varied.terrain = terrain(k);
    variation.apply(varied);
    return values_of(walk_once(varied, setup, draw_start(starts, derived_seed(seed, k)), engine), true);
  };
  behaviour.trace = [world, setup, terrain, starts, seed](const Engine& engine, std::size_t k) {
    WorldSpec own = world;
    own.terrain = terrain(k);
    WalkSetup at_once = setup;
    at_once.timing.settle_seconds = 0;
    TraceRecorder recorder;
    walk_once(own, at_once, draw_start(starts, derived_seed(seed, k)), engine, &recorder);
    return recorder.take();
  };
  return behaviour;
}

Behaviour policy_behaviour(LoadedEnv environment, PolicyFactory policy, const std::string& name,
                           const StartRanges& ranges, std::uint64_t seed) {
  const std::shared_ptr<const RobotDescription> robot = EnvModel::make(environment)->world.robot;
  EnvConfig& config = environment.config;
  const bool planned = config.action == ActionKind::kGait;
  config.randomisation = ranges.over(config.randomisation, *robot);
  Behaviour behaviour;
  behaviour.name = fmt::format("policy {} on {}, {:g} s", name, config.terrain, config.episode_seconds);
  behaviour.statistics = motion_statistics(*robot, planned);
  behaviour.statistics.push_back({"total reward", "-", 0.02, 0.01});
  behaviour.physics_dt = config.physics_dt;
  behaviour.control_dt = config.control_dt;
  behaviour.delays = delays_of(*robot);
  behaviour.run = [environment, policy = std::move(policy), seed, planned](
                      const Engine& engine, const Variation& variation, std::size_t k) {
    LoadedEnv varied = environment;  // what is varied is in no file
    varied.config.physics_dt *= variation.step;
    varied.config.terrain_seed += k;
    Variation solver_alone = variation;
    solver_alone.step = 1;  // the configuration has it already
    QuadrupedEnv env(varied, with_change(engine, [&solver_alone](WorldSpec& w) { solver_alone.apply(w); }));
    const std::unique_ptr<Policy> own = policy(env.interface());
    const EpisodeSummary episode = run_episode(env, *own, derived_seed(seed, k));
    std::vector<double> values = values_of(episode.motion, planned);
    values.push_back(episode.total_reward);
    return values;
  };
  return behaviour;
}

}  // namespace crossgait
