#include "motion/outcome.h"

#include <cmath>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/find_row.h"

namespace crossgait {
namespace {

constexpr std::array kOutcomeRows{
    OutcomeRow{Outcome::kDiverged, "diverged", "diverged", true},
    OutcomeRow{Outcome::kLoopViolated, "loop_violated", "loop violated", true},
    OutcomeRow{Outcome::kFell, "fell", "fell", true},
    OutcomeRow{Outcome::kCollapsed, "collapsed", "collapsed", true},
    OutcomeRow{Outcome::kLeftTerrain, "left_terrain", "left the terrain", true},
    OutcomeRow{Outcome::kSlid, "slid", "slid", false},
    OutcomeRow{Outcome::kNoProgress, "no_progress", "no progress", false},
    OutcomeRow{Outcome::kWalked, "walked", "walked", false},
};
static_assert(
    [] {
      for (std::size_t i = 0; i < kOutcomeRows.size(); ++i) {
        if (kOutcomeRows[i].outcome != static_cast<Outcome>(i)) return false;
      }
      return kOutcomeRows.size() == kOutcomes;
    }(),
    "one row for each Outcome, in its order");

}  // namespace

std::span<const OutcomeRow> outcome_rows() { return kOutcomeRows; }

std::string_view name(Outcome outcome) noexcept {
  return kOutcomeRows[static_cast<std::size_t>(outcome)].name;
}

Outcome find_outcome(std::string_view name) {
  return find_row(kOutcomeRows, name, "outcome", "name").outcome;
}

std::vector<std::string> outcome_names(const OutcomeSet& set) {
  std::vector<std::string> names;
  for (const OutcomeRow& row : kOutcomeRows) {
    if (set.has(row.outcome)) names.emplace_back(row.name);
  }
  return names;
}

Outcome find_termination(std::string_view name) {
  const Outcome outcome = find_outcome(name);
  if (!kOutcomeRows[static_cast<std::size_t>(outcome)].at_once)
    throw ConfigError("outcome", "terminations", "outcomes that are known the moment they happen",
                      std::string(name));
  return outcome;
}

OutcomeSet OutcomeSet::of_names(const std::vector<std::string>& names) {
  OutcomeSet set = of_walks();
  for (const std::string& name : names) set.add(find_termination(name));
  return set;
}

OutcomeSet OutcomeSet::of_episodes() noexcept {
  OutcomeSet set;
  for (const OutcomeRow& row : kOutcomeRows) {
    if (row.at_once) set.add(row.outcome);
  }
  return set;
}

void OutcomeLimits::validate(std::string_view source) const {
  const auto require = [&](std::string_view element, double value, double most) {
    if (!(value > 0 && value <= most))
      throw ConfigError(source, element, fmt::format("a number in (0, {:g}]", most),
                        fmt::format("{:g}", value));
  };
  require("tilt_limit_deg", tilt_deg, 180);
  require("low_height", low_height, 1);
  require("nonfoot_contact_load", nonfoot_contact_load, 1);
  require("low_seconds", low_seconds, 1e6);
  require("load_smoothing", load_smoothing, 1e6);
  require("loop_gap", loop_gap, 1e6);
  require("slip", slip, 1e6);
  require("slip_path", slip_path, 1e6);
  require("progress", progress, 1);
  require("commanded_path", commanded_path, 1e6);
  require("commanded_turn", commanded_turn, 1e6);
}

}  // namespace crossgait
