#include "benchmarks/accuracy.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "backends/registry.h"
#include "benchmarks/statistics.h"
#include "scenes/scenes.h"

namespace crossgait::benchmarks {
namespace {

constexpr double kSettle = 1;  // s: longer than the touch-down's swinging

/// What trots in which engine, and where.
struct Place {
  std::string engine, terrain;
  scenes::RobotPtr robot;
};

std::unique_ptr<PhysicsBackend> make_trot_world(const Place& place, double step) {
  WorldSpec spec = scenes::world_of(place.robot);
  spec.terrain = make_terrain(place.terrain);
  spec.physics_dt = step;
  return crossgait::make_world(place.engine, spec);
}

/// Physics steps per command: at least one.
int substeps(double step) { return std::max(1, static_cast<int>(std::lround(kCommandStep / step))); }

/// The trot from its first step, command by command.
std::vector<JointTargets> commands(const RobotDescription& robot, double seconds,
                                   double period = kCommandStep) {
  const scenes::Trot trot(robot);
  std::vector<JointTargets> targets;
  for (long i = 0; i < std::lround(seconds / period); ++i) {
    targets.push_back(trot.targets(scenes::Trot::kStand + static_cast<double>(i) * period));
  }
  return targets;
}

using States = std::vector<RobotState>;

/// States after every command, until the engine diverges.
void follow(PhysicsBackend& world, const RobotState& start, const std::vector<JointTargets>& targets,
            States& states) {
  states.clear();
  world.reset(start);
  const int n = substeps(world.spec().physics_dt);
  for (const JointTargets& target : targets) {
    if (world.step(target, n) != StepStatus::kOk) return;
    states.push_back(world.state());
  }
}

/// One engine on one terrain at one step.
struct Run {
  AccuracyPoint point;
  std::unique_ptr<PhysicsBackend> world;
  RobotState start;
  std::vector<double> cost, cost_ratio;

  Run(const Place& place, double step, RobotState from)
      : world(make_trot_world(place, step)), start(std::move(from)) {
    point.terrain = place.terrain;
    point.engine = place.engine;
    point.step_s = step;
  }
};

void compare(const States& states, const States& reference, AccuracyPoint& point) {
  if (states.size() < reference.size()) return;
  double position = 0, joints = 0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    position += (states[i].p_WB - reference[i].p_WB).squaredNorm();
    joints += (states[i].q - reference[i].q).squaredNorm() / static_cast<double>(reference[i].q.size());
  }
  point.position_error_m = std::sqrt(position / static_cast<double>(reference.size()));
  point.joint_error_rad = std::sqrt(joints / static_cast<double>(reference.size()));
}

/// Standing still at the reference step, time zero.
RobotState settled(PhysicsBackend& world) {
  const JointTargets home = scenes::home_targets(world.robot());
  world.reset();
  if (world.step(home, static_cast<int>(std::lround(kSettle / world.spec().physics_dt))) != StepStatus::kOk) {
    throw std::runtime_error(fmt::format("standing diverged in {}", world.info().name));
  }
  RobotState state = world.state();
  state.time = 0;
  return state;
}

/// One engine at every step, against itself at the reference step.
std::vector<Run> measure_errors(const Place& place, const std::vector<double>& steps) {
  const std::vector<JointTargets> targets = commands(*place.robot, kAccuracyHorizon);
  const auto exact = make_trot_world(place, kReferenceStep);
  const RobotState start = settled(*exact);
  States states, reference;
  follow(*exact, start, targets, reference);
  if (reference.size() < targets.size()) {
    throw std::runtime_error(fmt::format("the trot diverged in {} at the reference step", place.engine));
  }
  std::vector<Run> runs;
  for (const double step : steps) {
    Run& run = runs.emplace_back(place, step, start);
    follow(*run.world, start, targets, states);
    compare(states, reference, run.point);
  }
  return runs;
}

/// Times every step in every engine, the engines in turns.
void time_round(std::vector<std::vector<Run>>& runs) {
  const std::vector<JointTargets> targets = commands(runs.front().front().world->robot(), kAccuracyHorizon);
  States states;
  for (std::size_t s = 0; s < runs.front().size(); ++s) {
    for (std::vector<Run>& engine : runs) {
      Run& run = engine[s];
      const double begin = thread_seconds();
      follow(*run.world, run.start, targets, states);
      run.cost.push_back((thread_seconds() - begin) / kAccuracyHorizon);
      run.cost_ratio.push_back(run.cost.back() / runs.front()[s].cost.back());
    }
  }
}

StableStep find_stable_step(const Place& place) {
  StableStep result;
  result.terrain = place.terrain;
  result.engine = place.engine;
  for (const double ms :
       {1.0, 2.0, 8.0 / 3, 4.0, 8.0, 10.0, 12.0, 14.0, 16.0, 18.0, 20.0, 24.0, 28.0, 32.0}) {
    const double step = 1e-3 * ms;
    result.tried_s.push_back(step);
    if (!trot_survives(place.engine, place.terrain, step, place.robot)) break;
    result.largest_s = step;
  }
  return result;
}

}  // namespace

bool trot_survives(const std::string& engine, const std::string& terrain, double step,
                   const scenes::RobotPtr& robot) {
  constexpr double kFallen = M_PI / 3;
  const auto world = make_trot_world({engine, terrain, robot}, step);
  if (world->step(scenes::home_targets(world->robot()), static_cast<int>(std::lround(kSettle / step))) !=
      StepStatus::kOk) {
    return false;
  }
  for (const JointTargets& target : commands(*robot, kStabilityHorizon, std::max(kCommandStep, step))) {
    if (world->step(target, substeps(step)) != StepStatus::kOk) return false;
    const RobotState& s = world->state();
    const Vector3 rpy = roll_pitch_yaw(s.q_WB);
    if (std::max(std::abs(rpy.x()), std::abs(rpy.y())) > kFallen) return false;
    const double height = s.p_WB.z() - world->spec().terrain.height(s.p_WB.x(), s.p_WB.y());
    if (height < world->robot().home_height / 2) return false;
  }
  return true;
}

Accuracy measure_accuracy(const AccuracySettings& settings, const Progress& progress) {
  Accuracy result;
  const double parts = static_cast<double>(settings.terrains.size()) * (settings.rounds + 3);
  double done = 0;
  const auto advance = [&](double share) { progress((done += share) / parts); };
  for (const std::string& terrain : settings.terrains) {
    std::vector<std::vector<Run>> runs;  // by engine, by step
    for (const std::string& engine : settings.engines) {
      runs.push_back(measure_errors({engine, terrain, settings.robot}, settings.steps_s));
      advance(2.0 / static_cast<double>(settings.engines.size()));
    }
    for (int round = 0; round < settings.rounds; ++round) {
      time_round(runs);
      advance(1);
    }
    for (std::vector<Run>& engine : runs) {
      for (Run& run : engine) {
        run.point.cost = quartiles(run.cost).median;
        run.point.cost_ratio = quartiles(run.cost_ratio).median;
        result.points.push_back(std::move(run.point));
      }
      result.stable.push_back(find_stable_step({engine.front().world->info().name, terrain, settings.robot}));
    }
    advance(1);
  }
  return result;
}

}  // namespace crossgait::benchmarks
