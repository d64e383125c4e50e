// Gait, kinematics and terrain queries: what a control step costs outside the engines. `items` are updates of
// all four legs, or feet of one leg.
#include <benchmark/benchmark.h>

#include "ik/leg_kinematics.h"
#include "motion/foot_target_tracker.h"
#include "motion/gait_source.h"
#include "physics/robot_files/data_path.h"

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
  FootTargetTracker legs(robot(), ServoCompensation::none());
  for (auto _ : state) benchmark::DoNotOptimize(legs.update(next_feet(gait), 2e-3));
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(BM_GaitAndInverseKinematics);

void BM_GaitInverseKinematicsAndCompensation(benchmark::State& state) {
  GaitGenerator gait = trot();
  FootTargetTracker legs(robot());
  for (auto _ : state) benchmark::DoNotOptimize(legs.update(next_feet(gait), 2e-3));
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(BM_GaitInverseKinematicsAndCompensation);

/// One leg of either kind: the five-bar, and a serial leg of 0.42 m with straight or oblique axes, standing.
LegKinematics leg_of_kind(LegKind kind) {
  if (kind == LegKind::kFiveBar) return make_leg_kinematics(*robot(), Leg::FL);
  RobotDescription serial;
  serial.bodies.resize(4);
  const Vector3 oblique = kind == LegKind::kSerial ? Vector3::UnitY() : Vector3(0.05, 1, 0.05).normalized();
  const std::array<Vector3, 3> axes{Vector3::UnitX(), Vector3::UnitY(), oblique};
  const std::array<Vector3, 3> origins{Vector3(0.2, 0.05, 0), Vector3(0, 0.08, 0), Vector3(0, 0, -0.21)};
  for (int i = 0; i < 3; ++i) {
    Body& body = serial.bodies[static_cast<std::size_t>(i) + 1];
    body.parent = i;
    body.X_PB.translation() = origins[static_cast<std::size_t>(i)];
    body.joint.axis = axes[static_cast<std::size_t>(i)];
  }
  serial.home.resize(3);
  serial.home << 0, 0.8, -1.6;
  return make_leg_kinematics(
      serial, Leg::FL, {.abduction = 0, .hip = 1, .knee = 2, .foot_body = 3, .p_BF = Vector3(0, 0, -0.21)});
}

/// Targets on a circle of a seventh of the leg's height about a standing foot.
Vector3 next_target(const LegKinematics& leg, double& phase) {
  phase += 0.1;
  const double height = leg.kind() == LegKind::kFiveBar ? 0.06 : 0.3;
  return {height / 7 * std::cos(phase), 0.01, -height + height / 7 * std::sin(phase)};
}

void BM_LegInverse(benchmark::State& state) {
  const LegKinematics leg = leg_of_kind(static_cast<LegKind>(state.range(0)));
  double phase = 0;
  for (auto _ : state) benchmark::DoNotOptimize(leg.inverse(next_target(leg, phase)));
  state.SetItemsProcessed(state.iterations());
  state.SetLabel(std::string(name(leg.kind())));
}
BENCHMARK(BM_LegInverse)->DenseRange(0, 2);

/// The same without LegKinematics around it.
void BM_LegInverseOfTheKind(benchmark::State& state) {
  const LegKinematics leg = leg_of_kind(static_cast<LegKind>(state.range(0)));
  double phase = 0;
  for (auto _ : state) {
    const Vector3 target = next_target(leg, phase);
    if (const auto* five_bar = leg.as<FiveBarGeometry>()) {
      benchmark::DoNotOptimize(solve_leg(*five_bar, target));
    } else if (const auto* serial = leg.as<SerialLegGeometry>()) {
      benchmark::DoNotOptimize(solve_serial(*serial, target, KneeBranch::kBackward));
    } else {
      benchmark::DoNotOptimize(
          solve_least_squares(*leg.as<LeastSquaresLegGeometry>(), target, KneeBranch::kBackward));
    }
  }
  state.SetItemsProcessed(state.iterations());
  state.SetLabel(std::string(name(leg.kind())));
}
BENCHMARK(BM_LegInverseOfTheKind)->DenseRange(0, 2);

void BM_LegForwardAndJacobian(benchmark::State& state) {
  const LegKinematics leg = leg_of_kind(static_cast<LegKind>(state.range(0)));
  double phase = 0;
  const LegPosture posture = leg.inverse(next_target(leg, phase)).posture;
  for (auto _ : state) {
    benchmark::DoNotOptimize(leg.forward(posture.servos));
    benchmark::DoNotOptimize(leg.jacobian(posture));
  }
  state.SetItemsProcessed(state.iterations());
  state.SetLabel(std::string(name(leg.kind())));
}
BENCHMARK(BM_LegForwardAndJacobian)->DenseRange(0, 2);

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
