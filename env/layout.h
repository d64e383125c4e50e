// What the numbers of an action or observation vector mean, by name.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace crossgait {

/// One number of a vector.
struct LayoutEntry {
  std::string name;  ///< unique in its layout, e.g. "delta.step_height", "p_WB.x", "contact.FL"
  std::string unit;  ///< "m", "rad/s", "-"
  double min, max;   ///< what it stays within; infinite where nothing bounds it

  bool operator==(const LayoutEntry&) const = default;
};

/// The entries of a vector in order.
struct Layout {
  std::vector<LayoutEntry> entries;

  std::size_t size() const { return entries.size(); }
  std::optional<std::size_t> find(std::string_view name) const;
  std::vector<std::string> names() const;
};

/// 64-bit FNV-1a over the names and units of both layouts, as 16 hexadecimal digits: what a policy was
/// trained for. Ranges do not count: a policy may run where limits differ. Source: RFC draft-eastlake-fnv.
std::string layout_hash(const Layout& observation, const Layout& action);

/// The first place where two lists of names differ, in words that follow "the observation " ("has 69 entries
/// where 71 were expected; entry 65 is param.step_height, expected terrain.front"); empty if they are equal.
std::string layout_difference(const std::vector<std::string>& expected,
                              const std::vector<std::string>& found);

}  // namespace crossgait
