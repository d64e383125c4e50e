// Walks with a controller of your own in every engine: a crawl of feet in their leg frames.
#include <array>
#include <cmath>
#include <cstdio>

#include "crossgait/backends/registry.h"
#include "crossgait/motion/gait_source.h"
#include "crossgait/motion/walk.h"
#include "crossgait/study/loaded_walk.h"

/// Where the feet are, m: each in its turn is lifted and put forward, the others push back.
struct Crawl {
  double time = 0;  // s

  crossgait::LegArray<crossgait::Vector3> operator()(double dt) {
    constexpr double kCycle = 0.6, kSwing = 0.15, kStep = 0.04, kLift = 0.03, kDepth = 0.065;
    constexpr std::array kOffset{0.25, 0.75, 0.0, 0.5};  // when FL, FR, RL and RR lift off, in cycles
    time += dt;
    crossgait::LegArray<crossgait::Vector3> feet;
    for (std::size_t leg = 0; leg < kOffset.size(); ++leg) {
      const double phase = time / kCycle - kOffset[leg] - std::floor(time / kCycle - kOffset[leg]);
      const double swung = phase / kSwing, stood = (phase - kSwing) / (1 - kSwing);
      feet[crossgait::kLegs[leg]] =
          phase < kSwing
              ? crossgait::Vector3(kStep * (swung - 0.5), 0, -kDepth + kLift * std::sin(M_PI * swung))
              : crossgait::Vector3(kStep * (0.5 - stood), 0, -kDepth);
    }
    return feet;
  }
};

int main() {
  const crossgait::WorldSpec spec = crossgait::LoadedWalk(crossgait::WalkConfig()).world;
  for (const std::string& engine : crossgait::available_engines()) {
    const auto world = crossgait::make_world(engine, spec);
    const auto crawl = crossgait::make_feet_controller(Crawl(), spec);
    const crossgait::MotionSummary walk = run_walk(*world, crawl, {.seconds = 3});
    std::printf("%-16s %.3f m\n", engine.c_str(), walk.distance_m);
  }
}
