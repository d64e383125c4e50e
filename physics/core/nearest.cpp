#include "physics/core/nearest.h"

#include <algorithm>

namespace crossgait {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t k = 0; k <= b.size(); ++k) {
      if (i == 0 || k == 0) {
        d[i][k] = i + k;
        continue;
      }
      const std::size_t replaced = d[i - 1][k - 1] + (a[i - 1] == b[k - 1] ? 0 : 1);
      d[i][k] = std::min({replaced, d[i - 1][k] + 1, d[i][k - 1] + 1});
      if (i > 1 && k > 1 && a[i - 1] == b[k - 2] && a[i - 2] == b[k - 1])
        d[i][k] = std::min(d[i][k], d[i - 2][k - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

std::string nearest(std::string_view word, const std::vector<std::string>& known) {
  const auto best = std::min_element(known.begin(), known.end(), [&word](const auto& a, const auto& b) {
    return edit_distance(word, a) < edit_distance(word, b);
  });
  const std::size_t letters = word.size() - std::min(word.size(), word.find_first_not_of('-'));
  const std::size_t most = std::max<std::size_t>(1, letters / 3);
  // Of a single letter nothing would be left.
  if (best != known.end() && edit_distance(word, *best) <= most && edit_distance(word, *best) < letters)
    return *best;
  // The beginning of one name alone: "slip" of slip_m.
  constexpr std::size_t kFewest = 3;
  const auto begins = [&word](const std::string& name) { return name.starts_with(word); };
  const auto only = std::find_if(known.begin(), known.end(), begins);
  const bool is_only = only != known.end() && std::none_of(only + 1, known.end(), begins);
  return letters >= kFewest && is_only ? *only : "";
}

}  // namespace crossgait
