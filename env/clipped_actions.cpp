#include "env/clipped_actions.h"

#include <algorithm>
#include <cassert>
#include <numeric>

#include <fmt/format.h>

namespace crossgait {

void ClippedActions::add(const Layout& action, std::span<const std::int64_t> counts,
                         std::int64_t steps_of_episode) {
  add({action.names(), {counts.begin(), counts.end()}, steps_of_episode});
}

void ClippedActions::add(const ClippedActions& others) {
  if (names.empty()) {
    names = others.names;
    clipped.assign(others.clipped.size(), 0);
  }
  assert((others.names.empty() || names == others.names) && "actions of one layout");
  for (std::size_t i = 0; i < std::min(clipped.size(), others.clipped.size()); ++i)
    clipped[i] += others.clipped[i];
  steps += others.steps;
}

double ClippedActions::ratio() const noexcept {
  const auto all = static_cast<double>(steps) * static_cast<double>(clipped.size());
  const auto sum = std::accumulate(clipped.begin(), clipped.end(), std::int64_t{0});
  return all > 0 ? static_cast<double>(sum) / all : 0;
}

std::optional<ClippedActions::Worst> ClippedActions::worst() const {
  const auto most = std::max_element(clipped.begin(), clipped.end());
  if (most == clipped.end() || *most == 0) return std::nullopt;
  return Worst{names[static_cast<std::size_t>(most - clipped.begin())],
               static_cast<double>(*most) / static_cast<double>(steps)};
}

std::string note_on_clipping(const std::string& policy, const ClippedActions& actions) {
  const auto worst = actions.worst();
  if (!worst || actions.ratio() < kNotableClipping) return "";
  return fmt::format(
      "{}: {:.0f} % of its actions are beyond the environment's bounds and were clipped ({}: in {:.0f} % of "
      "the "
      "steps); was it made for wider ones (`limit`, docs/environment.md), or for another scale?",
      policy, 100 * actions.ratio(), worst->name, 100 * worst->ratio);
}

}  // namespace crossgait
