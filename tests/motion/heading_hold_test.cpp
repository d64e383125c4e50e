#include "motion/heading_hold.h"

#include <cmath>

#include <gtest/gtest.h>

namespace crossgait {
namespace {

constexpr double kLookEvery = 2e-3;  // s

RobotState heading(double yaw, double roll = 0, double pitch = 0) {
  RobotState state;
  state.q_WB = from_roll_pitch_yaw(roll, pitch, yaw);
  return state;
}

TEST(HeadingHold, SteersBackToWhereItFirstLooked) {
  HeadingHoldState hold;
  const HeadingHold options;
  EXPECT_EQ(hold.update(options, heading(1), 0, kLookEvery), 0);
  // Too far to the left by 0.1 rad, whatever the roll and pitch; rounding of an angle of one.
  EXPECT_NEAR(hold.update(options, heading(1.1, 0.2, -0.3), 0, kLookEvery), -0.1 * options.gain, 1e-15);
  EXPECT_NEAR(hold.update(options, heading(0.95), 0, kLookEvery), 0.05 * options.gain, 1e-15);
}

TEST(HeadingHold, TurnsNoFasterThanItsBound) {
  HeadingHoldState hold;
  const HeadingHold options{.max_rate = 0.3};
  hold.update(options, heading(0), 0, kLookEvery);
  EXPECT_EQ(hold.update(options, heading(1), 0, kLookEvery), -0.3);
  EXPECT_EQ(hold.update(options, heading(-1), 0, kLookEvery), 0.3);
}

TEST(HeadingHold, TurnsTheShortWayRound) {
  HeadingHoldState hold;
  const HeadingHold options;
  hold.update(options, heading(3.1), 0, kLookEvery);
  // From 3.1 on to -3.1 are 2 pi - 6.2 rad, to the left; rounding of 2 pi.
  EXPECT_NEAR(hold.update(options, heading(-3.1), 0, kLookEvery), -options.gain * (2 * M_PI - 6.2), 1e-14);
}

TEST(HeadingHold, FollowsTheCommandedTurn) {
  HeadingHoldState hold;
  const HeadingHold options;
  constexpr double kRate = 0.5;
  for (int i = 0; i < 1000; ++i) {  // 2 s, more than half a turn with what follows
    const double late = 0.04;       // rad behind, as a robot is that needs 0.08 rad/s more than commanded
    const double yaw = kRate * kLookEvery * i - (i == 0 ? 0 : late);
    // The sum of a thousand steps, 1e-16 of a radian each.
    EXPECT_NEAR(hold.update(options, heading(yaw), kRate, kLookEvery), i == 0 ? 0 : options.gain * late,
                1e-12);
  }
}

TEST(HeadingHold, BeginsAnewWhenRestarted) {
  HeadingHoldState hold;
  const HeadingHold options;
  hold.update(options, heading(0), 0, kLookEvery);
  hold.restart();
  EXPECT_EQ(hold.update(options, heading(2), 0, kLookEvery), 0);
}

TEST(HeadingHold, DoesNothingWhereItIsOff) {
  HeadingHoldState hold;
  hold.update(HeadingHold::none(), heading(0), 0, kLookEvery);
  EXPECT_EQ(hold.update(HeadingHold::none(), heading(1), 0, kLookEvery), 0);
}

}  // namespace
}  // namespace crossgait
