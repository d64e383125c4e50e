// How much of what a policy asked for was beyond the bounds of actions.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "policy/layout.h"

namespace crossgait {

/// Counts, by entry of the action, the steps in which it was beyond its bounds and clipped.
struct ClippedActions {
  struct Worst {
    std::string name;  ///< of the entry that was clipped most often
    double ratio = 0;  ///< of its steps
  };

  std::vector<std::string> names;     ///< of the entries; none before anything is added
  std::vector<std::int64_t> clipped;  ///< by entry
  std::int64_t steps = 0;

  /// Adds the steps of an episode. @param counts  one per entry of the layout
  void add(const Layout& action, std::span<const std::int64_t> counts, std::int64_t steps_of_episode);
  /// Adds others of the same layout.
  void add(const ClippedActions& others);

  /// Returns the share of all entries in all steps; 0 without any.
  double ratio() const noexcept;
  /// Finds the entry that was clipped most often; empty if nothing was.
  std::optional<Worst> worst() const;
};

/// From this share on, what is clipped is a note: a policy that reaches a bound now and then is not another
/// one for it, one that is clipped in every twentieth number may well be.
inline constexpr double kNotableClipping = 0.05;

/// Says what may be wrong, "NAME: 92 % of ..."; empty below kNotableClipping.
std::string note_on_clipping(const std::string& policy, const ClippedActions& actions);

}  // namespace crossgait
