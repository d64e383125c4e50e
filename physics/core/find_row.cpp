#include "physics/core/find_row.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/error.h"
#include "physics/core/nearest.h"

namespace crossgait {

void fail_unknown_name(std::string_view name, const std::vector<std::string>& known, std::string_view source,
                       std::string_view element, std::string_view also) {
  // Text of any length may stand where a name was expected: nobody mistyped that, and its beginning will do.
  constexpr std::size_t kLongestName = 60;
  const std::string near = name.size() <= kLongestName ? nearest(name, known) : "";
  const std::string expected = known.empty() ? "none" : fmt::format("one of {}", fmt::join(known, ", "));
  throw ConfigError(source, element, expected + std::string(also),
                    near.empty() ? fmt::format("'{}'", printable_text(name, kLongestName))
                                 : fmt::format("'{}' (did you mean {}?)", name, near));
}

}  // namespace crossgait
