// A difference that nobody would act on, per statistic: what a verdict judges against.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace crossgait {

/// Holds the larger of a share of the statistic and an absolute amount.
struct Margin {
  double relative = 0;      ///< of the mean size of the statistic in the two engines
  double absolute = 0;      ///< in its unit
  bool per_second = false;  ///< the absolute one is for a second of motion
  std::string reason;       ///< why this much

  /// Returns the margin for a statistic of that size after that many seconds, in its unit.
  double at(double size, double seconds) const noexcept;
  /// Says "2 % or 0.001 m a second"; without the unit where it is "-".
  std::string words(std::string_view unit) const;
};

/// The reason of a margin that is no row of the table.
inline constexpr std::string_view kStatedByUser = "stated by the user";

/// Margins that replace those of the statistics with these keys.
using Margins = std::map<std::string, Margin, std::less<>>;

/// Reads "5%" (of the statistic), "0.02" (in its unit) or "0.02/s" (for a second of motion), or a share and
/// an amount, of which the larger counts: "5%,0.02". @throws ConfigError naming `source` and `key`
Margin parse_margin(std::string_view text, std::string_view source, std::string_view key);

/// Reads "KEY=MARGIN", each onto `margins`. @throws ConfigError
void add_margins(const std::vector<std::string>& assignments, Margins& margins);
/// Reads a YAML file of `KEY: MARGIN`. @throws ConfigError naming file and line
Margins read_margins(const std::string& path);

}  // namespace crossgait
