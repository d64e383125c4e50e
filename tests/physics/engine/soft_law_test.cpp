// MuJoCo's soft-constraint law against values worked out by hand.
#include "physics/engine/soft_law.h"

#include <cmath>

#include <gtest/gtest.h>

namespace crossgait {
namespace {

const Softness kSoft{0.02, 1.0, 0.9, 0.95, 0.001};

TEST(SoftLaw, ImpedanceIsASmoothStep) {
  const SoftLaw law(kSoft, 1e-3);
  // d(r) = 0.9 + 0.05 y(|r| / 1 mm), y = 2 x^2 up to the middle, 1 - 2 (1 - x)^2 from there.
  EXPECT_DOUBLE_EQ(law.impedance(0), 0.9);
  EXPECT_DOUBLE_EQ(law.impedance(0.25e-3), 0.90625);
  EXPECT_DOUBLE_EQ(law.impedance(0.5e-3), 0.925);
  EXPECT_DOUBLE_EQ(law.impedance(0.75e-3), 0.94375);
  EXPECT_DOUBLE_EQ(law.impedance(1e-3), 0.95);
  EXPECT_DOUBLE_EQ(law.impedance(1), 0.95);
  EXPECT_DOUBLE_EQ(law.impedance(-0.25e-3), law.impedance(0.25e-3));
}

TEST(SoftLaw, ImpedanceStaysWithinMujocosBounds) {
  const SoftLaw law({0.02, 1, 1e-9, 1 - 1e-9, 1e-3}, 1e-3);
  EXPECT_DOUBLE_EQ(law.impedance(0), 1e-4);
  EXPECT_DOUBLE_EQ(law.impedance(1e-3), 0.9999);
}

TEST(SoftLaw, TargetVelocityIsThatOfASpringAndADamper) {
  const double h = 1e-3;
  const SoftLaw law(kSoft, h);
  const double B = 2 / (0.95 * 0.02), K = 1 / (0.95 * 0.95 * 0.02 * 0.02);
  EXPECT_DOUBLE_EQ(law.target_velocity(0.3, 0.9, 0), 0.3 - h * B * 0.3);
  EXPECT_DOUBLE_EQ(law.target_velocity(0, 0.9, -1e-3), h * K * 0.9 * 1e-3);
  EXPECT_DOUBLE_EQ(law.target_velocity(0.3, 0.9, 2e-3), 0.3 - h * (B * 0.3 + K * 0.9 * 2e-3));
}

TEST(SoftLaw, DampingRatioSoftensTheSpringAlone) {
  const double h = 1e-3;
  const SoftLaw law({0.02, 2.0, 0.9, 0.95, 0.001}, h);
  const double B = 2 / (0.95 * 0.02), K = 1 / (0.95 * 0.95 * 0.02 * 0.02 * 4);
  EXPECT_DOUBLE_EQ(law.target_velocity(0.3, 0.9, 2e-3), 0.3 - h * (B * 0.3 + K * 0.9 * 2e-3));
}

TEST(SoftLaw, TimeConstantIsNeverBelowTwoSteps) {
  const Softness quick{1e-6, 1, 0.9, 0.95, 0.001}, two_steps{4e-3, 1, 0.9, 0.95, 0.001};
  EXPECT_EQ(SoftLaw(quick, 2e-3).target_velocity(1, 0.9, 1e-3),
            SoftLaw(two_steps, 2e-3).target_velocity(1, 0.9, 1e-3));
}

TEST(SoftLaw, RegularizationIsWhatImpedanceLeaves) {
  EXPECT_DOUBLE_EQ(SoftLaw::regularization(0.9, 21.657), 21.657 / 9);
  EXPECT_DOUBLE_EQ(SoftLaw::regularization(0.5, 3), 3);
}

}  // namespace
}  // namespace crossgait
