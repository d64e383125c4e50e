// Probabilities against tables and closed forms.
#include "parity/distributions.h"

#include <cmath>

#include <gtest/gtest.h>

namespace crossgait {
namespace {

TEST(StudentQuantile, IsThatOfTheTables) {
  // R 4.2: qt(p, df), to the digits given.
  EXPECT_NEAR(student_quantile(0.975, 1), 12.7062047, 1e-6);
  EXPECT_NEAR(student_quantile(0.975, 11), 2.2009852, 1e-6);
  EXPECT_NEAR(student_quantile(0.95, 2), 2.9199856, 1e-6);
  EXPECT_NEAR(student_quantile(0.975, 1e6), 1.9599666, 1e-5);
  // Closed form for two degrees of freedom: (2p - 1) / sqrt(2 p (1 - p)).
  for (const double p : {0.6, 0.99, 0.9999}) {
    EXPECT_NEAR(student_quantile(p, 2), (2 * p - 1) / std::sqrt(2 * p * (1 - p)), 1e-7);
    EXPECT_NEAR(student_quantile(1 - p, 2), -student_quantile(p, 2), 1e-12);
  }
}

TEST(StudentTail, IsWhatTheQuantileLeaves) {
  for (const double p : {0.6, 0.975, 0.9999})
    EXPECT_NEAR(student_tail(student_quantile(p, 7), 7), 1 - p, 1e-9);
  EXPECT_NEAR(student_tail(-1, 7) + student_tail(1, 7), 1, 1e-14);
}

TEST(BinomialTail, IsTheSumOfItsTerms) {
  // At least 2 of 3 with 1/4: 3 (1/16) (3/4) + 1/64.
  EXPECT_NEAR(binomial_tail(2, 3, 0.25), 10.0 / 64, 1e-14);
  EXPECT_EQ(binomial_tail(0, 3, 0.25), 1);
  EXPECT_EQ(binomial_tail(4, 3, 0.25), 0);
  EXPECT_NEAR(binomial_tail(12, 12, 0.5), std::pow(2, -12), 1e-16);
}

TEST(ShareLimits, AreClopperAndPearsons) {
  // Of none of n the upper limit solves (1 - p)^n = tail.
  EXPECT_NEAR(share_upper_limit(0, 12, 0.05), 1 - std::pow(0.05, 1.0 / 12), 1e-12);
  EXPECT_EQ(share_lower_limit(0, 12, 0.05), 0);
  EXPECT_NEAR(share_lower_limit(12, 12, 0.05), std::pow(0.05, 1.0 / 12), 1e-12);
  // Closed form at n = 2: one of two, 2 p (1 - p) + p^2 = tail.
  EXPECT_NEAR(share_lower_limit(1, 2, 0.025), 1 - std::sqrt(1 - 0.025), 1e-12);
}

}  // namespace
}  // namespace crossgait
