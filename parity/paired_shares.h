// How much more often something happens in one of two engines, from the same starts: exact.
#pragma once

#include <cstddef>
#include <optional>

#include "parity/paired_test.h"

namespace crossgait {

/// Counts pairs in which something happened in one engine alone. What it did in both, or in neither, says
/// nothing about the difference of the two shares, which is (only_b - only_a) / pairs.
///
/// Up to 100 pairs, tests and intervals are exact and unconditional: a P value is the largest probability,
/// over all shares of pairs in which it happens in `a` alone, of a table at least as far from the hypothesis,
/// in the order of Tango's score (Tango 1998; Hsueh, Liu and Chen 2001). Beyond, intervals are those between
/// Clopper and Pearson's limits of the two shares, each at half of the error: wider, never too narrow.
class PairedShares final : public PairedTest {
 public:
  PairedShares(std::size_t pairs, std::size_t only_a, std::size_t only_b);

  double estimate() const noexcept override;
  Interval interval(double confidence) const override;
  std::optional<std::size_t> enough(double margin, double tail_within, double tail_beyond) const override;

 private:
  double p_above(double limit) const override;
  double p_below(double limit) const override;
  double lower_limit(double tail) const;
  /// Tells whether the P value against "at most `limit`" is `tail` or less, without looking for it where it
  /// is found from limits.
  bool rejects_at_most(double limit, double tail) const;

  std::size_t pairs_, only_a_, only_b_;
};

}  // namespace crossgait
