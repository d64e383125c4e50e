#include "benchmarks/statistics.h"

#include <cmath>

#include <gtest/gtest.h>

namespace crossgait::benchmarks {
namespace {

TEST(Quantile, InterpolatesBetweenNeighbours) {
  EXPECT_EQ(quantile({3, 1, 2}, 0.5), 2);
  EXPECT_EQ(quantile({4, 1, 3, 2}, 0.5), 2.5);
  EXPECT_EQ(quantile({4, 1, 3, 2}, 0), 1);
  EXPECT_EQ(quantile({4, 1, 3, 2}, 1), 4);
  EXPECT_EQ(quantile({7}, 0.25), 7);
  const Quartiles s = quartiles({1, 2, 3, 4, 5});
  EXPECT_EQ(s.low, 2);
  EXPECT_EQ(s.median, 3);
  EXPECT_EQ(s.high, 4);
}

TEST(ConvergenceOrder, IsThePowerOfTheStep) {
  const std::vector<double> steps{4, 2, 1, 0.5};
  for (const double order : {0.5, 1.0, 2.0, 4.0}) {
    std::vector<double> errors;
    for (const double h : steps) errors.push_back(-3e-4 * std::pow(h, order));
    EXPECT_NEAR(convergence_order(steps, errors), order, 1e-12);
  }
  EXPECT_NEAR(convergence_order(steps, {8, 0, 2, 1}), 1, 1e-12);  // a zero says nothing
  EXPECT_TRUE(std::isnan(convergence_order(steps, {0, 0, 1, 0})));
}

TEST(ThreadSeconds, GrowWithWork) {
  const double begin = thread_seconds();
  volatile double x = 1;
  for (int i = 0; i < 1000000; ++i) x = x * 1.0000001;
  EXPECT_GT(thread_seconds(), begin);
}

}  // namespace
}  // namespace crossgait::benchmarks
