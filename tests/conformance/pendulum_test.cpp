// Pendulums on a fixed base: the tree's dynamics against textbook motion.
#include <cmath>
#include <numbers>

#include "crossgait/benchmarks/analytic.h"
#include "crossgait/tests/support/backend_test.h"
#include "crossgait/tests/support/constants.h"

namespace crossgait {
namespace {

using test::kGravity;

double frequency_of(const scenes::ArmLink& link) {
  return std::sqrt(link.mass * kGravity * link.length / link.joint_inertia());
}

class Pendulum : public BackendTest {
 protected:
  static double period(const scenes::ArmLink& link, double amplitude, double h, int swings) {
    return benchmarks::pendulum_period(GetParam(), link, amplitude, h, swings);
  }
};
CROSSGAIT_FOR_EVERY_BACKEND(Pendulum);

TEST_P(Pendulum, SmallSwingsTakeThePeriodOfTheHarmonicOscillator) {
  const scenes::ArmLink link{.armature = 1e-3};
  const double w = frequency_of(link), h = 1e-3, amplitude = 1e-3;
  const double T = period(link, amplitude, h, 5);
  // Semi-implicit Euler turns a harmonic oscillator by acos(1 - (w h)^2 / 2) per step; amplitude adds a^2
  // / 16.
  const double discrete =
      2 * std::numbers::pi * h / std::acos(1 - w * w * h * h / 2) * (1 + amplitude * amplitude / 16);
  measured("relative difference from the discrete period", T / discrete - 1);
  EXPECT_NEAR(T / discrete, 1, 1e-9);
  // The discrete period itself is (w h)^2 / 24 too short.
  EXPECT_NEAR(T, 2 * std::numbers::pi / w, w * w * h * h / 20 * T);
}

TEST_P(Pendulum, LargeSwingsTakeThePeriodOfTheEllipticIntegral) {
  const double coarse = benchmarks::pendulum_error(GetParam(), 4e-3);
  const double middle = benchmarks::pendulum_error(GetParam(), 2e-3);
  const double fine = benchmarks::pendulum_error(GetParam(), 1e-3);
  measured("relative error of the period, h = 4e-3", coarse);
  measured("relative error of the period, h = 1e-3", fine);
  // For one joint the integrator is symplectic and of second order in its period.
  EXPECT_NEAR(middle / coarse, 0.25, 0.02);
  EXPECT_NEAR(fine / middle, 0.25, 0.02);
  EXPECT_LT(std::abs(fine), 1e-5);  // (w h)^2 = 3e-5, over 24, and some for the amplitude
}

TEST_P(Pendulum, ArmatureIsInertiaWithoutWeight) {
  const double plain = period({}, 1e-3, 1e-3, 3);
  const double heavy = period({.armature = 3 * scenes::ArmLink{}.joint_inertia()}, 1e-3, 1e-3, 3);
  EXPECT_NEAR(heavy / plain, 2, 1e-5);  // inertia times four; (w h)^2 / 24 differs between the two by 1e-6
}

TEST_P(Pendulum, DampingTakesTheEnergyOfTheOscillatorAway) {
  scenes::ArmLink link;
  link.damping = 0.02;
  WorldSpec spec = scenes::world_of(scenes::arm({link}));
  spec.fixed_base = true;
  const auto backend = make(spec);
  RobotState start = backend->home_state();
  start.q[0] = 0.01;
  backend->reset(start);
  const double inertia = link.joint_inertia(), a = link.damping / (2 * inertia), w = frequency_of(link);
  const double wd = std::sqrt(w * w - a * a);
  double worst = 0;
  for (int i = 0; i < 2000; ++i) {
    ASSERT_EQ(backend->step({}), StepStatus::kOk);
    const double t = backend->state().time;
    const double exact = 0.01 * std::exp(-a * t) * (std::cos(wd * t) + a / wd * std::sin(wd * t));
    worst = std::max(worst, std::abs(backend->state().q[0] - exact));
  }
  measured("difference from the damped oscillation, share of the amplitude", worst / 0.01);
  EXPECT_LT(worst / 0.01,
            w * 1e-3);  // a phase error of w h / 2 from the start, and the damping's own half step
}

class DoublePendulum : public BackendTest {
 protected:
  /// Largest change of energy over two seconds of chaotic swinging, relative to the swing's potential energy.
  static double energy_drift(double h) {
    const scenes::ArmLink upper{}, lower{.mass = 0.1, .length = 0.15, .inertia = 1e-3, .armature = 5e-4};
    WorldSpec spec = scenes::world_of(scenes::arm({upper, lower}));
    spec.fixed_base = true;
    spec.physics_dt = h;
    const auto backend = make(spec);
    RobotState start = backend->home_state();
    start.q << 2.0, 0.5;
    backend->reset(start);
    const auto energy = [&](const RobotState& s) {
      // Angles from the vertical and heights of the centres of mass; the elbow is at 2 length of the upper
      // link.
      const double a = s.q[0], b = s.q[0] + s.q[1], wa = s.qd[0], wb = s.qd[0] + s.qd[1];
      const double L = 2 * upper.length, l = lower.length;
      const double v2 = L * L * wa * wa + l * l * wb * wb + 2 * L * l * wa * wb * std::cos(a - b);
      const double kinetic = 0.5 * (upper.joint_inertia() * wa * wa + lower.inertia * wb * wb +
                                    lower.mass * v2 + lower.armature * s.qd[1] * s.qd[1]);
      return kinetic - kGravity * (upper.mass * upper.length * std::cos(a) +
                                   lower.mass * (L * std::cos(a) + l * std::cos(b)));
    };
    const double E0 = energy(backend->state());
    double worst = 0;
    for (long i = 0; i < std::lround(2 / h); ++i) {
      EXPECT_EQ(backend->step({}), StepStatus::kOk);
      worst = std::max(worst, std::abs(energy(backend->state()) - E0));
    }
    return worst / (kGravity * (upper.mass * upper.length + lower.mass * (2 * upper.length + lower.length)));
  }
};
CROSSGAIT_FOR_EVERY_BACKEND(DoublePendulum);

TEST_P(DoublePendulum, KeepsItsEnergyAtFirstOrder) {
  const double coarse = energy_drift(5e-4), fine = energy_drift(2.5e-4);
  measured("relative drift of energy, h = 5e-4", coarse);
  measured("relative drift of energy, h = 2.5e-4", fine);
  EXPECT_NEAR(fine / coarse, 0.5, 0.1);
  // Energy moves between its forms at some 20 times its scale per second, and is seen half a step late:
  // 0.005, and the same again where errors of earlier turns have added up.
  EXPECT_LT(coarse, 0.02);
}

}  // namespace
}  // namespace crossgait
