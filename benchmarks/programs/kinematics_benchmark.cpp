// Gait, kinematics and terrain queries: what a control step costs outside the engines. `items` are updates of
// all four legs.
#include <benchmark/benchmark.h>

#include "crossgait/env/gait_source.h"
#include "crossgait/env/leg_controller.h"
#include "crossgait/physics/data_path.h"

namespace crossgait {
namespace {

std::shared_ptr<const RobotDescription> robot() {
  static const auto kRobot =
      std::make_shared<const RobotDescription>(load_robot(find_robot("scara_quadruped")));
  return kRobot;
}

LegArray<Vector3> next_feet(GaitGenerator& gait) {
  LegArray<Vector3> feet;
  const LegArray<FootTarget>& targets = gait.update(2e-3);
  for (const Leg leg : kLegs) feet[leg] = targets[leg].position;
  return feet;
}

GaitGenerator trot() { return {find_gait("trot"), find_gait("trot").preferred, leg_origins(*robot())}; }

void BM_Gait(benchmark::State& state) {
  GaitGenerator gait = trot();
  for (auto _ : state) benchmark::DoNotOptimize(gait.update(2e-3));
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(BM_Gait);

void BM_GaitAndInverseKinematics(benchmark::State& state) {
  GaitGenerator gait = trot();
  LegController legs(robot(), ServoCompensation::none());
  for (auto _ : state) benchmark::DoNotOptimize(legs.update(next_feet(gait), 2e-3));
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(BM_GaitAndInverseKinematics);

void BM_GaitInverseKinematicsAndCompensation(benchmark::State& state) {
  GaitGenerator gait = trot();
  LegController legs(robot());
  for (auto _ : state) benchmark::DoNotOptimize(legs.update(next_feet(gait), 2e-3));
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(BM_GaitInverseKinematicsAndCompensation);

void BM_SphereOnRoughGround(benchmark::State& state) {
  const Terrain terrain = make_terrain("rough", 1);
  double x = 0;
  for (auto _ : state) {
    x = x > 2 ? -2 : x + 1e-3;
    SphereContact contact;
    benchmark::DoNotOptimize(terrain.touch_sphere(Vector3(x, 0.1, 0.008), 0.008, contact));
  }
}
BENCHMARK(BM_SphereOnRoughGround);

}  // namespace
}  // namespace crossgait
