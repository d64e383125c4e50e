// Time of a physics step of the trot, as a ratio to a bare mj_step loop under the same recorded controls. The
// engines are linked, not opened as plug-ins: the bare loop needs MuJoCo's own functions in this program.
// Interleaved within one run, median of several repetitions, with the spread:
//   build/release/benchmarks/programs/step_benchmark [REPETITIONS] [FILE.json|- [ROBOT [FRICTION]]]
// ROBOT is scara_quadruped or serial_quadruped, FRICTION the dry friction of each of its joints, N m.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "backends/mujoco/mujoco_backend.h"
#include "benchmarks/programs/mujoco/bare_mujoco.h"
#include "physics/core/atomic_file.h"
#include "physics/core/table.h"
#include "scenes/robots.h"
#include "scenes/scenes.h"
#ifdef CROSSGAIT_HAS_BULLET
#include "backends/bullet/bullet_backend.h"
#endif

namespace {

using namespace crossgait;

constexpr int kSteps = 4000;

template <typename Work>
double microseconds_per_step(const Work& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count() / kSteps;
}

std::vector<Engine> engines() {
  std::vector<Engine> all{mujoco::engine()};
#ifdef CROSSGAIT_HAS_BULLET
  all.push_back(bullet::matched_engine());
  all.push_back(bullet::native_engine());
#endif
  return all;
}

struct Series {
  std::string name;
  std::vector<double> time, ratio;  // us; to the bare loop of the same repetition
};

scenes::RobotPtr robot(std::string_view name, double friction) {
  const scenes::RobotPtr chosen =
      name == "serial_quadruped" ? scenes::serial_quadruped() : scenes::quadruped();
  return scenes::with_joint_friction(chosen, friction);
}

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(std::lround(share * static_cast<double>(values.size() - 1)))];
}

}  // namespace

int main(int argc, char** argv) {
  const int repetitions = argc > 1 ? std::max(1, std::atoi(argv[1])) : 15;
  const WorldSpec spec = scenes::world_of(robot(argc > 3 ? argv[3] : "", argc > 4 ? std::atof(argv[4]) : 0));
  const scenes::Trot trot(*spec.robot);
  std::vector<JointTargets> targets;
  for (int i = 0; i < kSteps; ++i) targets.push_back(trot.targets(i * spec.physics_dt));

  const auto recorder = mujoco::engine().make(spec);
  const RobotState start = recorder->state();
  std::vector<JointVector> torques;
  for (const JointTargets& target : targets) {
    if (recorder->step(target) != StepStatus::kOk) return EXIT_FAILURE;
    torques.push_back(recorder->torques());
  }
  BareMujoco bare(spec);
  std::vector<Series> series{{"bare mj_step", {}, {}}};
  std::vector<std::unique_ptr<PhysicsBackend>> worlds;
  for (const Engine& engine : engines()) {
    worlds.push_back(engine.make(spec));
    series.push_back({engine.name(), {}, {}});
  }
  for (int r = -1; r < repetitions; ++r) {  // the first warms up and is not kept
    std::vector<double> times{microseconds_per_step([&] { bare.replay(start, torques); })};
    for (const auto& world : worlds) {
      world->reset();
      times.push_back(microseconds_per_step([&] {
        for (const JointTargets& target : targets) {
          if (world->step(target) != StepStatus::kOk) std::abort();
        }
      }));
    }
    for (std::size_t i = 0; r >= 0 && i < times.size(); ++i) {
      series[i].time.push_back(times[i]);
      series[i].ratio.push_back(times[i] / times[0]);
    }
  }
  // The replay must have been the same walk, or the ratios compare different things.
  if ((bare.position() - recorder->state().p_WB).norm() > 1e-9) {
    fmt::print(stderr, "the bare loop walked elsewhere: {:.3g} m off\n",
               (bare.position() - recorder->state().p_WB).norm());
    return EXIT_FAILURE;
  }
  Table table({fmt::format("trot, {} steps x {}", kSteps, repetitions), "us/step", "ratio",
               "quartiles of the ratio"});
  nlohmann::ordered_json json;
  for (const Series& s : series) {
    const double low = quantile(s.ratio, 0.25), median = quantile(s.ratio, 0.5),
                 high = quantile(s.ratio, 0.75);
    table.add_row({s.name, fmt::format("{:.2f}", quantile(s.time, 0.5)), fmt::format("{:.3f}", median),
                   fmt::format("{:.3f} to {:.3f}", low, high)});
    json[s.name] = {
        {"us_per_step", quantile(s.time, 0.5)}, {"ratio", median}, {"ratio_quartiles", {low, high}}};
  }
  fmt::print("{}", table.str());
  if (argc > 2 && argv[2][0] != '-') write_file_atomically(argv[2], json.dump(2) + "\n");
  return EXIT_SUCCESS;
}
