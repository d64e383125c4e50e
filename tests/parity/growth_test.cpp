// The growth of a difference, of differences whose growth is known.
#include "parity/growth.h"

#include <cmath>

#include <gtest/gtest.h>

#include "physics/core/random.h"

namespace crossgait {
namespace {

std::optional<DifferenceGrowth> fitted(double seconds, double (*difference)(double t)) {
  GrowthFit fit;
  for (int i = 0; i * 2e-3 < seconds; ++i) fit.add(i * 2e-3, difference(i * 2e-3));
  return fit.fit();
}

TEST(Growth, OfAnExponentialIsItsFactor) {
  const auto growth = fitted(5, [](double t) { return 1e-13 * std::pow(15, t / 0.5); });
  ASSERT_TRUE(growth);
  EXPECT_NEAR(growth->per_half_second, 15, 0.05);  // windows are a little shorter than steps fill them
  EXPECT_NEAR(growth->spread, 1, 0.02);
  EXPECT_NEAR(growth->reaches_s(1e-6), 0.5 * std::log(1e7) / std::log(15.0), 0.1);  // a window
}

TEST(Growth, ScatterIsSaid) {
  const auto growth = fitted(6, [](double t) {
    const double noise = Random(derived_seed(3, static_cast<std::uint64_t>(t * 1e6))).uniform(-1, 1);
    return 1e-12 * std::pow(4, t / 0.5 + noise);
  });
  ASSERT_TRUE(growth);
  EXPECT_NEAR(growth->per_half_second, 4, 0.6);
  EXPECT_GT(growth->spread, 1.05);  // of a window the largest counts, which scatters less
}

TEST(Growth, EndsWhereTheDifferenceIsAsLargeAsTheMotion) {
  const auto growth = fitted(10, [](double t) { return std::min(0.1, 1e-12 * std::pow(30, t / 0.5)); });
  ASSERT_TRUE(growth);
  EXPECT_NEAR(growth->per_half_second, 30, 0.2);
  EXPECT_LT(growth->to_s, 4);  // 0.01 is reached at 3.4 s
}

TEST(Growth, OfFastChaosIsSeenInNarrowerWindows) {
  // From rounding to the size of the motion within 0.6 s.
  const auto growth = fitted(1, [](double t) { return std::min(0.05, 1e-13 * std::pow(1.5e9, t / 0.5)); });
  ASSERT_TRUE(growth);
  EXPECT_NEAR(std::log(growth->per_half_second) / std::log(1.5e9), 1, 0.05);  // a window of its range
  EXPECT_LT(growth->to_s, 0.65);
  // A step up within rounding and no growth after it is none, however narrow the windows that would see one.
  EXPECT_FALSE(fitted(5, [](double t) { return t < 0.05 ? 1e-13 * std::pow(1e30, t) : 1e-11; }));
}

TEST(Growth, IsNoneOfWhatStaysOrIsNothing) {
  EXPECT_FALSE(fitted(5, [](double) { return 1e-12; }));
  EXPECT_FALSE(fitted(5, [](double) { return 0.0; }));
  EXPECT_FALSE(fitted(5, [](double t) { return 1e-12 * std::exp(-t); }));
  EXPECT_FALSE(fitted(0.5, [](double t) { return 1e-13 * std::pow(15, t / 0.5); }));  // too short
}

}  // namespace
}  // namespace crossgait
