// How a block of numbers is seen: scaled, clipped, noisy, late, with what came before.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace crossgait {

/// Describes an item of an `observation`. By default the block as it is. Of a number x of the block a policy
/// sees clamp(scale clamp(x + n, +-clip_unscaled), +-clip), n uniform in +-noise, as it was `delay` seconds
/// ago; with `history` also as it was in the policy steps before, laid out as HistorySettings say.
struct ObservationTerm {
  std::string block;          ///< name in the table (env/observation.h)
  std::vector<double> scale;  ///< one for all its numbers or one each; empty: 1
  double clip = std::numeric_limits<double>::infinity();
  double clip_unscaled = std::numeric_limits<double>::infinity();  ///< in the unit of the block
  double noise = 0;                                                ///< in the unit of the block
  double delay = 0;                                                ///< s; whole control steps
  int history = 1;

  ObservationTerm() = default;
  // Most terms are no more than the name of a block.
  ObservationTerm(std::string name) : block(std::move(name)) {}  // NOLINT(google-explicit-constructor)
  ObservationTerm(std::string_view name) : block(name) {}        // NOLINT(google-explicit-constructor)
  ObservationTerm(const char* name) : block(name) {}             // NOLINT(google-explicit-constructor)

  /// Tells whether the block is seen as it is.
  bool plain() const {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    return scale.empty() && clip == kNone && clip_unscaled == kNone && noise == 0 && !remembered();
  }
  /// Tells whether seeing the term takes knowing what was.
  bool remembered() const { return delay > 0 || history > 1; }

  bool operator==(const ObservationTerm&) const = default;
};

}  // namespace crossgait
