// Worlds that are refused before an engine sees them, at both ends of every range.
#include "physics/engine/world_spec.h"

#include <functional>

#include <gtest/gtest.h>

#include "tests/physics/core/config_error.h"
#include "tests/physics/robot_files/scratch_robot.h"
#include "tests/support/constants.h"

namespace crossgait {
namespace {

WorldSpec pendulum_world() {
  WorldSpec world;
  world.robot = std::make_shared<const RobotDescription>(pendulum_chain(1));
  return world;
}

// One number of a world, the ends of its range, and whether these belong to it.
struct WorldRange {
  const char* element;
  std::function<void(WorldSpec&, double)> set;
  double low, high;
  bool low_allowed = true, high_allowed = true;
};

const std::vector<WorldRange> kWorldRanges{
    {"physics_dt", [](WorldSpec& w, double x) { w.physics_dt = x; }, 1e-6, 0.1},
    {"contact.friction", [](WorldSpec& w, double x) { w.contact.friction = x; }, 0, 10},
    {"contact.impratio", [](WorldSpec& w, double x) { w.contact.impratio = x; }, 0, 10 * kMostImpratio,
     false},
    {"contact.softness.time_constant", [](WorldSpec& w, double x) { w.contact.softness.time_constant = x; },
     0, 10, false},
    {"contact.softness.damping_ratio", [](WorldSpec& w, double x) { w.contact.softness.damping_ratio = x; },
     0, 100, false},
    {"contact.softness.impedance_min",
     [](WorldSpec& w, double x) {
       w.contact.softness.impedance_min = x;
       w.contact.softness.impedance_max = std::max(x, 0.5);
     },
     0, 1, false, false},
    {"contact.softness.impedance_max",
     [](WorldSpec& w, double x) {
       w.contact.softness.impedance_min = 0.5;
       w.contact.softness.impedance_max = x;
     },
     0.5, 1},
    {"contact.softness.impedance_midpoint",
     [](WorldSpec& w, double x) { w.contact.softness.impedance_midpoint = x; }, 0, 1, false, false},
    {"contact.softness.impedance_power",
     [](WorldSpec& w, double x) { w.contact.softness.impedance_power = x; }, 1, 100},
    {"contact.torsional_friction", [](WorldSpec& w, double x) { w.contact.torsional_friction = x; }, 0, 10},
    {"contact.rolling_friction", [](WorldSpec& w, double x) { w.contact.rolling_friction = x; }, 0, 10},
    {"contact.softness.impedance_width",
     [](WorldSpec& w, double x) { w.contact.softness.impedance_width = x; }, 0, 1, false},
    {"solver.tolerance", [](WorldSpec& w, double x) { w.solver.tolerance = x; }, 0, 1e-3},
    {"solver.iterations", [](WorldSpec& w, double x) { w.solver.iterations = static_cast<int>(x); }, 1, 1e5},
};

void expect_refused(const WorldRange& range, double value) {
  WorldSpec world = pendulum_world();
  range.set(world, value);
  EXPECT_EQ(config_error([&] { world.validate(); }).element(), range.element) << value;
}

void expect_taken(const WorldRange& range, double value) {
  WorldSpec world = pendulum_world();
  range.set(world, value);
  EXPECT_NO_THROW(world.validate()) << range.element << " " << value;
}

TEST(WorldSpecs, TakeWhatIsInEveryRangeAndNothingElse) {
  EXPECT_NO_THROW(pendulum_world().validate());
  for (const WorldRange& range : kWorldRanges) {
    const bool whole = std::string(range.element) == "solver.iterations";
    const double step = whole ? 1 : 1e-9 * range.high;  // a little, seen from either end
    (range.low_allowed ? expect_taken : expect_refused)(range, range.low);
    (range.high_allowed ? expect_taken : expect_refused)(range, range.high);
    expect_taken(range, range.low + step);
    expect_taken(range, range.high - step);
    expect_refused(range, range.low - step);
    expect_refused(range, range.high + step);
    if (!whole) expect_refused(range, test::kNaN);
  }
}

TEST(WorldSpecs, NeedARobotThatIsOneAndFiniteGravity) {
  EXPECT_EQ(config_error([] { WorldSpec().validate(); }).element(), "robot");
  WorldSpec world = pendulum_world();
  RobotDescription massless = *world.robot;
  massless.bodies[1].inertia.mass = 0;
  world.robot = std::make_shared<const RobotDescription>(massless);
  EXPECT_EQ(config_error([&] { world.validate(); }).element(), "body 'link_1'");
  for (int axis = 0; axis < 3; ++axis) {
    world = pendulum_world();
    world.gravity[axis] = test::kInfinity;
    EXPECT_EQ(config_error([&] { world.validate(); }).element(), "gravity");
  }
}

}  // namespace
}  // namespace crossgait
