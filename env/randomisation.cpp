#include "env/randomisation.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/find_row.h"
#include "physics/engine/world_quantities.h"

namespace crossgait {
namespace {

constexpr double kPi = 3.14159265358979323846;
using enum Randomised;

constexpr std::array kRandomisationRows{
    RandomisationRow{kStartX, "start_x", "m", "start, forward of the origin", 0, -100, 100},
    RandomisationRow{kStartY, "start_y", "m", "start, to the left of the origin", 0, -100, 100},
    RandomisationRow{kStartYaw, "start_yaw", "rad", "heading at the start", 0, -kPi, kPi},
    RandomisationRow{kStartRoll, "start_roll", "rad", "roll at the start", 0, -0.5, 0.5},
    RandomisationRow{kStartPitch, "start_pitch", "rad", "pitch at the start", 0, -0.5, 0.5},
    RandomisationRow{kStartPhase, "start_phase", "-", "phase of the gait's clock at the start", 0, 0, 1},
    RandomisationRow{kFriction, "friction", "x", "scale of the friction coefficient", 1, 0, 10},
    RandomisationRow{kMass, "mass", "x", "scale of every other body's mass and inertia, each its own", 1, 0.1,
                     10},
    RandomisationRow{kTrunkMass, "trunk_mass", "x", "scale of the trunk's mass and inertia", 1, 0.1, 10},
    RandomisationRow{kServoStiffness, "servo_stiffness", "x", "scale of the servos' gains", 1, 0.1, 10},
    RandomisationRow{kJointDamping, "joint_damping", "x", "scale of the joints' damping", 1, 0, 10},
    RandomisationRow{kEffortLimit, "effort_limit", "x", "scale of the servos' largest torque", 1, 0.1, 10},
    RandomisationRow{kTerrainSeed, "terrain_seed", "-", "seed of the terrain's generator, whole numbers", -1,
                     0, 1e9},
    // Of a robot of 100 kg, 1 m/s takes 100 N s.
    RandomisationRow{kPushImpulse, "push_impulse", "N s", "sideways push on the trunk, from any direction", 0,
                     0, 1e4},
    RandomisationRow{kPushInterval, "push_interval", "s", "time to the first push and between two", 0, 0,
                     1e6},
    RandomisationRow{kPushCount, "push_count", "-", "pushes at most, whole numbers; 0 for no limit", 0, 0,
                     1e6},
    RandomisationRow{kJointFriction, "joint_friction", "x", "scale of the joints' dry friction", 1, 0, 10},
    RandomisationRow{kStartLift, "start_lift", "m", "start, above where the feet just touch", 0, 0, 10},
    RandomisationRow{kStartVx, "start_vx", "m/s", "velocity at the start, ahead", 0, -20, 20},
    RandomisationRow{kStartVy, "start_vy", "m/s", "velocity at the start, to the left", 0, -20, 20},
    RandomisationRow{kStartVz, "start_vz", "m/s", "velocity at the start, upwards", 0, -20, 20},
    RandomisationRow{kStartRollRate, "start_roll_rate", "rad/s", "turning at the start, about ahead", 0, -50,
                     50},
    RandomisationRow{kStartPitchRate, "start_pitch_rate", "rad/s", "turning at the start, about left", 0, -50,
                     50},
    RandomisationRow{kStartYawRate, "start_yaw_rate", "rad/s", "turning at the start, about up", 0, -50, 50},
    RandomisationRow{kStartJointOffset, "start_joint_offset", "rad",
                     "angle of every servo at the start from home, each its own", 0, -kPi, kPi},
    RandomisationRow{kStartJointScale, "start_joint_scale", "x",
                     "scale of every servo's home angle at the start, each its own", 1, 0, 10},
    RandomisationRow{kStartJointVelocity, "start_joint_velocity", "rad/s",
                     "velocity of every servo at the start, each its own", 0, -100, 100},
};
static_assert(
    [] {
      for (std::size_t i = 0; i < kRandomisationRows.size(); ++i) {
        if (kRandomisationRows[i].what != static_cast<Randomised>(i)) return false;
      }
      return kRandomisationRows.size() == kRandomisations;
    }(),
    "one row for each of Randomised, in its order");

// Which quantities of a world a row scales.
constexpr std::pair<Randomised, std::string_view> kScaled[] = {
    {kFriction, "friction"},
    {kTrunkMass, "trunk_mass"},
    {kServoStiffness, "kp"},
    {kServoStiffness, "kd"},
    {kJointDamping, "damping"},
    {kEffortLimit, "effort"},
    {kJointFriction, "joint_friction"},
};

}  // namespace

std::span<const RandomisationRow> randomisation_rows() { return kRandomisationRows; }

const RandomisationRow& find_randomisation(std::string_view name) {
  return find_row(kRandomisationRows, name, "randomisation", "name");
}

Randomisation::Randomisation() {
  for (std::size_t i = 0; i < kRandomisationRows.size(); ++i)
    ranges[i] = {kRandomisationRows[i].neutral, kRandomisationRows[i].neutral};
}

bool Randomisation::is_on(Randomised what) const {
  const double neutral = kRandomisationRows[static_cast<std::size_t>(what)].neutral;
  return (*this)[what] != Range{neutral, neutral};
}

bool Randomisation::changes_world() const {
  for (const Randomised what : {kFriction, kMass, kTrunkMass, kServoStiffness, kJointDamping, kEffortLimit,
                                kTerrainSeed, kJointFriction}) {
    if (is_on(what)) return true;
  }
  return false;
}

void Randomisation::validate() const {
  for (const RandomisationRow& row : kRandomisationRows) {
    if (!is_on(row.what)) continue;
    const Range& range = (*this)[row.what];
    if (!(range.min >= row.min && range.max <= row.max && range.min <= range.max)) {
      throw ConfigError("randomisation", row.name,
                        fmt::format("a range [min, max] within [{:g}, {:g}] {}", row.min, row.max, row.unit),
                        fmt::format("[{:g}, {:g}]", range.min, range.max));
    }
  }
  if (is_on(kPushImpulse) != is_on(kPushInterval)) {
    throw ConfigError("randomisation", "push_impulse", "push_impulse and push_interval together",
                      "one of them");
  }
}

RandomDraw draw(const Randomisation& randomisation, Random& random) noexcept {
  RandomDraw result{};
  double u = 0;
  for (std::size_t i = 0; i < kRandomisationRows.size(); ++i) {
    const Range& range = randomisation.ranges[i];
    u = kRandomisationRows[i].what < kJointFriction ? random.uniform()
                                                    : Random(std::bit_cast<std::uint64_t>(u)).uniform();
    result.values[i] = kRandomisationRows[i].what == kTerrainSeed && range.max >= 0
                           ? std::floor(range.min + (range.max + 1 - range.min) * u)
                           : range.min + (range.max - range.min) * u;
  }
  return result;
}

bool randomises_start(const Randomisation& randomisation) {
  return std::any_of(
      std::begin(kRandomisationRows), std::end(kRandomisationRows),
      [&](const RandomisationRow& row) { return row.what >= kStartLift && randomisation.is_on(row.what); });
}

Placement placement_of(const RandomDraw& draw) noexcept {
  return {draw[kStartX], draw[kStartY], draw[kStartRoll], draw[kStartPitch], draw[kStartYaw]};
}

Pushes pushes_of(const Randomisation& randomisation, const RandomDraw& draw, const Random& random) noexcept {
  if (!randomisation.is_on(Randomised::kPushImpulse)) return {};
  return {randomisation[Randomised::kPushImpulse], randomisation[Randomised::kPushInterval],
          draw[Randomised::kPushInterval], std::lround(draw[Randomised::kPushCount]), random};
}

WorldSpec randomised_world(const WorldSpec& nominal, const Randomisation& randomisation,
                           const RandomDraw& draw, Random& random) {
  WorldSpec world = nominal;
  auto robot = std::make_shared<RobotDescription>(*nominal.robot);
  for (const auto& [what, quantity] : kScaled)
    find_world_quantity(quantity, "randomisation").scale(world, *robot, draw[what]);
  const Range& mass = randomisation[kMass];
  for (Body& body : std::span(robot->bodies).subspan(1)) scale_mass(body, random.uniform(mass.min, mass.max));
  world.robot = std::move(robot);
  return world;
}

}  // namespace crossgait
