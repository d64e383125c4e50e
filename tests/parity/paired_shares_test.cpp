// Exact tests of paired shares: known cases, and how often they are wrong.
#include "parity/paired_shares.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "physics/core/random.h"

namespace crossgait {
namespace {

TEST(PairedShares, SeeWhatANormalApproximationOfSharesDidNot) {
  // A robot that never falls in one engine, and in 15 of 24 runs in the other.
  const PairedShares fell(24, 0, 15);
  EXPECT_EQ(fell.estimate(), 0.625);
  EXPECT_LT(fell.p_beyond(0.1), 0.05 / 12) << "among twelve statistics, too";
  EXPECT_GT(fell.interval(0.95).low, 0.3);
  EXPECT_LT(PairedShares(12, 0, 12).p_beyond(0.1), 0.05 / 12);
  // 21 of 100 against none: P below 1e-5 that the shares are equal.
  EXPECT_GT(PairedShares(100, 0, 21).interval(1 - 1e-5).low, 0);
}

TEST(PairedShares, AreAntisymmetric) {
  const Interval one = PairedShares(20, 2, 9).interval(0.9), other = PairedShares(20, 9, 2).interval(0.9);
  EXPECT_NEAR(one.low, -other.high, 1e-8);
  EXPECT_NEAR(one.high, -other.low, 1e-8);
  EXPECT_NEAR(PairedShares(20, 2, 9).p_beyond(0.1), PairedShares(20, 9, 2).p_beyond(0.1), 1e-12);
}

TEST(PairedShares, WhereNothingHappensExcludeWhatManyStartsExclude) {
  // Unconditionally, a difference of d without a single discordant pair has a probability of (1 - d)^n.
  const Interval none = PairedShares(12, 0, 0).interval(0.9);
  EXPECT_NEAR(none.high, 1 - std::pow(0.05, 1.0 / 12), 1e-3);
  EXPECT_NEAR(none.low, -none.high, 1e-8);
  const auto enough = PairedShares(12, 0, 0).enough(0.1, 0.05, 0.025);
  ASSERT_TRUE(enough.has_value());
  EXPECT_NEAR(static_cast<double>(*enough), std::log(0.05) / std::log(0.9), 2);  // 28.4
}

// Beyond what is exact, too, so many would be enough by their P value, and a tenth fewer would not.
TEST(PairedShares, SayHowManyWouldBeEnoughAsTheirPValuesDo) {
  const auto more = [](std::size_t pairs, std::size_t only_b) {
    const double times = static_cast<double>(pairs) / 100;
    return PairedShares(pairs, static_cast<std::size_t>(std::lround(2 * times)),
                        static_cast<std::size_t>(std::lround(static_cast<double>(only_b) * times)));
  };
  const auto within = PairedShares(100, 2, 8).enough(0.1, 0.05, 0.025),
             beyond = PairedShares(100, 2, 18).enough(0.1, 0.05, 0.025);
  ASSERT_TRUE(within && beyond);
  EXPECT_GT(std::min(*within, *beyond), 100U);
  EXPECT_LE(more(*within, 8).p_within(0.1), 0.05);
  EXPECT_GT(more(*within * 9 / 10, 8).p_within(0.1), 0.05);
  EXPECT_LE(more(*beyond, 18).p_beyond(0.1), 0.05);
  EXPECT_GT(more(*beyond * 9 / 10, 18).p_beyond(0.1), 0.05);
}

// One tail, at the margin: 2.5 % for *differs* on its side, 5 % for *agrees*, whatever the shares.
TEST(PairedShares, AreRarelyWrongAtTheMargin) {
  struct Shares {
    std::size_t pairs;
    double only_a, only_b;
  };
  constexpr int kRepetitions = 400;
  Random random(2);
  for (const auto& [pairs, only_a, only_b] :
       {Shares{12, 0, 0.1}, {24, 0, 0.1}, {24, 0.05, 0.15}, {24, 0.3, 0.4}}) {
    int beyond = 0, within = 0, missed = 0;
    for (int r = 0; r < kRepetitions; ++r) {
      std::size_t a = 0, b = 0;
      for (std::size_t k = 0; k < pairs; ++k) {
        const double draw = random.uniform(0, 1);
        if (draw < only_a) {
          ++a;
        } else if (draw < only_a + only_b) {
          ++b;
        }
      }
      const PairedShares shares(pairs, a, b);
      beyond += shares.p_beyond(0.1) <= 0.05;
      within += shares.p_within(0.1) <= 0.05;
      missed += !shares.interval(0.95).contains(only_b - only_a);
    }
    // Four standard errors above 2.5 and 5 %: 0.8 and 1.1 % each.
    EXPECT_LE(beyond, 0.057 * kRepetitions) << pairs << " " << only_a;
    EXPECT_LE(within, 0.094 * kRepetitions) << pairs << " " << only_a;
    EXPECT_LE(missed, 0.094 * kRepetitions) << pairs << " " << only_a;
  }
}

TEST(PairedShares, OfVeryManyAreWiderRatherThanNarrower) {
  const Interval exact = PairedShares(100, 5, 20).interval(0.95),
                 wide = PairedShares(101, 5, 20).interval(0.95);
  EXPECT_LT(wide.low, exact.low);
  EXPECT_GT(wide.high, exact.high);
  EXPECT_LT(PairedShares(1000, 0, 210).p_beyond(0.1), 1e-6);
}

}  // namespace
}  // namespace crossgait
