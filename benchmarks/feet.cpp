#include "benchmarks/feet.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "backends/registry.h"
#include "benchmarks/statistics.h"
#include "physics/robot/multibody.h"
#include "scenes/scenes.h"

namespace crossgait::benchmarks {
namespace {

constexpr double kStanding = 2;    // s
constexpr int kFreeSteps = 20;     // without contact before a contact counts as a touch-down
constexpr int kLandingSteps = 10;  // that belong to a touch-down

void step(PhysicsBackend& world, const JointTargets& targets, int count = 1) {
  if (world.step(targets, count) != StepStatus::kOk) {
    throw std::runtime_error(fmt::format("the foot-contact card diverged in {}", world.info().name));
  }
}

LegArray<Vector3> foot_positions(const PhysicsBackend& world) {
  std::vector<Pose> poses;
  forward_kinematics(world.robot(), world.state(), poses);
  LegArray<Vector3> feet;
  for (const Leg leg : kLegs) feet[leg] = foot_position(world.robot(), leg, poses);
  return feet;
}

double weight_of(const PhysicsBackend& world) {
  return world.robot().total_mass() * world.spec().gravity.norm();
}

void stand(PhysicsBackend& world, double seconds, FootCard& card) {
  const JointTargets home = scenes::home_targets(world.robot());
  const double h = world.spec().physics_dt;
  world.reset();
  step(world, home, static_cast<int>(std::lround(kStanding / h)));
  // What still settles in the first half is no creep, however long one stands afterwards.
  LegArray<Vector3> before = foot_positions(world);
  const long steps = std::lround(seconds / h), half = steps / 2;
  double force = 0, depth = 0, touching = 0;
  for (long i = 0; i < steps; ++i) {
    if (i == half) before = foot_positions(world);
    step(world, home);
    for (const Contact& c : world.contacts()) force += c.force.z();
    for (const FootContact& foot : world.foot_contacts()) {
      touching += foot.touching ? 1 : 0;
      depth += foot.touching ? foot.penetration : 0;
    }
  }
  const LegArray<Vector3> after = foot_positions(world);
  for (const Leg leg : kLegs) {
    card.creep_mps = std::max(card.creep_mps, (after[leg] - before[leg]).head<2>().norm() /
                                                  (static_cast<double>(steps - half) * h));
  }
  card.stand_seconds = seconds;
  card.penetration_m = depth / touching;
  card.force_error = force / static_cast<double>(steps) / weight_of(world) - 1;
}

/// Watches one foot, physics step by physics step.
class Landings {
 public:
  void add(const FootContact& foot, double h) {
    if (foot.touching && free_ >= kFreeSteps) {
      landing_ = kLandingSteps;
      sum_.setZero();
      impulse.push_back(0);
      peak.push_back(0);
    }
    free_ = foot.touching ? 0 : free_ + 1;
    if (landing_ == 0) return;
    --landing_;
    sum_ += h * foot.force;
    impulse.back() = sum_.norm();
    peak.back() = std::max(peak.back(), foot.force.norm());
  }
  std::vector<double> impulse, peak;  // N s, N; one per touch-down

 private:
  int free_ = 0, landing_ = 0;
  Vector3 sum_ = Vector3::Zero();
};

void trot(PhysicsBackend& world, int strides, FootCard& card) {
  using scenes::Trot;
  const Trot trot(world.robot());
  const double h = world.spec().physics_dt;
  const auto steps_of = [h](double seconds) { return std::lround(seconds / h); };
  const long begin = steps_of(Trot::kStand + Trot::kCycle), end = begin + steps_of(strides * Trot::kCycle);
  LegArray<Landings> landings;
  world.reset();
  double slip = 0, drag = 0;
  for (long i = 0; i < end; ++i) {
    const double time = static_cast<double>(i) * h;
    step(world, trot.targets(time));
    if (i < begin) continue;  // strides still growing
    const LegArray<FootContact> feet = world.foot_contacts();
    for (const Leg leg : kLegs) {
      landings[leg].add(feet[leg], h);
      if (feet[leg].touching) (Trot::swings(leg, time) ? drag : slip) += feet[leg].slip_speed * h;
      card.deepest_m = std::max(card.deepest_m, feet[leg].penetration);
    }
  }
  std::vector<double> impulses, peaks;
  for (const Landings& foot : landings) {
    impulses.insert(impulses.end(), foot.impulse.begin(), foot.impulse.end());
    peaks.insert(peaks.end(), foot.peak.begin(), foot.peak.end());
  }
  card.strides = strides;
  card.touchdowns = static_cast<int>(impulses.size());
  card.touchdown_impulse = impulses.empty() ? 0 : quantile(impulses, 0.5);
  card.touchdown_peak = peaks.empty() ? 0 : quantile(peaks, 0.5) / weight_of(world);
  card.toe_drag_per_stride_m = drag / (kLegCount * strides);
  card.slip_per_stride_m = slip / (kLegCount * strides);
}

}  // namespace

std::vector<FootCard> measure_feet(const FeetSettings& settings, const Progress& progress) {
  std::vector<FootCard> cards;
  const double count = static_cast<double>(settings.terrains.size() * settings.engines.size());
  for (const std::string& terrain : settings.terrains) {
    for (const std::string& engine : settings.engines) {
      WorldSpec spec = scenes::world_of(settings.robot);
      spec.terrain = make_terrain(terrain);
      const auto world = make_world(engine, spec);
      FootCard card;
      card.engine = engine;
      card.terrain = terrain;
      stand(*world, settings.stand_seconds, card);
      trot(*world, settings.strides, card);
      cards.push_back(card);
      progress(static_cast<double>(cards.size()) / count);
    }
  }
  return cards;
}

}  // namespace crossgait::benchmarks
