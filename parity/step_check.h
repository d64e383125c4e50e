// What half the time step changes of a word.
#pragma once

#include "parity/judge.h"

namespace crossgait {

/// Holds errors that a row has.
struct RowErrors {
  double tail = 0;          ///< of each one-sided test behind *agrees*
  double simultaneous = 0;  ///< of an interval
  double level = 0;         ///< of the test behind *differs*
};

/// Fills in `verdict.step`, and makes *step-dependent* or *unresolved* of a word that half the step does not
/// bear out; never *agrees*. Over the time that all four runs last, against the margin for that time.
void check_step(const StatisticRuns& runs, const RowErrors& errors, StatisticVerdict& verdict);

}  // namespace crossgait
