// The statistics of a motion as a table: everything that shows, judges, averages, compares or documents them
// follows from its rows. A new statistic is a member of MotionSummary, the sum behind it
// (motion/motion_statistics) and a row here.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "motion/motion_statistics.h"

namespace crossgait {

/// Reads from a summary whether an outcome held at any time.
struct OutcomeHeld {
  Outcome outcome;
  bool operator==(const OutcomeHeld&) const = default;
};
/// Reads from a summary when an outcome first held, s.
struct OutcomeTime {
  Outcome outcome;
  bool operator==(const OutcomeTime&) const = default;
};

/// Says where a summary holds a value of a statistic. Its type is the type in JSON; an absent value is null.
using StatisticSource = std::variant<double MotionSummary::*, std::optional<double> MotionSummary::*,
                                     std::int64_t MotionSummary::*, LegArray<double> MotionSummary::*,
                                     Vector3 MotionSummary::*, OutcomeHeld, OutcomeTime>;

/// Says how tables of walks show a statistic; not at all without a label.
struct StatisticText {
  std::string_view label;        ///< with the unit
  int digits = 0;                ///< after the point
  double factor = 1;             ///< on the value, where the label has another unit
  std::string_view before = {};  ///< key of an earlier row that this one is shown before
};

/// Says what a margin of the judge, given for the reference robot (gait/scale.h), grows with.
enum class MarginScale : std::uint8_t { kFixed, kLength, kSpeed };

/// Says how a verdict judges a statistic; not at all without a name. The margin is a difference that nobody
/// would act on: the larger of a share of the statistic and an absolute amount, which grows with the length
/// of a motion where the statistic itself does. Margins are chosen, not measured: no logs of one robot's
/// repeated runs come with Crossgait.
struct StatisticJudged {
  std::string_view name;
  double relative_margin = 0, absolute_margin = 0;
  bool per_second = false;  ///< the absolute one is for a second of motion
  std::string_view reason;  ///< for the margin
  MarginScale scale = MarginScale::kFixed;
  bool needs_plan = false;       ///< judged only where swing and stance are planned
  std::string_view before = {};  ///< key of an earlier row that this one is judged before
};

/// Says what becomes of a statistic over a set of episodes.
enum class OverEpisodes : std::uint8_t {
  kNone,
  kMean,  ///< and deviation, over the episodes that have a value
  kSum,   ///< of a count
};

/// Says how episodes are summed up.
struct StatisticAverage {
  OverEpisodes how = OverEpisodes::kNone;
  std::optional<int> digits = {};  ///< after the point in tables; without, tables do not show it
  bool deviation = false;          ///< tables show the deviation, too
  std::string_view before = {};    ///< key of an earlier row that JSON has it before
};

/// Describes one statistic.
struct StatisticRow {
  std::string_view key;   ///< in JSON, in schemas and in Python
  std::string_view unit;  ///< "-" of a pure number
  std::string_view help;  ///< what it is, in docs and schemas
  StatisticSource source;
  StatisticText text = {};
  StatisticJudged judged = {};
  StatisticAverage average = {};
};

/// Lists every statistic, in the order of JSON. `outcome` and `outcome_at_s` stand before them there.
std::span<const StatisticRow> statistic_rows();
/// Lists the rows that tables of walks show, that verdicts judge, and that episodes are summed up by.
const std::vector<const StatisticRow*>& shown_statistics();
const std::vector<const StatisticRow*>& judged_statistics();
const std::vector<const StatisticRow*>& averaged_statistics();

/// Finds the row that reads `source`. @throws std::logic_error if none does
const StatisticRow& statistic_row(const StatisticSource& source);

/// Reads a statistic as one number: the mean of legs, 1 or 0 for an outcome that held or did not.
/// @returns empty for what the motion has no value of, and for positions
std::optional<double> number_of(const StatisticRow& row, const MotionSummary& motion) noexcept;
/// Writes the statistic as tables of walks show it, "-" if it is empty.
std::string text_of(const StatisticRow& row, const MotionSummary& motion);

}  // namespace crossgait
