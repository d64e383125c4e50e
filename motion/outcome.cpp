#include "motion/outcome.h"

#include <cmath>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/find_row.h"

namespace crossgait {
namespace {

using L = OutcomeLimits;

// NOLINTNEXTLINE(readability-function-size): a table
constexpr std::array kOutcomeRows{
    OutcomeRow{Outcome::kDiverged, "diverged", "diverged", "diverged", true,
               [](const L&) -> std::string { return "the engine's state is not finite or has run away"; },
               "340 m/s, 10 000 rad/s or 1000 km are beyond any legged machine"},
    OutcomeRow{Outcome::kLoopViolated, "loop_violated", "loop violated", "violated a loop", true,
               [](const L& l) { return fmt::format("a loop opens beyond {:g} leg lengths", l.loop_gap); },
               "the numbers no longer describe the machine"},
    OutcomeRow{Outcome::kFell, "fell", "fell", "fell", true,
               [](const L& l) {
                 return fmt::format("roll or pitch beyond {:g} degrees (`tilt_limit_deg`)", l.tilt_deg);
               },
               "no gait leans so far, and none comes back"},
    OutcomeRow{Outcome::kCollapsed, "collapsed", "collapsed", "collapsed", true,
               [](const L& l) {
                 return fmt::format(
                     "for {:g} s without a break the middle of the hips is below {:g} of the height it was "
                     "put down at, or bodies "
                     "other than feet carry more than {:g} of the weight (smoothed over {:g} s)",
                     l.low_seconds, l.low_height, l.nonfoot_contact_load, l.load_smoothing);
               },
               "it lies, rather than stands on its feet; a stumble is shorter"},
    OutcomeRow{
        Outcome::kTerminated, "terminated", "terminated", "was terminated", false,
        [](const L&) -> std::string {
          return "a termination of the user's own ended the episode: a term of Python's, or `end_episodes`";
        },
        "whoever trains says so"},
    OutcomeRow{Outcome::kLeftTerrain, "left_terrain", "left the terrain", "left the terrain", true,
               [](const L&) -> std::string { return "the base is off the height field"; },
               "there is nothing to walk on"},
    OutcomeRow{Outcome::kSlid, "slid", "slid", "slid {}", false,
               [](const L& l) {
                 return fmt::format(
                     "loaded stance feet slid more than {:g} of the way that the base made "
                     "meanwhile, and the base went further than {:g} leg lengths",
                     l.slip, l.slip_path);
               },
               "a glide is 1.00 to 1.03, a trot 0.03 to 0.08, the worst gallop 0.52"},
    OutcomeRow{Outcome::kNoProgress, "no_progress", "no progress", "made no progress ({})", false,
               [](const L& l) {
                 return fmt::format(
                     "of the way asked for (more than {:g} leg lengths) less than {:g} was made, in "
                     "whatever direction, and at less than {:g} of sqrt(g leg length); or of a turn "
                     "alone (more than {:g} rad) less than {:g}, in either sense",
                     l.commanded_path, l.no_progress, l.no_progress_speed, l.commanded_turn, l.no_progress);
               },
               "next to nothing, for what was asked and for the robot: 4 cm/s on legs of 7 cm"},
    OutcomeRow{Outcome::kBackward, "backward", "backward", "went {}", false,
               [](const L& l) {
                 return fmt::format(
                     "the way made is within {:g} degrees of the opposite of the command's direction; "
                     "or a turn alone went the other way",
                     l.strayed_deg);
               },
               "more backward than sideways"},
    OutcomeRow{Outcome::kStrayed, "strayed", "strayed", "strayed {}", false,
               [](const L& l) {
                 return fmt::format("the way made is more than {:g} degrees off the command's direction",
                                    l.strayed_deg);
               },
               "more sideways than forward"},
    OutcomeRow{Outcome::kTooSlow, "too_slow", "too slow", "was too slow ({})", false,
               [](const L& l) {
                 return fmt::format(
                     "less than {:g} of the way asked for was made along the command, or less than "
                     "{:g} of the turn",
                     l.too_slow, l.too_slow);
               },
               "nearer to standing than to what was asked for"},
    OutcomeRow{Outcome::kWalked, "walked", "walked", "walked {}", false,
               [](const L&) -> std::string { return "none of these"; }, ""},
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

const OutcomeRow& outcome_row(Outcome outcome) noexcept {
  return kOutcomeRows[static_cast<std::size_t>(outcome)];
}

std::string_view name(Outcome outcome) noexcept { return outcome_row(outcome).name; }

bool ends_early(Outcome outcome) noexcept {
  return outcome_row(outcome).at_once || outcome == Outcome::kTerminated;
}

bool is_failure(Outcome outcome) noexcept { return ends_early(outcome) && outcome != Outcome::kLeftTerrain; }

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
  std::vector<const OutcomeRow*> at_once;
  for (const OutcomeRow& row : kOutcomeRows) {
    if (row.at_once) at_once.push_back(&row);
    if (row.name == name && !row.at_once)
      throw ConfigError("outcome", "terminations", "outcomes that are known the moment they happen",
                        std::string(name));
  }
  return find_row(at_once, name, "outcome", "terminations", &OutcomeRow::name)->outcome;
}

OutcomeSet OutcomeSet::of_names(const std::vector<std::string>& names) {
  OutcomeSet set = OutcomeSet().add(Outcome::kDiverged);
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
  require("commanded_path", commanded_path, 1e6);
  require("commanded_turn", commanded_turn, 1e6);
  require("no_progress", no_progress, 1);
  require("no_progress_speed", no_progress_speed, 1e6);
  require("strayed_deg", strayed_deg, 90);
  require("too_slow", too_slow, 1);
}

}  // namespace crossgait
