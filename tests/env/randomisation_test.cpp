#include "env/randomisation.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "physics/core/error.h"
#include "scenes/robots.h"
#include "scenes/scenes.h"

namespace crossgait {
namespace {

TEST(Random, IsTheSameEverywhere) {
  // The Mersenne Twister's output is fixed by the C++ standard; the seed's mixing is checked against
  // SplitMix64's published first output for state 0.
  EXPECT_EQ(mix_seed(0), 0xe220a8397b1dcdafULL);
  Random random(0);
  std::mt19937_64 engine(0xe220a8397b1dcdafULL);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(random.uniform(), static_cast<double>(engine() >> 11) * 0x1p-53);
}

TEST(Randomisation, RowsSayWhatTheyAre) {
  for (const RandomisationRow& row : randomisation_rows()) EXPECT_FALSE(row.help.empty()) << row.name;
}

TEST(Randomisation, IsOffByDefault) {
  const Randomisation off;
  EXPECT_NO_THROW(off.validate());
  EXPECT_FALSE(off.changes_world());
  Random random(3);
  const RandomDraw d = draw(off, random);
  for (const RandomisationRow& row : randomisation_rows()) {
    EXPECT_FALSE(off.is_on(row.what)) << row.name;
    EXPECT_EQ(d[row.what], row.neutral) << row.name;
    EXPECT_EQ(&find_randomisation(row.name), &row);
  }
}

TEST(Randomisation, DrawsUniformlyWithinItsRangeAndLeavesOthersAlone) {
  Randomisation one, two;
  one[Randomised::kFriction] = two[Randomised::kFriction] = {0.5, 1.5};
  two[Randomised::kStartYaw] = {-1, 1};
  Random a(5), b(5);
  std::vector<double> values;
  for (int i = 0; i < 2000; ++i) {
    const RandomDraw first = draw(one, a), second = draw(two, b);
    EXPECT_EQ(first[Randomised::kFriction], second[Randomised::kFriction]);
    values.push_back(first[Randomised::kFriction]);
  }
  std::sort(values.begin(), values.end());
  EXPECT_GE(values.front(), 0.5);
  EXPECT_LT(values.back(), 1.5);
  EXPECT_NEAR(values[500], 0.75, 0.05);   // five standard deviations of a quantile of 2000 draws:
  EXPECT_NEAR(values[1500], 1.25, 0.05);  // 5 sqrt(0.25 * 0.75 / 2000)
}

TEST(Randomisation, SeedsAreWholeAndIncludeBothEnds) {
  Randomisation r;
  r[Randomised::kTerrainSeed] = {3, 5};
  Random random(1);
  std::array<int, 3> count{};
  for (int i = 0; i < 300; ++i) {
    const double seed = draw(r, random)[Randomised::kTerrainSeed];
    ASSERT_EQ(seed, static_cast<int>(seed));
    ++count.at(static_cast<std::size_t>(seed) - 3);
  }
  for (const int n : count) EXPECT_GT(n, 60);
}

TEST(Randomisation, ScalesMassesServosAndFriction) {
  const WorldSpec nominal = scenes::world_of(scenes::with_joint_friction(scenes::quadruped(), 0.02));
  Randomisation r;
  r[Randomised::kFriction] = {0.5, 0.5};
  r[Randomised::kJointFriction] = {2, 2};
  r[Randomised::kTrunkMass] = {1.2, 1.2};
  r[Randomised::kMass] = {0.8, 1.25};
  r[Randomised::kServoStiffness] = {2, 2};
  r[Randomised::kJointDamping] = {3, 3};
  r[Randomised::kEffortLimit] = {4, 4};
  EXPECT_TRUE(r.changes_world());
  Random random(1);
  const RandomDraw d = draw(r, random);
  const WorldSpec world = randomised_world(nominal, r, d, random);
  EXPECT_NO_THROW(world.robot->validate());
  EXPECT_DOUBLE_EQ(world.contact.friction, 0.5 * nominal.contact.friction);
  std::vector<double> factors;
  for (std::size_t i = 0; i < nominal.robot->bodies.size(); ++i) {
    const Body &before = nominal.robot->bodies[i], &after = world.robot->bodies[i];
    const double factor = after.inertia.mass / before.inertia.mass;
    EXPECT_LT((after.inertia.I_C - factor * before.inertia.I_C).norm(), 1e-12 * after.inertia.I_C.norm());
    if (i == 0) {
      EXPECT_DOUBLE_EQ(factor, 1.2);
      continue;
    }
    factors.push_back(factor);
    EXPECT_GE(factor, 0.8);
    EXPECT_LE(factor, 1.25);
    EXPECT_DOUBLE_EQ(after.joint.kp, 2 * before.joint.kp);
    EXPECT_DOUBLE_EQ(after.joint.damping, 3 * before.joint.damping);
    EXPECT_DOUBLE_EQ(after.joint.friction, 0.04);
    EXPECT_DOUBLE_EQ(after.joint.effort_limit, 4 * before.joint.effort_limit);
  }
  EXPECT_NE(factors[0], factors[1]);  // each body its own
}

TEST(Randomisation, JointFrictionIsDrawnBesideWhatWasThereBefore) {
  Randomisation off, on;
  on[Randomised::kJointFriction] = {0.5, 1.5};
  Random a(7), b(7), plain(7);
  double sum = 0;
  for (int i = 0; i < 1000; ++i) {
    (void)draw(off, a);
    const double scale = draw(on, b)[Randomised::kJointFriction];
    ASSERT_GE(scale, 0.5);
    ASSERT_LT(scale, 1.5);
    sum += scale;
    for (std::size_t k = 0; k < static_cast<std::size_t>(Randomised::kJointFriction); ++k)
      (void)plain.uniform();
  }
  EXPECT_NEAR(sum / 1000, 1, 0.05);  // five standard deviations
  EXPECT_TRUE(a == plain);
  EXPECT_TRUE(b == plain);
}

TEST(Randomisation, UnknownNamesListTheKnown) {
  try {
    (void)find_randomisation("wind");
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("friction"), std::string::npos);
  }
}

}  // namespace
}  // namespace crossgait
