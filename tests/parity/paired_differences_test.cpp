// Tests and intervals of paired differences against closed forms, and how often they are wrong.
#include "parity/paired_differences.h"

#include <cmath>

#include <gtest/gtest.h>

#include "parity/distributions.h"
#include "physics/core/random.h"

namespace crossgait {
namespace {

double normal(Random& random) {
  // Box and Muller 1958.
  return std::sqrt(-2 * std::log(1 - random.uniform(0, 1))) * std::cos(2 * M_PI * random.uniform(0, 1));
}

std::vector<double> normals(Random& random, std::size_t n, double mean) {
  std::vector<double> sample;
  for (std::size_t i = 0; i < n; ++i) sample.push_back(mean + normal(random));
  return sample;
}

TEST(PairedMean, HasStudentsInterval) {
  const PairedDifferences d({1, 2, 4, 4, 9});
  // Mean 4, variance 9.5: standard error sqrt(9.5 / 5), t(0.975, 4) = 2.7764451.
  const Interval interval = d.interval(0.95);
  EXPECT_NEAR(interval.estimate, 4, 1e-14);
  EXPECT_NEAR(interval.half_width(), 2.7764451 * std::sqrt(9.5 / 5), 1e-6);
}

// A test at 5 % rejects where the interval lies on its side.
TEST(PairedDifference, TestsAndIntervalsSayTheSame) {
  Random random(3);
  for (const Estimand estimand : {Estimand::kMean, Estimand::kMedian}) {
    for (int r = 0; r < 200; ++r) {
      const PairedDifferences d(normals(random, 14, random.uniform(-2, 2)), estimand, 0.1);
      EXPECT_EQ(d.p_beyond(0.5) <= 0.05, d.interval(0.95).beyond(0.5));
      EXPECT_EQ(d.p_within(1.5) <= 0.05, d.interval(0.9).within(1.5));
    }
  }
}

TEST(PairedMedian, LiesBetweenOrderStatistics) {
  // Of 12 the interval from the third to the tenth fails with 2 (1 + 12 + 66) / 4096 = 3.9 %.
  std::vector<double> x;
  for (int i = 1; i <= 12; ++i) x.push_back(i * i);
  const PairedDifferences d(x, Estimand::kMedian);
  EXPECT_EQ(d.estimate(), (36 + 49) / 2.0);
  EXPECT_EQ(d.interval(0.95).low, 9);
  EXPECT_EQ(d.interval(0.95).high, 100);
  EXPECT_EQ(d.interval(0.999).low, 1);  // 2 / 4096 = 0.05 %
  EXPECT_EQ(d.interval(0.99999).low, 1) << "no wider one";
  EXPECT_NEAR(d.p_beyond(0.5), 2.0 / 4096, 1e-12);
}

// Student's interval, further out at either end by what is too small to matter, if the sample has that much
// of a deviation.
TEST(PairedMean, KeepsOffByItsResolution) {
  const std::vector<double> sample{1, 2, 4, 4, 9};
  const PairedDifferences students(sample);
  const double half = students.interval(0.95).half_width();
  const auto with = [&](double resolution) { return PairedDifferences(sample, Estimand::kMean, resolution); };
  EXPECT_NEAR(with(0.5).interval(0.95).half_width(), half + 0.5, 1e-12);
  EXPECT_NEAR(with(100).interval(0.95).half_width(), half + std::sqrt(9.5), 1e-12);
  EXPECT_NEAR(with(0.5).p_within(9.5), students.p_within(9), 1e-12);
  EXPECT_NEAR(with(0.5).p_beyond(1.5), students.p_beyond(2), 1e-12);
  EXPECT_GT(with(0.5).enough(5, 0.05, 0.05), students.enough(5, 0.05, 0.05));
}

// Skewed differences, an exponential distribution here, make Student's intervals hold less often than
// promised; not where their spread is no more than what is allowed for.
TEST(PairedMean, HoldsSkewedDifferencesWhereTheyHardlyMatter) {
  Random random(17);
  constexpr int kRepetitions = 2000;
  int students = 0, allowed = 0;
  for (int r = 0; r < kRepetitions; ++r) {
    std::vector<double> sample;
    for (int i = 0; i < 12; ++i) sample.push_back(-std::log(1 - random.uniform(0, 1)));
    students += PairedDifferences(sample).interval(0.95).contains(1);
    allowed += PairedDifferences(sample, Estimand::kMean, 1).interval(0.95).contains(1);
  }
  EXPECT_LT(students, 0.93 * kRepetitions);
  EXPECT_GT(allowed, 0.97 * kRepetitions);
}

TEST(PairedMedian, OfTooFewHasNoTest) {
  EXPECT_EQ(fewest_for_median(0.05), 6U);  // 2 / 2^6 = 3.1 %, 2 / 2^5 = 6.3 %
  EXPECT_EQ(fewest_for_median(2.1 / 1024), 10U);
  for (const std::size_t n : {9U, 10U}) {
    const PairedDifferences d(std::vector<double>(n, 1), Estimand::kMedian);
    EXPECT_EQ(d.p_beyond(0.5) <= 2.1 / 1024, n == 10);
  }
}

TEST(PairedMean, WithoutSpreadIsCertain) {
  const PairedDifferences same({0.3, 0.3, 0.3});
  EXPECT_EQ(same.p_beyond(0.2), 0);
  EXPECT_EQ(same.p_within(0.2), 1);
  EXPECT_EQ(same.p_within(0.4), 0);
  EXPECT_EQ(same.p_beyond(0.4), 1);
}

// Truth exactly at the margin: each word is wrong, and said in no more than 5 % of cases, 2.5 % on the one
// side where *differs* can be said.
TEST(PairedDifference, IsRarelyWrongAtTheMargin) {
  Random random(5);
  constexpr int kRepetitions = 4000;
  for (const Estimand estimand : {Estimand::kMean, Estimand::kMedian}) {
    int within = 0, beyond = 0;
    for (int r = 0; r < kRepetitions; ++r) {
      const PairedDifferences d(normals(random, 12, 3), estimand);
      within += d.p_within(3) <= 0.05;
      beyond += d.p_beyond(3) <= 0.05;
    }
    // Four standard errors above: 0.35 and 0.25 % each.
    EXPECT_LE(within, 0.064 * kRepetitions) << name(estimand);
    EXPECT_LE(beyond, 0.035 * kRepetitions) << name(estimand);
  }
}

TEST(PairedDifference, TellsHowManyStartsWouldDo) {
  Random random(7);
  const std::vector<double> sample = normals(random, 12, 0.9);
  const PairedDifferences d(sample);
  const auto enough = d.enough(2, 0.05, 0.001);
  ASSERT_TRUE(enough.has_value());
  // The fewest with which an interval of this deviation fits into what is left.
  double squares = 0;
  for (const double v : sample) squares += (v - d.estimate()) * (v - d.estimate()) / 11;
  const auto half = [&](std::size_t n) {
    return student_quantile(0.95, static_cast<double>(n - 1)) * std::sqrt(squares / static_cast<double>(n));
  };
  EXPECT_LT(half(*enough), 2 - d.estimate());
  EXPECT_TRUE(*enough == 13 || half(*enough - 1) >= 2 - d.estimate());
  EXPECT_FALSE(d.enough(d.estimate() + 1e-4, 0.05, 0.001).has_value()) << "on the margin nothing tells";
}

TEST(Shapes, OfNormalSamplesAreRegular) {
  Random random(11);
  constexpr int kRepetitions = 2000;
  struct Case {
    std::size_t n;
    double most;
  };
  // What the header promises.
  for (const auto& [n, most] : {Case{6, 0.12}, {12, 0.04}, {24, 0.01}}) {
    int found = 0;
    for (int r = 0; r < kRepetitions; ++r) found += shape_of(normals(random, n, 0), 0.1) != Shape::kRegular;
    EXPECT_LE(found, most * kRepetitions) << n;
  }
}

TEST(Shapes, OfSomeRunsThatFellAreNot) {
  Random random(13);
  for (int r = 0; r < 50; ++r) {
    std::vector<double> one = normals(random, 12, 0), five = one;
    one[3] += 40;
    for (std::size_t i = 0; i < 5; ++i) five[i] += 40;
    EXPECT_EQ(shape_of(one, 0.1), Shape::kHeavyTails);
    EXPECT_EQ(shape_of(five, 0.1), Shape::kTwoHumps);
    EXPECT_EQ(shape_of(five, 200), Shape::kRegular) << "nothing that matters";
  }
}

}  // namespace
}  // namespace crossgait
