// Time of a physics step against the number of contacts, and how far engines are apart by then: robots on 4
// to 64 points, every engine in turns.
//   build/release/benchmarks/programs/contacts_benchmark [ROUNDS] [FILE.json] [ENGINE...]
// The first engine (mujoco) is what the others are compared to.
#include <cstdlib>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "backends/registry.h"
#include "benchmarks/speed.h"
#include "physics/core/atomic_file.h"
#include "physics/core/table.h"

namespace {

using namespace crossgait;
using benchmarks::SpeedScene;

SpeedScene scene(std::string name, std::string summary, const scenes::RobotPtr& robot, double start,
                 int steps) {
  SpeedScene s{std::move(name), std::move(summary), scenes::world_of(robot), start, steps, {}};
  s.targets = [home = scenes::home_targets(*robot)](double) { return home; };
  return s;
}

std::vector<SpeedScene> all_scenes() {
  std::vector<SpeedScene> all;
  const scenes::RobotPtr quadruped = scenes::quadruped();
  SpeedScene trot = scene("trot", "the tests' trot on the plane", quadruped, 1.3, 800);
  trot.targets = [trot = scenes::Trot(*quadruped)](double time) { return trot.targets(time); };
  all.push_back(trot);
  for (const int legs : {4, 8, 16, 32})
    all.push_back(scene(fmt::format("stand {}", legs), "one-link legs", scenes::millipede(legs), 0.3, 200));
  all.push_back(scene("stand 64", "32 legs with two toes each", scenes::millipede(kMaxJoints, 2), 0.3, 200));
  for (const int points : {8, 16, 32, 64}) {
    // Down a slope of 45 degrees, which friction does not hold.
    SpeedScene belly =
        scene(fmt::format("belly {}", points), "30 kg sliding", scenes::heavy_sledge(points), 0.1, 200);
    belly.spec.gravity = {6.94, 0.5, -6.94};
    all.push_back(belly);
  }
  return all;
}

/// Distance between the bases of two engines at most, from the scene's very beginning, at a tight tolerance,
/// m.
double distance(SpeedScene scene, const std::string& a, const std::string& b) {
  scene.spec.solver.tolerance = 1e-12;
  const auto x = make_world(a, scene.spec), y = make_world(b, scene.spec);
  const double h = scene.spec.physics_dt;
  double worst = 0;
  for (int i = 0; i < 1000; ++i) {
    const JointTargets targets = scene.targets(i * h);
    if (x->step(targets) != StepStatus::kOk || y->step(targets) != StepStatus::kOk)
      throw std::runtime_error(scene.name + " diverged");
    worst = std::max(worst, (x->state().p_WB - y->state().p_WB).norm());
  }
  return worst;
}

void measure(const SpeedScene& scene, const std::vector<std::string>& engines, int rounds, Table& table,
             nlohmann::ordered_json& json) {
  std::vector<benchmarks::SceneRunner> runners;
  for (const std::string& engine : engines) runners.emplace_back(scene, find_engine(engine));
  std::vector<std::vector<double>> time(engines.size()), ratio(engines.size());
  std::vector<double> contacts;
  for (benchmarks::SceneRunner& runner : runners) contacts.push_back(runner.count_contacts());  // warms up
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < engines.size(); ++i) {
      time[i].push_back(1e6 * runners[i].run());
      ratio[i].push_back(time[i].back() / time[0].back());
    }
  }
  for (std::size_t i = 0; i < engines.size(); ++i) {
    const auto us = benchmarks::quartiles(time[i]), r = benchmarks::quartiles(ratio[i]);
    const double apart = i == 0 ? 0 : distance(scene, engines[0], engines[i]);
    table.add_row({scene.name, engines[i], fmt::format("{:.1f}", contacts[i]),
                   fmt::format("{:.1f}", us.median), fmt::format("{:.2f}", r.median),
                   fmt::format("{:.2f} to {:.2f}", r.low, r.high), fmt::format("{:.1e}", apart)});
    json.push_back({{"scene", scene.name},
                    {"engine", engines[i]},
                    {"contacts", contacts[i]},
                    {"us_per_step", us.median},
                    {"ratio", r.median},
                    {"ratio_quartiles", {r.low, r.high}},
                    {"apart_m", apart}});
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 9;
  std::vector<std::string> engines{"mujoco", "bullet:matched", "bullet", "bullet-sweeps"};
  if (argc > 3) engines.assign(argv + 3, argv + argc);
  Table table({"scene", "engine", "contacts", "us/step", "ratio", "quartiles", "apart in 1 s, m"});
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const SpeedScene& s : all_scenes()) measure(s, engines, rounds, table, json);
  fmt::print("{}", table.str());
  if (argc > 2 && argv[2][0] != '-') write_file_atomically(argv[2], json.dump(2) + "\n");
  return EXIT_SUCCESS;
}
