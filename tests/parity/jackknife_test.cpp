// Intervals against tables and closed forms.
#include "parity/jackknife.h"

#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "physics/core/random.h"

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

double mean_without(const std::vector<double>& x, std::size_t left_out) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (i == left_out) continue;
    sum += x[i];
    ++count;
  }
  return sum / count;
}

TEST(Jackknife, OfAMeanIsStudentsInterval) {
  const std::vector<double> x{1, 2, 4, 4, 9};
  const Interval interval = jackknife(
      x.size(), [&](std::size_t i) { return mean_without(x, i); }, 0.95);
  // Mean 4, variance 9.5: standard error sqrt(9.5 / 5), t(.975, 4) = 2.7764451.
  EXPECT_NEAR(interval.estimate, 4, 1e-14);
  EXPECT_NEAR(interval.half_width(), 2.7764451 * std::sqrt(9.5 / 5), 1e-6);
}

TEST(Jackknife, CoversARatioAsOftenAsItSays) {
  // Mean over mean of uniform samples, true value 2; 2000 repetitions of 12.
  Random random(1);
  int covered = 0;
  constexpr int kRepetitions = 2000;
  for (int r = 0; r < kRepetitions; ++r) {
    std::vector<double> a(12), b(12);
    for (std::size_t i = 0; i < a.size(); ++i) {
      b[i] = random.uniform(0.5, 1.5);
      a[i] = 2 * b[i] + random.uniform(-1, 1);
    }
    const Interval interval = jackknife(
        a.size(), [&](std::size_t i) { return mean_without(a, i) / mean_without(b, i); }, 0.95);
    if (interval.contains(2)) ++covered;
  }
  // 95 % give or take four standard errors of a share among 2000 (.5 % each).
  EXPECT_NEAR(static_cast<double>(covered) / kRepetitions, 0.95, 0.02);
}

}  // namespace
}  // namespace crossgait
