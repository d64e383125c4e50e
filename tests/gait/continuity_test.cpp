// No foot target ever moves further in one update than 1.5 times the gait's top foot speed times dt, whatever
// is changed while it runs.

#include <cmath>
#include <optional>
#include <random>

#include <gtest/gtest.h>

#include "gait/adaptive_gait_controller.h"
#include "gait/multi_gait_controller.h"
#include "tests/gait/test_robot.h"

namespace crossgait {
namespace {

using test::kDt;
constexpr int kUpdates = 10000;  // 20 s
/// Sampling a curve's speed at 400 phases misses its peak by less than this share.
constexpr double kSampling = 1e-3;

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  bool chance(double p) { return uniform(0, 1) < p; }
  const Gait& gait() {
    return gaits()[std::uniform_int_distribution<std::size_t>(0, gaits().size() - 1)(engine_)];
  }
  GaitParameters parameters(SwingCurve curve) {
    GaitParameters p;
    for (const ParameterRow& row : gait_parameters()) p.*row.member = uniform(row.min, row.max);
    p.swing = curve;
    return p;
  }
  VelocityCommand command() {
    if (chance(0.15)) return {};
    return {uniform(-0.5, 0.5), uniform(-0.3, 0.3), uniform(-1.5, 1.5)};
  }

 private:
  std::mt19937 engine_;
};

/// Furthest move of any target in one update, relative to what the gait, with the stride that is in effect,
/// moves at its fastest in that time.
class JumpMeter {
 public:
  /// @param curve  the swing curve in use; none: both are, and the faster one counts
  JumpMeter(const GaitGenerator& generator, std::optional<SwingCurve> curve)
      : generator_(generator), curve_(curve), before_(generator.targets()) {}

  void look() {
    double jump = 0;
    for (const Leg leg : kLegs) {
      const Vector3& p = generator_.targets()[leg].position;
      ASSERT_TRUE(p.allFinite());
      jump = std::max(jump, (p - before_[leg].position).norm());
    }
    before_ = generator_.targets();
    // Both curves somewhere rise by 3 lifts per swing: only moves that beat the record by that are worth
    // sampling.
    const GaitParameters& p = generator_.effective().parameters;
    if (jump <= worst_ * kDt * 3 * swing_lift(p) / ((1 - p.duty_factor) * p.cycle_time)) return;
    worst_ = std::max(worst_, jump / (top_speed() * kDt));
  }

  double worst() const { return worst_; }

 private:
  double top_speed() const {
    const auto with = [&](SwingCurve curve) {
      const GaitGenerator::Stride& stride = generator_.effective();
      return test::top_foot_speed(stride.parameters, stride.step, curve);
    };
    return curve_ ? with(*curve_) : std::max(with(SwingCurve::kBezier), with(SwingCurve::kMatched));
  }

  const GaitGenerator& generator_;
  std::optional<SwingCurve> curve_;
  LegArray<FootTarget> before_;
  double worst_ = 0;
};

/// Bezier, matched, or changing between them.
class Continuity : public testing::TestWithParam<std::optional<SwingCurve>> {
 protected:
  SwingCurve curve(Random& random) const {
    return GetParam().value_or(random.chance(0.5) ? SwingCurve::kBezier : SwingCurve::kMatched);
  }
  GaitParameters initial() const {
    GaitParameters p;
    p.swing = GetParam().value_or(SwingCurve::kBezier);
    return p;
  }
  static constexpr double kMost = 1.5 * (1 + kSampling);
};

INSTANTIATE_TEST_SUITE_P(, Continuity,
                         testing::Values(std::optional(SwingCurve::kBezier),
                                         std::optional(SwingCurve::kMatched), std::nullopt),
                         [](const auto& p) { return std::string(p.param ? name(*p.param) : "both"); });

TEST_P(Continuity, WithoutChangesFeetKeepToTheirTopSpeed) {
  for (const Gait& gait : gaits()) {
    GaitGenerator generator(gait, initial(), test::leg_origins());
    JumpMeter meter(generator, GetParam());
    for (int i = 0; i < 1000; ++i) {
      generator.update(kDt);
      meter.look();
    }
    EXPECT_LE(meter.worst(), 1 + kSampling) << gait.name;
    EXPECT_GE(meter.worst(), GetParam() ? 0.98 : 0.5)
        << gait.name;  // the meter measures: two points near the top
  }
}

TEST_P(Continuity, HoldsThroughParameterGaitAndCommandChanges) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    Random random(seed);
    GaitGenerator generator(random.gait(), initial(), test::leg_origins());
    JumpMeter meter(generator, GetParam());
    for (int i = 0; i < kUpdates; ++i) {
      if (random.chance(0.005)) {
        ASSERT_TRUE(generator.set_parameters(random.parameters(curve(random))));
      }
      if (random.chance(0.002)) generator.set_gait(random.gait());
      if (random.chance(0.003)) {
        ASSERT_TRUE(generator.set_command(random.command()));
      }
      if (random.chance(0.001)) generator.clear_command();
      generator.update(kDt);
      meter.look();
    }
    EXPECT_LE(meter.worst(), kMost) << "seed " << seed;
    EXPECT_GT(meter.worst(), 1.1) << "seed " << seed;  // the changes were felt
  }
}

TEST_P(Continuity, HoldsWhenEverythingChangesAtEveryUpdate) {
  Random random(100);
  GaitGenerator generator(random.gait(), initial(), test::leg_origins());
  JumpMeter meter(generator, GetParam());
  for (int i = 0; i < kUpdates; ++i) {
    ASSERT_TRUE(generator.set_parameters(random.parameters(curve(random))));
    generator.set_gait(random.gait());
    ASSERT_TRUE(generator.set_command(random.command()));
    generator.update(kDt);
    meter.look();
  }
  EXPECT_LE(meter.worst(), kMost);
}

TEST_P(Continuity, HoldsForTheMultiGaitController) {
  for (unsigned seed = 200; seed < 204; ++seed) {
    Random random(seed);
    MultiGaitOptions options;
    options.parameters = initial();
    MultiGaitController controller(options, test::leg_origins());
    JumpMeter meter(controller.generator(), GetParam());
    for (int i = 0; i < kUpdates; ++i) {
      if (random.chance(0.004)) {
        ASSERT_TRUE(controller.set_command(random.command()));
      }
      if (random.chance(0.004)) {
        ASSERT_TRUE(controller.set_speed(random.uniform(-0.5, 0.5)));
      }
      if (random.chance(0.003)) {
        ASSERT_TRUE(controller.set_parameters(random.parameters(curve(random))));
      }
      if (random.chance(0.001)) controller.force_gait(random.gait());
      if (random.chance(0.001)) controller.choose_gait_by_speed();
      controller.update(kDt);
      meter.look();
    }
    EXPECT_LE(meter.worst(), kMost) << "seed " << seed;
    EXPECT_GT(meter.worst(), 1.1) << "seed " << seed;
  }
}

TEST_P(Continuity, HoldsForTheAdaptiveControllerUnderARandomPolicy) {
  Random random(300);
  AdaptiveGaitOptions options;
  options.parameters.clear();
  for (const ParameterRow& row : gait_parameters()) options.parameters.emplace_back(row.name);
  options.initial = initial();
  AdaptiveGaitController controller(find_gait("trot"), options, test::leg_origins());
  JumpMeter meter(controller.generator(), GetParam());
  std::vector<double> action(controller.action_size());
  LegArray<FootTarget> before = controller.targets();
  for (int i = 0; i < kUpdates; ++i) {
    const GaitParameters parameters = controller.parameters();
    const LegArray<Vector3> residuals = controller.residuals();
    for (double& a : action) a = random.uniform(-1.5, 1.5);
    controller.apply_action(action);
    controller.update(kDt);
    meter.look();
    // And no target moves further than the gait moves it, plus the changes of parameters and of its residual.
    double change = 0;
    for (const ParameterRow& row : controller.adapted()) {
      change += std::abs(controller.parameters().*row.member - parameters.*row.member);
    }
    for (const Leg leg : kLegs) {
      const double jump = (controller.targets()[leg].position - before[leg].position).norm();
      const double residual = (controller.residuals()[leg] - residuals[leg]).norm();
      ASSERT_LE(jump,
                change + residual + kMost * 0.8 * kDt);  // 0.8 m/s: above the top speed of the whole table
    }
    before = controller.targets();
  }
  EXPECT_LE(meter.worst(), kMost);
}

}  // namespace
}  // namespace crossgait
