#include "benchmarks/scaling.h"

#include <algorithm>
#include <atomic>
#include <barrier>
#include <chrono>
#include <stdexcept>
#include <system_error>
#include <thread>

#include <fmt/format.h>

#include "backends/registry.h"
#include "gait/scale.h"
#include "motion/gait_source.h"
#include "motion/time_steps.h"
#include "motion/walk.h"

namespace crossgait::benchmarks {
namespace {

SpeedScene scene_named(const std::string& name, const scenes::RobotPtr& robot) {
  for (SpeedScene& scene : speed_scenes(robot)) {
    if (scene.name == name) return scene;
  }
  throw std::logic_error("no scene " + name);
}

/// Wall-clock time from when the first of `threads` runners starts until the last one is through, s.
double run_together(std::vector<SceneRunner>& runners, int threads, int repeats) {
  using Clock = std::chrono::steady_clock;
  std::barrier together(threads);
  std::atomic<bool> sound = true;
  std::vector<Clock::time_point> begin(static_cast<std::size_t>(threads)), end = begin;
  std::vector<std::thread> workers;
  const auto work = [&](std::size_t t) {
    together.arrive_and_wait();
    begin[t] = Clock::now();
    if (!runners[t].repeat(repeats)) sound = false;
    end[t] = Clock::now();
  };
  try {
    for (std::size_t t = 0; t < begin.size(); ++t) workers.emplace_back(work, t);
  } catch (const std::system_error& error) {
    // Those that did start wait for the rest.
    for (std::size_t t = workers.size(); t < begin.size(); ++t) together.arrive_and_drop();
    for (std::thread& worker : workers) worker.join();
    throw std::runtime_error(fmt::format("{} of {} threads could be started: {}", workers.size(), threads,
                                         error.code().message()));
  }
  for (std::thread& worker : workers) worker.join();
  if (!sound) throw std::runtime_error("an engine diverged in the trot on several threads");
  const auto first = *std::min_element(begin.begin(), begin.end());
  const auto last = *std::max_element(end.begin(), end.end());
  return std::chrono::duration<double>(last - first).count();
}

/// A recorded walk that can be run again as a walk and as bare steps.
class Walk {
 public:
  Walk(const std::string& engine, const scenes::RobotPtr& robot, const std::string& terrain, double seconds) {
    WorldSpec spec = scenes::world_of(robot);
    spec.terrain = make_terrain(terrain);
    world_ = make_world(engine, spec);
    timing_.seconds = seconds;
    timing_.settle_seconds = 0;  // an observer sees no targets of the settling
    start_ = controller()->initial_state(spec.terrain, {});
    const MotionSummary summary = run_walk(*world_, controller(), timing_, [this](const WalkSample& sample) {
      targets_.push_back(sample.targets.joints);
      return true;
    });
    if (summary.has(Outcome::kDiverged))
      throw std::runtime_error(fmt::format("the walk in {} diverged", engine));
  }

  double steps() const {
    return static_cast<double>(targets_.size()) * step_count(timing_.control_dt, world_->spec().physics_dt);
  }
  /// CPU time, s.
  double walk() {
    const ControllerPtr gait = controller();
    const double begin = thread_seconds();
    run_walk(*world_, gait, timing_);
    const double time = thread_seconds() - begin;
    end_ = world_->state();
    return time;
  }
  /// CPU time, s. To be called after `walk`.
  double engine_alone() {
    const int substeps = step_count(timing_.control_dt, world_->spec().physics_dt);
    const double begin = thread_seconds();
    world_->reset(start_);
    for (const JointTargets& targets : targets_) {
      if (world_->step(targets, substeps) != StepStatus::kOk) break;
    }
    const double time = thread_seconds() - begin;
    if (!scenes::identical(world_->state(), end_)) {
      throw std::runtime_error("the recorded targets did not lead where the walk did: nothing to compare");
    }
    return time;
  }

 private:
  ControllerPtr controller() const {
    const GaitChoice trot = choose_gait("trot", {}, {}, gait_scale(world_->robot()));
    return make_gait_controller(trot, world_->spec());
  }

  std::unique_ptr<PhysicsBackend> world_;
  WalkTiming timing_;
  RobotState start_, end_;
  std::vector<JointTargets> targets_;
};

}  // namespace

std::vector<ThreadSpeed> measure_scaling(const ScalingSettings& settings, const Progress& progress) {
  const SpeedScene scene = scene_named("trot_flat", settings.robot);
  const auto threads = static_cast<std::size_t>(settings.max_threads);
  std::vector<std::vector<SceneRunner>> runners(settings.engines.size());
  for (std::size_t b = 0; b < runners.size(); ++b) {
    for (std::size_t t = 0; t < threads; ++t)
      runners[b].emplace_back(scene, find_engine(settings.engines[b]));
  }
  std::vector<std::vector<double>> speed(runners.size() * threads), efficiency(speed.size());
  for (int round = 0; round < settings.rounds; ++round) {
    for (std::size_t b = 0; b < runners.size(); ++b) {
      double alone = 0;  // steps per second of one thread in this round
      for (std::size_t t = 0; t < threads; ++t) {
        const int n = static_cast<int>(t) + 1;
        const double rate =
            n * scene.steps * settings.repeats / run_together(runners[b], n, settings.repeats);
        if (n == 1) alone = rate;
        speed[b * threads + t].push_back(rate);
        efficiency[b * threads + t].push_back(rate / (n * alone));
      }
      progress((round + static_cast<double>(b + 1) / static_cast<double>(runners.size())) / settings.rounds);
    }
  }
  std::vector<ThreadSpeed> results;
  for (std::size_t i = 0; i < speed.size(); ++i) {
    results.push_back({settings.engines[i / threads], static_cast<int>(i % threads) + 1,
                       quartiles(speed[i]).median, quartiles(efficiency[i])});
  }
  return results;
}

std::vector<Overhead> measure_overhead(const OverheadSettings& settings, const Progress& progress) {
  std::vector<Overhead> results;
  const std::vector<std::string> terrains{"flat", "rough:seed=1"};
  for (std::size_t k = 0; k < terrains.size(); ++k) {
    std::vector<Walk> walks;
    for (const std::string& engine : settings.engines) {
      walks.emplace_back(engine, settings.robot, terrains[k], settings.seconds);
    }
    std::vector<std::vector<double>> eta(walks.size()), walk_us(walks.size()), alone_us(walks.size());
    for (int round = 0; round < settings.rounds; ++round) {
      for (std::size_t i = 0; i < walks.size(); ++i) {
        const double walk = walks[i].walk(), alone = walks[i].engine_alone();
        eta[i].push_back(alone / walk);
        walk_us[i].push_back(1e6 * walk / walks[i].steps());
        alone_us[i].push_back(1e6 * alone / walks[i].steps());
      }
      progress((static_cast<double>(k) + (round + 1.0) / settings.rounds) /
               static_cast<double>(terrains.size()));
    }
    for (std::size_t i = 0; i < walks.size(); ++i) {
      results.push_back({settings.engines[i], terrains[k], quartiles(eta[i]), quartiles(walk_us[i]).median,
                         quartiles(alone_us[i]).median});
    }
  }
  return results;
}

}  // namespace crossgait::benchmarks
