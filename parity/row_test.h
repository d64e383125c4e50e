// Tests of a row of paired numbers, whichever kind they are.
#pragma once

#include <memory>
#include <string>

#include "parity/judge.h"

namespace crossgait {

/// Tests values, or shares of runs.
/// @param values  of two starts or more; 1 or 0 where `is_share`
/// @param margin  that they are held against: differences of a twentieth of it are too small to matter
std::unique_ptr<const PairedTest> row_test(const PairedValues& values, bool is_share, Estimand estimand,
                                           double margin = 0);

/// Returns the margin for a statistic of the size that `values` have, after so many seconds.
double margin_of(const Statistic& statistic, const PairedValues& values, Estimand estimand, double seconds);
/// Adds to what is there already, behind a semicolon.
void add_reason(StatisticVerdict& verdict, const std::string& reason);
/// Tells whether an outcome came about in no start in one engine alone.
bool is_alike(bool is_share, const PairedValues& values) noexcept;

}  // namespace crossgait
