// What the numbers of an action or observation vector mean, by name.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace crossgait {

/// What names and units of a layout do not tell: raised whenever a number of the same name changes its
/// meaning (sign, frame, scale of the unit), so that whatever was made for the old meaning is refused and not
/// run wrongly. New, renamed or removed entries need no new version: names tell of them.
///   1  leg frames with z down: residual.*.z > 0 lowered the foot
///   2  leg frames with z up (REP-103): residual.*.z > 0 raises the foot
///   3  ranges and delta scales of gaits that step: param.*, delta.* of 2 were the guide's
inline constexpr int kLayoutVersion = 3;

/// Says the present version in words: "3 (ranges of gaits that step)".
std::string layout_version_in_words();

/// Says what is wrong with the version that a policy states, in words that follow "found ": "1: trained for
/// leg frames with z down". Nothing if it is `kLayoutVersion`.
/// @param stated  as written; a policy that states none is of version 1, which had no such entry
/// @param made    how it came to be: "trained", "written"
std::optional<std::string> layout_version_error(const std::optional<std::string>& stated,
                                                std::string_view made);

/// What the names of an action's entries begin with.
inline constexpr std::string_view kDeltaPrefix = "delta.", kResidualPrefix = "residual.",
                                  kTargetPrefix = "target.";

/// Describes one number of a vector.
struct LayoutEntry {
  std::string name;    ///< unique in its layout, e.g. "delta.step_height", "p_WB.x", "contact.FL"
  std::string unit;    ///< "m", "rad/s", "-"
  double min, max;     ///< what it stays within; infinite where nothing bounds it
  double reach = 1e6;  ///< far beyond what a robot that walks or falls reaches, either way

  /// Returns bounds that are finite, as tools of reinforcement learning expect: `min` and `max`, wider by the
  /// rounding of unit vectors and normalised parameters, or the reach where they are infinite.
  double low() const;
  double high() const;
  bool operator==(const LayoutEntry&) const = default;
};

/// Holds the entries of a vector in order.
struct Layout {
  std::vector<LayoutEntry> entries;

  std::size_t size() const { return entries.size(); }
  std::optional<std::size_t> find(std::string_view name) const;
  std::vector<std::string> names() const;
};

/// Hashes what a policy was trained for: 64-bit FNV-1a over `kLayoutVersion` and the names and units of both
/// layouts, as 16 hexadecimal digits. Ranges do not count: a policy may run where limits differ. Source: RFC
/// draft-eastlake-fnv.
std::string layout_hash(const Layout& observation, const Layout& action);

/// Says where two lists of names differ first, in words that follow "the observation " ("has 69 entries where
/// 71 were expected; entry 65 is param.step_height, expected terrain.front"); empty if they are equal.
std::string layout_difference(const std::vector<std::string>& expected,
                              const std::vector<std::string>& found);

}  // namespace crossgait
