// Tests of a row of paired numbers, whichever kind they are.
#pragma once

#include <variant>

#include "parity/judge.h"
#include "parity/paired_shares.h"

namespace crossgait {

/// Of values, or of shares of runs.
using RowTest = std::variant<PairedDifferences, PairedShares>;

/// @param values  of two starts or more; 1 or 0 where `is_share`
RowTest row_test(const PairedValues& values, bool is_share, Estimand estimand);

Interval interval(const RowTest& test, double confidence);
double p_beyond(const RowTest& test, double margin);
double p_within(const RowTest& test, double margin);

/// The margin for a statistic of the size that `values` have, after so many seconds.
double margin_of(const Statistic& statistic, const PairedValues& values, Estimand estimand, double seconds);
/// Onto what is there already, behind a semicolon.
void add_reason(StatisticVerdict& verdict, const std::string& reason);
/// Whether an outcome came about in no start in one engine alone.
bool is_alike(bool is_share, const PairedValues& values) noexcept;

}  // namespace crossgait
