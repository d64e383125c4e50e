#include "parity/divergence.h"

#include <cmath>

#include <gtest/gtest.h>

namespace crossgait {
namespace {

Trace straight(int samples, double dt) {
  TraceSample sample;
  sample.state.q = sample.state.qd = sample.targets.q = JointVector::Zero(3);
  Trace trace;
  for (int i = 0; i < samples; ++i) {
    sample.state.time = (i + 1) * dt;
    sample.state.p_WB.x() = 0.1 * sample.state.time;
    trace.push_back(sample);
  }
  return trace;
}

TEST(AttitudeDifference, IsTheAngleBetweenOrientations) {
  const Quaternion a = from_roll_pitch_yaw(0.2, -0.3, 1.0);
  for (const double angle : {0.0, 1e-9, 1e-4, 0.7, 3.0}) {
    const Quaternion b = a * Quaternion(Eigen::AngleAxisd(angle, Vector3(1, 2, 3).normalized()));
    EXPECT_NEAR(attitude_difference(a, b), angle, 1e-15 + 1e-14 * angle);  // rounding of unit quaternions
    EXPECT_NEAR(attitude_difference(a, Quaternion(-b.coeffs())), angle,
                1e-15 + 1e-14 * angle);  // q and -q are one rotation
  }
}

TEST(CompareTraces, IdenticalRunsDoNotDiverge) {
  const Trace a = straight(100, 2e-3);
  const PairDifference pair = compare_traces(a, a, {});
  EXPECT_EQ(pair.max_position_difference_m, 0);
  EXPECT_EQ(pair.max_joint_difference_rad, 0);
  EXPECT_FALSE(pair.first_divergence);
}

TEST(CompareTraces, NamesWhatLeftItsToleranceFirst) {
  const Trace a = straight(100, 2e-3);
  Trace b = a;
  for (std::size_t i = 30; i < b.size(); ++i) b[i].state.q[1] += 0.02;
  for (std::size_t i = 60; i < b.size(); ++i) b[i].state.p_WB.y() += 0.5;
  const PairDifference pair = compare_traces(a, b, {});
  EXPECT_DOUBLE_EQ(pair.max_joint_difference_rad, 0.02);
  EXPECT_DOUBLE_EQ(pair.max_position_difference_m, 0.5);
  ASSERT_TRUE(pair.first_divergence);
  EXPECT_EQ(pair.first_divergence->quantity, "joint");
  EXPECT_DOUBLE_EQ(pair.first_divergence->time_s, 31 * 2e-3);
  EXPECT_DOUBLE_EQ(pair.first_divergence->tolerance, DivergenceTolerances{}.joint);
}

TEST(CompareTraces, WhatStaysWithinItsToleranceIsNoDivergence) {
  const Trace a = straight(100, 2e-3);
  Trace b = a;
  const double each = DivergenceTolerances{}.position / 50;
  for (std::size_t i = 0; i < b.size(); ++i) b[i].state.p_WB.y() += each * static_cast<double>(i);
  const PairDifference pair = compare_traces(a, b, {});
  ASSERT_TRUE(pair.first_divergence);
  EXPECT_EQ(pair.first_divergence->quantity, "position");
  EXPECT_NEAR(pair.first_divergence->time_s, 52 * 2e-3, 2e-3 + 1e-12);  // 50 of them are the tolerance itself
  b.resize(50);
  EXPECT_FALSE(compare_traces(a, b, {}).first_divergence);
}

TEST(CompareTraces, OfSeveralInOneStepTheWorstIsNamed) {
  const Trace a = straight(10, 2e-3);
  Trace b = a;
  b[5].state.q[0] += 0.011;    // 1.1 times its tolerance
  b[5].state.p_WB.z() += 0.1;  // 100 times
  const PairDifference pair = compare_traces(a, b, {});
  ASSERT_TRUE(pair.first_divergence);
  EXPECT_EQ(pair.first_divergence->quantity, "position");
}

TEST(CompareTraces, WatchesLoadsAndTorquesWhenAsked) {
  Trace a = straight(10, 2e-3);
  for (TraceSample& sample : a) sample.torques = JointVector::Zero(3);
  Trace b = a;
  b[3].load[Leg::RL] = 0.5;
  b[2].torques[1] = 1e-3;
  EXPECT_FALSE(compare_traces(a, b, {}).first_divergence);
  const PairDifference pair = compare_traces(a, b, DivergenceTolerances::fine());
  ASSERT_TRUE(pair.first_divergence);
  EXPECT_EQ(pair.first_divergence->quantity, "torque");
  b[2].load[Leg::FR] = 1;  // a thousand times its tolerance, the torque a hundred
  EXPECT_EQ(compare_traces(a, b, DivergenceTolerances::fine()).first_divergence->quantity, "load");
}

TEST(CompareTraces, TorquesOfOtherJointsOrOfNoneDoNotDiffer) {
  Trace a = straight(10, 2e-3);
  for (TraceSample& sample : a) sample.torques = JointVector::Constant(3, 5);
  Trace shorter = a, none = a;
  for (TraceSample& sample : shorter) sample.torques = JointVector::Constant(2, 7);
  for (TraceSample& sample : none) sample.torques = JointVector();
  for (const Trace* b : {&shorter, &none}) {
    EXPECT_FALSE(compare_traces(a, *b, DivergenceTolerances::fine()).first_divergence);
    EXPECT_FALSE(compare_traces(*b, a, DivergenceTolerances::fine()).first_divergence);
  }
}

TEST(CompareTraces, CoversTheTimeBothRan) {
  const Trace a = straight(100, 2e-3), b = straight(50, 2e-3);
  EXPECT_FALSE(compare_traces(a, b, {}).first_divergence);
}

}  // namespace
}  // namespace crossgait
