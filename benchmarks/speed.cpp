#include "benchmarks/speed.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "backends/registry.h"

namespace crossgait::benchmarks {
std::vector<SpeedScene> speed_scenes(const scenes::RobotPtr& robot) {
  const scenes::RobotPtr millipede = scenes::millipede();
  const auto hold = [](const scenes::RobotPtr& r) {
    return [home = scenes::home_targets(*r)](double) { return home; };
  };
  const auto trot = [trot = scenes::Trot(*robot)](double time) { return trot.targets(time); };
  const auto swing = [swing = scenes::Swing(*robot)](double time) { return swing.targets(time); };
  constexpr double kTrotting = scenes::Trot::kStand + scenes::Trot::kCycle;  // at full stride from here

  SpeedScene hanging{
      "swing", "base held in the air, legs swinging: no contact", scenes::world_of(robot), 0.5, 1600, swing};
  hanging.spec.fixed_base = true;
  SpeedScene rough{"trot_rough", "trotting on a rough height field", scenes::world_of(robot), kTrotting, 1600,
                   trot};
  rough.spec.terrain = make_terrain("rough:seed=1");
  return {
      hanging,
      {"stand", "standing on the plane", scenes::world_of(robot), 1, 1600, hold(robot)},
      {"trot_flat", "trotting on the plane", scenes::world_of(robot), kTrotting, 1600, trot},
      rough,
      // Few steps: an engine may need a hundred times as long for one.
      {"pile", "32 feet on 32 legs of one robot: the contacts of eight quadrupeds",
       scenes::world_of(millipede), 0.3, 100, hold(millipede)},
  };
}

SceneRunner::SceneRunner(const SpeedScene& scene, const Engine& engine)
    : what_(fmt::format("{} in {}", scene.name, engine.name())), world_(engine.make(scene.spec)) {
  if (scene.spec.fixed_base) {
    RobotState hanging = world_->home_state();
    hanging.p_WB.z() += 1;
    world_->reset(hanging);
  }
  const double h = scene.spec.physics_dt;
  const long before = std::lround(scene.start / h);
  for (long i = 0; i < before; ++i) {
    if (world_->step(scene.targets(static_cast<double>(i) * h)) != StepStatus::kOk) {
      throw std::runtime_error(what_ + " diverged before it could be timed");
    }
  }
  for (long i = before; i < before + scene.steps; ++i) {
    targets_.push_back(scene.targets(static_cast<double>(i) * h));
  }
  start_ = world_->save();
}

bool SceneRunner::repeat(int times) {
  for (int k = 0; k < times; ++k) {
    world_->restore(start_);
    for (const JointTargets& targets : targets_) {
      if (world_->step(targets) != StepStatus::kOk) return false;
    }
  }
  return true;
}

double SceneRunner::run() {
  const double begin = thread_seconds();
  if (!repeat(1)) throw std::runtime_error(what_ + " diverged");
  return (thread_seconds() - begin) / static_cast<double>(targets_.size());
}

double SceneRunner::count_contacts() {
  world_->restore(start_);
  double sum = 0;
  for (const JointTargets& targets : targets_) {
    if (world_->step(targets) != StepStatus::kOk) throw std::runtime_error(what_ + " diverged");
    sum += world_->contacts().count;
  }
  return sum / static_cast<double>(targets_.size());
}

std::vector<SceneSpeed> measure_speed(const SpeedSettings& settings, const Progress& progress) {
  const std::vector<SpeedScene> all = speed_scenes(settings.robot);
  std::vector<SceneSpeed> results;
  for (std::size_t s = 0; s < all.size(); ++s) {
    std::vector<SceneRunner> runners;
    for (const std::string& engine : settings.engines) runners.emplace_back(all[s], find_engine(engine));
    const std::size_t count = runners.size();
    std::vector<std::vector<double>> time(count), ratio(count);
    std::vector<double> contacts;
    for (SceneRunner& runner : runners) contacts.push_back(runner.count_contacts());  // warms up, too
    for (int round = 0; round < settings.rounds; ++round) {
      for (std::size_t i = 0; i < count; ++i) {
        time[i].push_back(1e6 * runners[i].run());
        ratio[i].push_back(time[i].back() / time[0].back());
      }
      progress((static_cast<double>(s) + (round + 1.0) / settings.rounds) / static_cast<double>(all.size()));
    }
    for (std::size_t i = 0; i < count; ++i) {
      results.push_back(
          {all[s].name, settings.engines[i], contacts[i], quartiles(time[i]), quartiles(ratio[i])});
    }
  }
  return results;
}

}  // namespace crossgait::benchmarks
