// Rows of tables by their names, with one message where there is none of that name.
#pragma once

#include <algorithm>
#include <functional>
#include <iterator>
#include <ranges>
#include <string>
#include <string_view>
#include <vector>

namespace crossgait {

/// Refuses a name that is none of `known`: "expected one of trot, walk, found 'trott' (did you mean trot?)".
/// @param also  what else may stand in its place, behind the list: ", FILE.png or FILE.csv"
/// @throws ConfigError naming `source` and `element`
[[noreturn]] void fail_unknown_name(std::string_view name, const std::vector<std::string>& known,
                                    std::string_view source, std::string_view element,
                                    std::string_view also = "");

/// Finds the row of that name.
///
///     return find_row(kGaits, name, "gait", "name");
///
/// @param name_of  gives the name of a row: a member, or a function
/// @returns a reference into `rows`  @throws ConfigError as `fail_unknown_name`
template <std::ranges::forward_range Rows, typename NameOf>
auto& find_row(const Rows& rows, std::string_view name, std::string_view source, std::string_view element,
               NameOf name_of, std::string_view also = "") {
  const auto found = std::ranges::find_if(
      rows, [&](const auto& row) { return std::string_view(std::invoke(name_of, row)) == name; });
  if (found != std::ranges::end(rows)) return *found;
  std::vector<std::string> known;
  for (const auto& row : rows) known.emplace_back(std::invoke(name_of, row));
  fail_unknown_name(name, known, source, element, also);
}

/// Finds the row whose member is `name`.
template <std::ranges::forward_range Rows>
auto& find_row(const Rows& rows, std::string_view name, std::string_view source, std::string_view element) {
  return find_row(rows, name, source, element, [](const auto& row) { return std::string_view(row.name); });
}

}  // namespace crossgait
