// What may differ from episode to episode: a table of named ranges, all of them off unless configured.
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "motion/controller.h"
#include "motion/pushes.h"
#include "physics/core/random.h"
#include "physics/engine/world_spec.h"

namespace crossgait {

/// Lists what is randomised. Scales multiply the configured value; the others add to it.
enum class Randomised : std::size_t {
  kStartX,
  kStartY,
  kStartYaw,
  kStartRoll,
  kStartPitch,
  kStartPhase,
  kFriction,
  kMass,
  kTrunkMass,
  kServoStiffness,
  kJointDamping,
  kEffortLimit,
  kTerrainSeed,
  kPushImpulse,
  kPushInterval,
  kPushCount,
  kJointFriction,
  kStartLift,
  kStartVx,
  kStartVy,
  kStartVz,
  kStartRollRate,
  kStartPitchRate,
  kStartYawRate,
  kStartJointOffset,
  kStartJointScale,
  kStartJointVelocity,
};

/// A row of the table describes what is drawn.
struct RandomisationRow {
  Randomised what;
  std::string_view name, unit, help;
  double neutral;   ///< the value that changes nothing
  double min, max;  ///< what a range must stay within
};

/// Returns the table, in the order of the enumeration.
std::span<const RandomisationRow> randomisation_rows();
/// @throws ConfigError listing the known names
const RandomisationRow& find_randomisation(std::string_view name);

/// Number of rows in the enumeration, of which this is the last.
inline constexpr std::size_t kRandomisations = static_cast<std::size_t>(Randomised::kStartJointVelocity) + 1;

/// Holds a range per row; the neutral ones draw nothing.
struct Randomisation {
  std::array<Range, kRandomisations> ranges;

  Randomisation();
  Range& operator[](Randomised what) { return ranges[static_cast<std::size_t>(what)]; }
  const Range& operator[](Randomised what) const { return ranges[static_cast<std::size_t>(what)]; }
  bool is_on(Randomised what) const;
  /// Tells whether a world has to be built anew for every episode.
  bool changes_world() const;
  /// @throws ConfigError naming the row
  void validate() const;
};

/// Holds one draw of everything. `values` are neutral where nothing is randomised.
struct RandomDraw {
  std::array<double, kRandomisations> values;

  double operator[](Randomised what) const { return values[static_cast<std::size_t>(what)]; }
};

/// Draws every row, also the neutral ones, so that turning one on leaves the others' values as they were.
/// From kJointFriction on rows take their numbers from the one before, so that what `random` gives next is as
/// it was before they were in the table.
RandomDraw draw(const Randomisation& randomisation, Random& random) noexcept;

/// Tells whether episodes begin otherwise than standing.
bool randomises_start(const Randomisation& randomisation);
/// Says where the draw puts the robot down.
Placement placement_of(const RandomDraw& draw) noexcept;

/// Returns the pushes of a motion whose draw is `draw`; none where no impulse is randomised.
/// @param random  goes on from where the draws ended
Pushes pushes_of(const Randomisation& randomisation, const RandomDraw& draw, const Random& random) noexcept;

/// Returns `nominal` with the draw's friction, masses and servos. Masses scale with their inertias; each body
/// but the trunk draws its own factor. The terrain is the caller's: it comes from a text and a seed.
WorldSpec randomised_world(const WorldSpec& nominal, const Randomisation& randomisation,
                           const RandomDraw& draw, Random& random);

}  // namespace crossgait
