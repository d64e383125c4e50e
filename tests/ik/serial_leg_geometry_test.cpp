// What is derived from a robot's joints, and what is refused.
#include <gtest/gtest.h>

#include "ik/serial_leg.h"
#include "physics/core/error.h"
#include "tests/ik/serial_robot.h"

namespace crossgait {
namespace {

using test::geometry;
using test::LegAtZero;
using test::SerialRobot;
using test::uniform;

TEST(SerialLegGeometry, OfAPlainLegIsItsFigures) {
  LegAtZero leg;  // hip 0.08 m out of the abduction axis, thigh 0.21 m, shin 0.21 m, hanging straight down
  leg.leg = Leg::RR;
  leg.abduction = {-0.2, -0.05, 0.01};
  leg.hip = {-0.23, -0.13, -0.02};
  leg.knee = {-0.23, -0.14, -0.23};
  leg.foot = {-0.23, -0.12, -0.44};
  leg.knee_axis = -Vector3::UnitY();
  const SerialLegGeometry g = geometry(leg, test::serial_robot(leg));
  // Sums of two file numbers below 1 m.
  EXPECT_LT((g.p_BL - Vector3(-0.23, -0.12, -0.02)).norm(), 1e-15);  // on the hip axis, in the foot's plane
  EXPECT_EQ(g.side, -1);
  EXPECT_NEAR(g.axis_to_plane_out, 0.07, 1e-15);
  EXPECT_NEAR(g.axis_to_shoulder_down, 0.03, 1e-15);
  EXPECT_EQ(g.tilt_sign, -1);  // about +x a foot swings to +y: inward on the right
  EXPECT_EQ(g.chain.shoulder_sign, 1);
  EXPECT_EQ(g.chain.elbow_sign, -1);
  EXPECT_NEAR(g.chain.upper, 0.21, 1e-15);
  EXPECT_NEAR(g.chain.lower, 0.21, 1e-15);
}

TEST(SerialLegGeometry, SlightlySkewAxesCostWhatIsSaid) {
  std::mt19937 random(6);
  double worst = 0;
  for (int i = 0; i < 500; ++i) {
    LegAtZero leg = test::random_leg(random, true);
    const SerialLegGeometry straight = geometry(leg, test::serial_robot(leg));
    for (Vector3* axis : {&leg.abduction_axis, &leg.hip_axis, &leg.knee_axis}) {
      const Vector3 skew = axis->cross(test::random_direction(random)).normalized();
      *axis = (*axis + 0.99 * kAxisAlignment * skew).normalized();
    }
    const SerialRobot made = test::serial_robot(leg, &random);
    const SerialLegGeometry g = geometry(leg, made);
    const SerialAngles q{uniform(random, -3, 3), uniform(random, -3, 3), uniform(random, -3, 3)};
    const double error = (g.p_BL + forward_serial(g, q) - made.foot(q)).norm();
    EXPECT_LT((forward_serial(g, q) - forward_serial(straight, q)).norm(),
              1e-13);                                       // roundings of a dozen lengths
    const double largest = leg.thigh() + leg.shin() + 0.3;  // of a foot's distance from any of the joints
    ASSERT_LT(error, 2 * kAxisAlignment * 3 * largest);
    worst = std::max(worst, error / largest);
  }
  EXPECT_GT(worst, 1e-5);  // the skew did something
}

/// One way to make the leg something else than a serial one, and what the message must name.
struct BrokenSerialLeg {
  const char* name;
  void (*break_it)(SerialRobot&);
  const char* element;
};

class NotASerialLeg : public testing::TestWithParam<BrokenSerialLeg> {};

TEST_P(NotASerialLeg, IsAnErrorThatNamesTheElement) {
  LegAtZero leg;
  SerialRobot made = test::serial_robot(leg);
  GetParam().break_it(made);
  try {
    geometry(leg, made);
    FAIL() << "no error";
  } catch (const ConfigError& e) {
    EXPECT_EQ(e.source(), "made.urdf");
    EXPECT_NE(e.element().find("leg FL"), std::string::npos) << e.what();
    EXPECT_NE(e.element().find(GetParam().element), std::string::npos) << e.what();
    EXPECT_FALSE(e.expected().empty() || e.found().empty()) << e.what();
  }
}

Vector3 skewed(const Vector3& axis) { return (axis + Vector3(2e-4, 2e-4, 2e-4)).normalized(); }

INSTANTIATE_TEST_SUITE_P(
    , NotASerialLeg,
    testing::Values(
        BrokenSerialLeg{"SkewAbduction",
                        [](SerialRobot& r) { r.robot.bodies[1].joint.axis = skewed(Vector3::UnitX()); },
                        "joint abduction"},
        BrokenSerialLeg{"SkewHip",
                        [](SerialRobot& r) { r.robot.bodies[2].joint.axis = skewed(Vector3::UnitY()); },
                        "joint hip"},
        BrokenSerialLeg{"KneeAboutZ", [](SerialRobot& r) { r.robot.bodies[3].joint.axis = Vector3::UnitZ(); },
                        "joint knee"},
        BrokenSerialLeg{"KneeOnTheTrunk", [](SerialRobot& r) { r.robot.bodies[3].parent = 0; }, "joint knee"},
        BrokenSerialLeg{"HipOnTheTrunk", [](SerialRobot& r) { r.robot.bodies[2].parent = 0; }, "joint hip"},
        BrokenSerialLeg{"NoSuchJoint", [](SerialRobot& r) { r.joints.knee = 3; }, "knee"},
        BrokenSerialLeg{"NegativeJoint", [](SerialRobot& r) { r.joints.hip = -1; }, "hip"},
        BrokenSerialLeg{"AbductionOutOfRange", [](SerialRobot& r) { r.joints.abduction = -2; }, "abduction"},
        BrokenSerialLeg{"FootOnTheThigh", [](SerialRobot& r) { r.joints.foot_body = 2; }, "foot"},
        BrokenSerialLeg{"NoThigh",
                        [](SerialRobot& r) { r.robot.bodies[3].X_PB.translation() = Vector3(0, 0.1, 0); },
                        "thigh"},
        BrokenSerialLeg{"NoShin", [](SerialRobot& r) { r.joints.p_BF = Vector3(0, 0.1, 0); }, "shin"}),
    [](const auto& p) { return p.param.name; });

TEST(IsSerialLeg, LooksAtTheAxesAlone) {
  const LegAtZero leg;
  SerialRobot made = test::serial_robot(leg);
  EXPECT_TRUE(is_serial_leg(made.robot, leg.leg, made.joints));
  for (std::size_t body = 1; body <= 3; ++body) {
    SerialRobot other = made;
    other.robot.bodies[body].joint.axis = skewed(other.robot.bodies[body].joint.axis);
    EXPECT_FALSE(is_serial_leg(other.robot, leg.leg, other.joints));
    EXPECT_TRUE(is_serial_leg(other.robot, leg.leg, other.joints, 1e-3));
  }
  made.joints.knee = 7;
  EXPECT_THROW((void)is_serial_leg(made.robot, leg.leg, made.joints), ConfigError);
}

}  // namespace
}  // namespace crossgait
