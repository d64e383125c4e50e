#include "crossgait/parity/behaviour.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "crossgait/env/time_steps.h"

namespace crossgait {
namespace {

// Two per cent of a distance, a tenth of a degree: below what repeated runs of one real robot differ by.
Statistic distance() { return {"distance", "m", 0.02, 0.005}; }
Statistic speed() { return {"mean speed", "m/s", 0.02, 0.001}; }
Statistic roll() { return {"RMS roll", "deg", 0.02, 0.1}; }
Statistic pitch() { return {"RMS pitch", "deg", 0.02, 0.1}; }
Statistic slip() { return {"slip of loaded feet", "m", 0.02, 0.02}; }  // 5 mm for each foot
Statistic cost() { return {"cost of transport", "-", 0.02, 0.01}; }
Statistic duty() { return {"duty factor", "-", 0, 0.02}; }
Statistic falls() { return {"falls", "share", 0, 0.05, true}; }

struct Start {
  LegController::Placement placement;
  Vector3 push = Vector3::Zero();  // m/s
  double push_time = 0;            // s, of the walk
};

// The draws' order is part of what makes runs repeatable.
Start draw_start(const StartSpread& spread, std::uint64_t seed) {
  Random random(seed);
  Start start;
  LegController::Placement& p = start.placement;
  p.x = random.uniform(-spread.position_m, spread.position_m);
  p.y = random.uniform(-spread.position_m, spread.position_m);
  p.yaw = random.uniform(-spread.heading_rad, spread.heading_rad);
  p.roll = random.uniform(-spread.tilt_rad, spread.tilt_rad);
  p.pitch = random.uniform(-spread.tilt_rad, spread.tilt_rad);
  const double direction = random.uniform(-M_PI, M_PI);
  start.push = spread.push_mps * Vector3(std::cos(direction), std::sin(direction), 0);
  start.push_time = random.uniform();
  return start;
}

std::vector<double> values_of(const WalkSummary& s) {
  double duty_sum = 0;
  for (const Leg leg : kLegs) duty_sum += s.duty_factor[leg];
  return {s.distance_m, s.mean_speed_mps,    s.rms_roll_deg,       s.rms_pitch_deg,
          s.slip_m,     s.cost_of_transport, duty_sum / kLegCount, s.fell || s.diverged ? 1.0 : 0.0};
}

std::vector<double> values_of(const EpisodeSummary& s) {
  return {s.distance_m, s.mean_speed_mps,    s.rms_roll_deg, s.rms_pitch_deg,
          s.slip_m,     s.cost_of_transport, s.total_reward, s.fell || s.diverged ? 1.0 : 0.0};
}

// @param trace filled with every control step if not null
WalkSummary walk_once(const WorldSpec& world, const WalkSetup& setup, const Start& start,
                      const Engine& engine, Trace* trace = nullptr) {
  const std::unique_ptr<PhysicsBackend> backend = engine.make(world);
  LegController legs(*world.robot, setup.compensation);
  const double mass = world.robot->total_mass(), due = setup.timing.settle_seconds + start.push_time;
  bool pushed = false;
  const auto observer = [&](const WalkSample& sample) {
    if (trace != nullptr) {
      trace->emplace_back(sample);
      trace->back().torques = backend->torques();
    }
    if (!pushed && sample.state.time >= due) {
      backend->apply_push(mass * start.push);
      pushed = true;
    }
    return true;
  };
  return run_walk(*backend, legs, setup.make_gait(), setup.timing, observer, start.placement);
}

void fill_in(Randomisation& randomisation, Randomised what, double low, double high) {
  if (!randomisation.is_on(what)) randomisation[what] = {low, high};
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
  return is_whole_multiple(control_dt, physics_dt * variation.step);
}

Behaviour walk_behaviour(const WorldSpec& world, const WalkSetup& setup, const TerrainOfStart& terrain,
                         const StartSpread& spread, std::uint64_t seed) {
  Behaviour behaviour;
  behaviour.name = fmt::format("{} on {}, {:g} s", setup.gait, world.terrain.name(), setup.timing.seconds);
  behaviour.statistics = {distance(), speed(), roll(), pitch(), slip(), cost(), duty(), falls()};
  behaviour.physics_dt = world.physics_dt;
  behaviour.control_dt = setup.timing.control_dt;
  behaviour.run = [world, setup, terrain, spread, seed](const Engine& engine,
                                                        const Variation& variation, std::size_t k) {
    WorldSpec varied = world;
    varied.terrain = terrain(k);
    variation.apply(varied);
    return values_of(walk_once(varied, setup, draw_start(spread, derived_seed(seed, k)), engine));
  };
  behaviour.trace = [world, setup, terrain, spread, seed](const Engine& engine, std::size_t k) {
    WorldSpec own = world;
    own.terrain = terrain(k);
    WalkSetup at_once = setup;
    at_once.timing.settle_seconds = 0;
    Trace trace;
    walk_once(own, at_once, draw_start(spread, derived_seed(seed, k)), engine, &trace);
    return trace;
  };
  return behaviour;
}

Behaviour policy_behaviour(EnvConfig config, PolicyFactory policy, const std::string& name,
                           const StartSpread& spread, std::uint64_t seed) {
  using enum Randomised;
  fill_in(config.randomisation, kStartX, -spread.position_m, spread.position_m);
  fill_in(config.randomisation, kStartY, -spread.position_m, spread.position_m);
  fill_in(config.randomisation, kStartYaw, -spread.heading_rad, spread.heading_rad);
  fill_in(config.randomisation, kStartRoll, -spread.tilt_rad, spread.tilt_rad);
  fill_in(config.randomisation, kStartPitch, -spread.tilt_rad, spread.tilt_rad);
  fill_in(config.randomisation, kStartPhase, 0, 1);
  Behaviour behaviour;
  behaviour.name = fmt::format("policy {} on {}, {:g} s", name, config.terrain, config.episode_seconds);
  const Statistic reward{"total reward", "-", 0.02, 0.01};
  behaviour.statistics = {distance(), speed(), roll(), pitch(), slip(), cost(), reward, falls()};
  behaviour.physics_dt = config.physics_dt;
  behaviour.control_dt = config.control_dt;
  behaviour.run = [config, policy = std::move(policy), seed](const Engine& engine,
                                                             const Variation& variation, std::size_t k) {
    EnvConfig varied = config;
    varied.physics_dt *= variation.step;
    varied.terrain_seed += k;
    Variation solver_alone = variation;
    solver_alone.step = 1;  // the configuration has it already
    AdaptiveGaitEnv env(varied,
                        with_change(engine, [&solver_alone](WorldSpec& w) { solver_alone.apply(w); }));
    const std::unique_ptr<Policy> own = policy(env.interface());
    return values_of(run_episode(env, *own, derived_seed(seed, k)));
  };
  return behaviour;
}

}  // namespace crossgait
