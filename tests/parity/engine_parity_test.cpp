// Engines against each other. Those that declare MuJoCo's contact law must agree to rounding; the independent
// ones within what a user may expect of a second opinion.
#include <cmath>

#include <gtest/gtest.h>

#include "crossgait/physics/multibody.h"
#include "crossgait/tests/support/backend_test.h"

namespace crossgait {
namespace {

// Solvers iterate until nothing changes, so that what is left is rounding.
WorldSpec exact_world(const scenes::RobotPtr& robot) {
  WorldSpec spec = scenes::world_of(robot);
  spec.solver.tolerance = 1e-12;
  return spec;
}

struct Difference {
  double position = 0, joint = 0, attitude = 0, force = 0;
  int contacts = 0;  // steps in which the counts differ
};

// Steps both for `seconds` under the same targets; the largest differences.
template <typename Motion>
Difference run_both(PhysicsBackend& a, PhysicsBackend& b, const RobotState& start, const Motion& motion,
                    double seconds) {
  a.reset(start);
  b.reset(start);
  Difference worst;
  const int steps = static_cast<int>(std::lround(seconds / a.spec().physics_dt));
  for (int i = 0; i < steps; ++i) {
    const JointTargets targets = motion(i * a.spec().physics_dt);
    EXPECT_EQ(a.step(targets), StepStatus::kOk);
    EXPECT_EQ(b.step(targets), StepStatus::kOk);
    const RobotState& s = a.state();
    const RobotState& t = b.state();
    worst.position = std::max(worst.position, (s.p_WB - t.p_WB).norm());
    worst.joint = std::max(worst.joint, (s.q - t.q).lpNorm<Eigen::Infinity>());
    worst.attitude = std::max(worst.attitude, s.q_WB.angularDistance(t.q_WB));
    worst.contacts += a.contacts().count != b.contacts().count ? 1 : 0;
    const auto feet = a.foot_contacts(), others = b.foot_contacts();
    for (const Leg leg : kLegs) {
      worst.force = std::max(worst.force, (feet[leg].force - others[leg].force).norm());
    }
  }
  measured("position, m", worst.position);
  measured("joints, rad", worst.joint);
  measured("attitude, rad", worst.attitude);
  measured("foot force, N", worst.force);
  return worst;
}

std::vector<std::string> engines_with(bool mujoco_law) {
  std::vector<std::string> names;
  for (const std::string& name : available_backends()) {
    const BackendInfo info = make_backend(name, scenes::world_of(scenes::sled()))->info();
    if (info.capabilities.matches_mujoco == mujoco_law) names.push_back(name);
  }
  return names;
}

// The first engine with MuJoCo's contact law is the reference (MuJoCo, where it is built in); without one
// there is nothing to compare with.
std::string reference() {
  const auto names = engines_with(true);
  return names.empty() ? std::string() : names.front();
}

std::vector<std::string> followers(bool mujoco_law) {
  std::vector<std::string> names = engines_with(mujoco_law);
  if (reference().empty()) return {};
  std::erase(names, reference());
  return names;
}

class MatchedParity : public BackendTest {
 protected:
  template <typename Motion>
  static Difference run(const WorldSpec& spec, const Motion& motion, double seconds,
                        const std::function<void(RobotState&)>& change = {}) {
    const auto a = make_backend(reference(), spec), b = make_backend(GetParam(), spec);
    RobotState start = a->home_state();
    if (change) change(start);
    return run_both(*a, *b, start, motion, seconds);
  }
};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(MatchedParity);
INSTANTIATE_TEST_SUITE_P(Followers, MatchedParity, ::testing::ValuesIn(followers(true)), backend_of_test);

// Tolerances are those of the design, five or more orders above what is measured
// (docs/parity-measurements.md) and as many below any error of the model: one percent of armature moves a
// trot by 1e-4 m.
constexpr double kSwing = 1e-10;    // rad
constexpr double kTumble = 1e-9;    // m, rad
constexpr double kStand = 1e-8;     // m
constexpr double kTrot = 1e-6;      // m, over seconds
constexpr double kLongTrot = 1e-5;  // m, over a minute

TEST_P(MatchedParity, FixedBaseSwingWithLoops) {
  WorldSpec spec = exact_world(scenes::quadruped());
  spec.fixed_base = true;
  const scenes::Swing swing(*spec.robot);
  const Difference d = run(
      spec, [&](double t) { return swing.targets(t); }, 2, [](RobotState& s) { s.p_WB.z() = 0.5; });
  EXPECT_LT(d.joint, kSwing);
}

TEST_P(MatchedParity, FixedBaseSwingWithoutLoops) {
  WorldSpec spec = exact_world(scenes::without_loops(scenes::quadruped()));
  spec.fixed_base = true;
  const scenes::Swing swing(*scenes::quadruped());
  const Difference d = run(
      spec, [&](double t) { return swing.targets(t); }, 2, [](RobotState& s) { s.p_WB.z() = 0.5; });
  EXPECT_LT(d.joint, kSwing);
}

TEST_P(MatchedParity, Tumbling) {
  const WorldSpec spec = exact_world(scenes::quadruped());
  const scenes::Swing swing(*spec.robot);
  const Difference d = run(
      spec, [&](double t) { return swing.targets(t); }, 1,
      [](RobotState& s) {
        s.p_WB.z() = 10;
        s.v_WB = {0.1, -0.2, 0.3};
        s.w_WB = {3, 6, 9};
      });
  EXPECT_LT(d.position, kTumble);
  EXPECT_LT(d.joint, kTumble);
  EXPECT_LT(d.attitude, kTumble);
}

TEST_P(MatchedParity, DropAndStand) {
  const WorldSpec spec = exact_world(scenes::quadruped());
  const JointTargets home = scenes::home_targets(*spec.robot);
  const Difference d = run(
      spec, [&](double) { return home; }, 2, [](RobotState& s) { s.p_WB.z() += 0.02; });
  EXPECT_LT(d.position, kStand);
  EXPECT_EQ(d.contacts, 0);
}

TEST_P(MatchedParity, TrotOnFlat) {
  const WorldSpec spec = exact_world(scenes::quadruped());
  const scenes::Trot trot(*spec.robot);
  const Difference d = run(
      spec, [&](double t) { return trot.targets(t); }, 5.5);
  EXPECT_LT(d.position, kTrot);
  EXPECT_EQ(d.contacts, 0);
  EXPECT_LT(d.force, 1e-3);  // N, of 7: a force is an impulse over 1e-3 s
}

TEST_P(MatchedParity, TrotOnFlatForAMinute) {
  const WorldSpec spec = exact_world(scenes::quadruped());
  const scenes::Trot trot(*spec.robot);
  EXPECT_LT(run(
                spec, [&](double t) { return trot.targets(t); }, 60)
                .position,
            kLongTrot);
}

TEST_P(MatchedParity, TrotOnRoughGround) {
  WorldSpec spec = exact_world(scenes::quadruped());
  spec.terrain = make_terrain("rough:amplitude=.015", 4);
  const scenes::Trot trot(*spec.robot);
  const Difference d = run(
      spec, [&](double t) { return trot.targets(t); }, 4.5, [](RobotState& s) { s.p_WB.z() += 0.005; });
  EXPECT_LT(d.position, kTrot);
  EXPECT_EQ(d.contacts, 0);
}

TEST_P(MatchedParity, AnotherRobot) {
  const WorldSpec spec = exact_world(scenes::long_quadruped());
  const scenes::Trot trot(*spec.robot);
  EXPECT_LT(run(
                spec, [&](double t) { return trot.targets(t); }, 3)
                .position,
            kTrot);
}

TEST_P(MatchedParity, OtherContactAndTimeStep) {
  for (const double dt : {5e-4, 2e-3}) {
    WorldSpec spec = exact_world(scenes::quadruped());
    spec.physics_dt = dt;
    spec.contact.friction = 0.3;
    spec.contact.impratio = 5;
    spec.contact.softness = {0.01, 0.8, 0.8, 0.98, 0.002};
    const scenes::Trot trot(*spec.robot);
    EXPECT_LT(run(
                  spec, [&](double t) { return trot.targets(t); }, 2)
                  .position,
              kTrot)
        << dt;
  }
}

TEST_P(MatchedParity, FrictionlessFeet) {
  WorldSpec spec = exact_world(scenes::quadruped());
  spec.contact.friction = 0;
  const scenes::Trot trot(*spec.robot);
  EXPECT_LT(run(
                spec, [&](double t) { return trot.targets(t); }, 1.5)
                .position,
            kTrot);
}

TEST_P(MatchedParity, OnItsBackEverythingTouches) {
  // Dropped on its back: trunk corners and knees hit the ground, far more contacts than feet.
  const WorldSpec spec = exact_world(scenes::quadruped());
  const JointTargets home = scenes::home_targets(*spec.robot);
  const Difference d = run(
      spec, [&](double) { return home; }, 1,
      [](RobotState& s) {
        s.q_WB = from_roll_pitch_yaw(3.0, 0.1, 0.3);
        s.p_WB.z() = 0.12;
      });
  EXPECT_LT(d.position, kTrot);
  EXPECT_LT(d.joint, kTrot);
}

TEST_P(MatchedParity, MassMatrix) {
  const auto a = make_backend(reference(), exact_world(scenes::quadruped()));
  const auto b = make_backend(GetParam(), exact_world(scenes::quadruped()));
  RobotState state = a->home_state();
  state.q_WB = from_roll_pitch_yaw(0.4, -0.7, 2);
  for (Eigen::Index i = 0; i < state.q.size(); ++i)
    state.q[i] += 0.3 * std::sin(3.0 * static_cast<double>(i));
  a->reset(state);
  b->reset(state);
  const Eigen::MatrixXd A = a->mass_matrix(), B = b->mass_matrix();
  const Eigen::VectorXd scale = A.diagonal().cwiseSqrt();
  const double worst = ((A - B).array() / (scale * scale.transpose()).array()).abs().maxCoeff();
  measured("mass matrix, relative", worst);
  EXPECT_LT(worst, 1e-10);  // Bullet's is the inverse of an inverse: condition number 1e5 times rounding
}

TEST_P(MatchedParity, PushesMoveAlike) {
  const WorldSpec spec = exact_world(scenes::quadruped());
  const auto a = make_backend(reference(), spec), b = make_backend(GetParam(), spec);
  const JointTargets home = scenes::home_targets(*spec.robot);
  for (int i = 0; i < 1000; ++i) {
    if (i % 250 == 100) {
      a->apply_push({0.05, -0.04, 0.02});
      b->apply_push({0.05, -0.04, 0.02});
    }
    ASSERT_EQ(a->step(home), StepStatus::kOk);
    ASSERT_EQ(b->step(home), StepStatus::kOk);
  }
  EXPECT_LT((a->state().p_WB - b->state().p_WB).norm(), kStand);
}

// An independent engine: hard contact against soft.
class NativeParity : public BackendTest {
 protected:
  struct Walk {
    double distance, rms_roll, rms_pitch;  // m, deg
  };
  static Walk walk(const std::string& engine, const Terrain& terrain) {
    WorldSpec spec = scenes::world_of(scenes::quadruped());
    spec.terrain = terrain;
    const auto backend = make_backend(engine, spec);
    RobotState start = backend->home_state();
    start.p_WB.z() += terrain.field() != nullptr ? 0.005 : 0.0;
    backend->reset(start);
    const scenes::Trot trot(*spec.robot);
    double roll = 0, pitch = 0;
    const int steps = 5500;
    for (int i = 0; i < steps; ++i) {
      EXPECT_EQ(backend->step(trot.targets(i * 1e-3)), StepStatus::kOk);
      const Vector3 rpy = roll_pitch_yaw(backend->state().q_WB);
      roll += rpy.x() * rpy.x();
      pitch += rpy.y() * rpy.y();
    }
    constexpr double kDegrees = 180 / M_PI;
    return {backend->state().p_WB.x(), std::sqrt(roll / steps) * kDegrees,
            std::sqrt(pitch / steps) * kDegrees};
  }
  static void expect_close(const Terrain& terrain, double share) {
    const Walk a = walk(reference(), terrain), b = walk(GetParam(), terrain);
    measured("distance of the reference, m", a.distance);
    measured("distance, relative difference", b.distance / a.distance - 1);
    measured("RMS roll, difference, deg", b.rms_roll - a.rms_roll);
    measured("RMS pitch, difference, deg", b.rms_pitch - a.rms_pitch);
    EXPECT_NEAR(b.distance, a.distance, share * a.distance);
    EXPECT_NEAR(b.rms_roll, a.rms_roll, 1);
    EXPECT_NEAR(b.rms_pitch, a.rms_pitch, 1);
  }
};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(NativeParity);
INSTANTIATE_TEST_SUITE_P(Followers, NativeParity, ::testing::ValuesIn(followers(false)), backend_of_test);

// The design's bounds for hard against soft contact: 8 % of distance and 1 degree on flat ground, 10 % on
// rough.
TEST_P(NativeParity, TrotOnFlat) { expect_close(Terrain(), 0.08); }
TEST_P(NativeParity, TrotOnRoughGround) { expect_close(make_terrain("rough", 4), 0.10); }

}  // namespace
}  // namespace crossgait
