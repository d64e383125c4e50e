// How a motion ended, or went on: what every walk, episode and verdict calls by the same name.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace crossgait {

/// Lists outcomes from worst to best. Where several hold, the first of this list is the outcome.
enum class Outcome : std::uint8_t {
  kDiverged,      ///< the engine produced a state that is not finite
  kLoopViolated,  ///< a loop of the mechanism opened: the numbers no longer describe the machine
  kFell,          ///< roll or pitch beyond a limit
  kCollapsed,     ///< down: a body other than a foot carried the weight, or the base hung low, for a while
  kTerminated,    ///< a termination of the user's own ended it
  kLeftTerrain,   ///< the base left the height field
  kSlid,          ///< moved, but by sliding feet rather than by steps
  kNoProgress,    ///< made next to nothing of the way or the turn that was asked for, in any direction
  kBackward,      ///< went, or turned, the other way
  kStrayed,       ///< went more across the command's direction than along it
  kTooSlow,       ///< went the right way, but less than half of it, or turned less than half
  kWalked,        ///< none of the above
};
/// Number of outcomes in the enumeration, of which this is the last.
inline constexpr std::size_t kOutcomes = static_cast<std::size_t>(Outcome::kWalked) + 1;

struct OutcomeLimits;

/// A row of the table describes an outcome.
struct OutcomeRow {
  Outcome outcome;
  std::string_view name;   ///< in JSON and YAML: "loop_violated"
  std::string_view words;  ///< in tables: "loop violated"
  /// Words in sentences, after a subject; {} is how far it came: "made no progress ({})".
  std::string_view phrase;
  bool at_once;  ///< known the moment it happens, and may end a motion; the others at its end alone
  std::string (*holds)(const OutcomeLimits& limits);  ///< says when, in the documents
  std::string_view reason;                            ///< of the limits, in the documents
};

/// Returns the table, in the order of the enumeration.
std::span<const OutcomeRow> outcome_rows();
const OutcomeRow& outcome_row(Outcome outcome) noexcept;
std::string_view name(Outcome outcome) noexcept;
/// Tells if a motion may end before its time by it: what is known at once, and a termination.
bool ends_early(Outcome outcome) noexcept;
/// Tells if it is a fall, collapse, open loop, divergence or a termination: whatever ends a motion but
/// leaving the ground.
bool is_failure(Outcome outcome) noexcept;
struct OutcomeSet;
/// Lists the names in the order of the table.
std::vector<std::string> outcome_names(const OutcomeSet& set);
/// @throws ConfigError listing the known names
Outcome find_outcome(std::string_view name);
/// Finds an outcome to end a motion. @throws ConfigError also for an outcome that is known at the end alone
Outcome find_termination(std::string_view name);

/// Holds some of the outcomes.
struct OutcomeSet {
  std::array<bool, kOutcomes> in{};

  bool has(Outcome outcome) const noexcept { return in[static_cast<std::size_t>(outcome)]; }
  OutcomeSet& add(Outcome outcome) noexcept {
    in[static_cast<std::size_t>(outcome)] = true;
    return *this;
  }
  bool operator==(const OutcomeSet&) const = default;
  /// Returns the named outcomes, and divergence, after which nothing goes on. @throws ConfigError for an
  /// unknown name, or an outcome that is known at the end alone
  static OutcomeSet of_names(const std::vector<std::string>& names);

  /// Returns what ends a walk: the end of its terrain, beyond which it would be of a fall into nothing, and
  /// divergence. Not a fall, so that it is on the trace.
  static OutcomeSet of_walks() noexcept {
    return OutcomeSet().add(Outcome::kDiverged).add(Outcome::kLeftTerrain);
  }
  /// Returns what ends an episode: everything after which walking on means nothing.
  static OutcomeSet of_episodes() noexcept;
};

/// Says when an outcome holds. Lengths are in leg lengths: the height of the hips' middle in the home pose
/// (`leg_length`), which is the robot's, wherever its file has the base's frame.
struct OutcomeLimits {
  double tilt_deg = 60;     ///< fell: |roll| or |pitch| beyond this, degrees
  double low_height = 0.5;  ///< collapsed: hips' middle below this share of the height it was put down at ...
  double nonfoot_contact_load =
      0.5;                   ///< ... or bodies other than feet carry more than this share of the weight ...
  double low_seconds = 0.5;  ///< ... for this long without a break, s
  double load_smoothing = 0.1;  ///< time constant of that load, s: contact forces come in blows
  double loop_gap = 0.05;       ///< loop violated: a loop opens beyond this, leg lengths
  /// Slid: the way that loaded stance feet slid, over the way that the base made meanwhile, beyond this (a
  /// glide is 1, a trot 0.03 to 0.08, the worst gallop 0.5) ...
  double slip = 0.75;
  double slip_path = 1;         ///< ... if the base went further than this, leg lengths
  double commanded_path = 1;    ///< a way is judged if more than this was asked for, leg lengths
  double commanded_turn = 0.5;  ///< a turn, if more than this was, rad
  double no_progress = 0.1;     ///< no progress: less than this share of it, in any direction ...
  /// ... and slower than this share of sqrt(g leg length), the speed whose Froude number is one.
  double no_progress_speed = 0.05;
  /// Strayed: the way made is this far off the command's direction, degrees; backward: this near to its
  /// opposite.
  double strayed_deg = 45;
  double too_slow = 0.5;  ///< too slow: less than this share of the way, along the command, or of the turn

  /// @throws ConfigError naming `source` and the limit
  void validate(std::string_view source) const;
};

}  // namespace crossgait
