// A gait as data: when each leg swings, and what the parts of its cycle are called.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "gait/parameters.h"

namespace crossgait {

/// Names a part of the cycle, from `start` (fraction of the cycle) to the start of the next.
struct GaitPhase {
  std::string_view name;
  double start = 0;
};

inline constexpr int kMaxGaitPhases = 8;

/// Describes a gait. Copying allocates nothing; texts must outlive the gait (string literals do).
struct Gait {
  std::string_view name, summary;
  LegArray<double> offset = {};   ///< phase of the clock at which each leg lifts off, in [0, 1)
  GaitParameters preferred = {};  ///< what the gait walks with unless told otherwise
  /// Those of robots with serial legs, at the size that the table is for (gait/scale.h); empty: the same.
  std::optional<GaitParameters> preferred_serial = {};
  /// Ascending, the first at 0; unnamed ones are unused. They are those at the preferred duty factor.
  std::array<GaitPhase, kMaxGaitPhases> phases = {};
};

/// Lists trot, walk, pace, bound, pronk, gallop; and trot, walk and gallop with the numbers of the guide
/// ("trot:guide").
std::span<const Gait> gaits();

/// @throws ConfigError listing the known names
const Gait& find_gait(std::string_view name);

/// Names the part of the cycle that `phase` (in [0, 1)) falls in.
std::string_view phase_name(const Gait& gait, double phase) noexcept;

/// @throws ConfigError naming the gait and the field: offsets in [0, 1), phases named and ascending from 0,
///   preferred parameters valid
void validate(const Gait& gait);

/// Says where a leg is in its own cycle.
struct LegPhase {
  double phase = 0;     ///< since lift-off, in [0, 1)
  bool swing = false;   ///< the first 1 - duty of it
  double progress = 0;  ///< through the swing or the stance, in [0, 1]
};

/// @param clock  phase of the gait's clock, in [0, 1)
LegPhase leg_phase(double clock, double offset, double duty) noexcept;

}  // namespace crossgait
