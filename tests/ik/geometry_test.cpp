#include "ik/geometry.h"

#include <gtest/gtest.h>

#include "ik/leg_kinematics.h"
#include "physics/core/error.h"
#include "physics/robot_files/data_path.h"
#include "tests/ik/test_leg.h"

namespace crossgait {
namespace {

// Sums of file numbers with a few decimals: rounding of magnitudes below 1 m.
constexpr double kRounding = 1e-15;

RobotDescription robot() { return load_robot(find_robot("scara_quadruped")); }

void expect_equal(const TwoLinkChain& chain, const TwoLinkChain& expected) {
  EXPECT_NEAR(chain.shoulder_x, expected.shoulder_x, kRounding);
  EXPECT_NEAR(chain.upper, expected.upper, kRounding);
  EXPECT_NEAR(chain.lower, expected.lower, kRounding);
  EXPECT_LT((chain.upper_zero - expected.upper_zero).norm(), kRounding);
  EXPECT_LT((chain.lower_zero - expected.lower_zero).norm(), kRounding);
  EXPECT_EQ(chain.shoulder_sign, expected.shoulder_sign);
  EXPECT_EQ(chain.elbow_sign, expected.elbow_sign);
}

TEST(FiveBarGeometry, OfTheRobotFileIsTheDesignsFigures) {
  const LegArray<FiveBarGeometry> legs = five_bar_geometry(robot());
  for (const Leg leg : kLegs) {
    SCOPED_TRACE(name(leg));
    const FiveBarGeometry expected = test::hand_made_leg(leg);
    EXPECT_LT((legs[leg].p_BL - expected.p_BL).norm(), kRounding);
    EXPECT_EQ(legs[leg].side, expected.side);
    EXPECT_NEAR(legs[leg].axis_to_plane_out, 0.024, kRounding);
    EXPECT_NEAR(legs[leg].axis_to_shoulder_down, 0.010, kRounding);
    EXPECT_NEAR(legs[leg].base_distance(), 0.020, kRounding);
    EXPECT_EQ(legs[leg].tilt_sign, expected.tilt_sign);
    expect_equal(legs[leg].a, expected.a);
    expect_equal(legs[leg].b, expected.b);
    EXPECT_EQ(make_leg_kinematics(robot(), leg).origin(), legs[leg].p_BL);
  }
}

TEST(FiveBarGeometry, TakesLimitsFromTheRobot) {
  RobotDescription r = robot();
  const LegModel& leg = (*r.legs)[Leg::RR];
  r.bodies[static_cast<std::size_t>(leg.joint("elbow_right")) + 1].joint.upper = 2.25;
  r.bodies[static_cast<std::size_t>(leg.joint("tilt")) + 1].joint.lower = -0.25;
  const FiveBarGeometry g = five_bar_geometry(r, Leg::RR);
  EXPECT_EQ(g.b.elbow_limits.upper, 2.25);
  EXPECT_EQ(g.tilt_limits.lower, -0.25);
}

TEST(FiveBarGeometry, AnOppositeAxisOnlyFlipsASign) {
  RobotDescription r = robot();
  const LegModel& leg = (*r.legs)[Leg::FR];
  for (const int joint : {leg.joint("tilt"), leg.joint("shoulder_left"), leg.joint("elbow_right")}) {
    r.bodies[static_cast<std::size_t>(joint) + 1].joint.axis *= -1;
  }
  const FiveBarGeometry g = five_bar_geometry(r, Leg::FR);
  EXPECT_EQ(g.tilt_sign, 1);  // a right leg tilts outward about -x
  EXPECT_EQ(g.a.shoulder_sign, -1);
  EXPECT_EQ(g.a.elbow_sign, 1);
  EXPECT_EQ(g.b.shoulder_sign, 1);
  EXPECT_EQ(g.b.elbow_sign, -1);
}

/// One way to make the robot's leg something else than a five-bar, and what the message must name.
struct BrokenLeg {
  const char* name;
  void (*break_it)(RobotDescription&, const LegModel&);
  const char* element;
};

Body& body_of(RobotDescription& r, int joint) { return r.bodies[static_cast<std::size_t>(joint) + 1]; }

class NotAFiveBar : public testing::TestWithParam<BrokenLeg> {};

TEST_P(NotAFiveBar, IsAnErrorThatNamesTheElement) {
  RobotDescription r = robot();
  GetParam().break_it(r, (*r.legs)[Leg::FL]);
  try {
    five_bar_geometry(r, Leg::FL);
    FAIL() << "no error";
  } catch (const ConfigError& e) {
    EXPECT_NE(e.source().find("robot"), std::string::npos) << e.what();
    EXPECT_NE((e.source() + e.element()).find("leg FL"), std::string::npos) << e.what();
    EXPECT_NE(e.element().find(GetParam().element), std::string::npos) << e.what();
    EXPECT_FALSE(e.expected().empty()) << e.what();
  }
}

INSTANTIATE_TEST_SUITE_P(
    , NotAFiveBar,
    testing::Values(
        BrokenLeg{"SkewShoulderAxis",
                  [](RobotDescription& r, const LegModel& leg) {
                    body_of(r, leg.joint("shoulder_left")).joint.axis = Vector3(0, 1, 3e-4).normalized();
                  },
                  "FL_shoulder_left"},
        BrokenLeg{"TiltAboutY",
                  [](RobotDescription& r, const LegModel& leg) {
                    body_of(r, leg.joint("tilt")).joint.axis = Vector3::UnitY();
                  },
                  "FL_tilt"},
        BrokenLeg{
            "TurnedElbowFrame",
            [](RobotDescription& r, const LegModel& leg) {
              body_of(r, leg.joint("elbow_right")).X_PB.rotate(Eigen::AngleAxisd(0.1, Vector3::UnitZ()));
            },
            "FL_elbow_right"},
        BrokenLeg{"ShoulderHigher",
                  [](RobotDescription& r, const LegModel& leg) {
                    body_of(r, leg.joint("shoulder_right")).X_PB.translation().z() += 0.001;
                  },
                  "shoulders"},
        BrokenLeg{"ShouldersExchanged",
                  [](RobotDescription& r, const LegModel& leg) {
                    std::swap(body_of(r, leg.joint("shoulder_left")).X_PB,
                              body_of(r, leg.joint("shoulder_right")).X_PB);
                  },
                  "shoulders"},
        BrokenLeg{"FootBesideTheTip",
                  [](RobotDescription& r, const LegModel&) { (*r.legs)[Leg::FL].p_BF.z() -= 0.001; }, "foot"},
        BrokenLeg{"FootOnTheTrunk",
                  [](RobotDescription& r, const LegModel&) { (*r.legs)[Leg::FL].foot_body = 0; }, "foot"},
        BrokenLeg{"OpenLinkage", [](RobotDescription& r, const LegModel&) { r.loops.clear(); }, "loop"},
        BrokenLeg{"TipsInTwoPlanes",
                  [](RobotDescription& r, const LegModel& leg) {
                    body_of(r, leg.joint("shoulder_right")).X_PB.translation().y() += 0.002;
                  },
                  "lower links"},
        BrokenLeg{"NoUpperLink",
                  [](RobotDescription& r, const LegModel& leg) {
                    body_of(r, leg.joint("elbow_left")).X_PB.translation().setZero();
                  },
                  "upper link"},
        BrokenLeg{"ChainsThatCannotMeet",
                  [](RobotDescription& r, const LegModel& leg) {
                    body_of(r, leg.joint("elbow_left")).X_PB.translation() = Vector3(0, 0, -0.2);
                  },
                  "links"},
        BrokenLeg{"ShoulderOnAnotherLeg",
                  [](RobotDescription& r, const LegModel& leg) {
                    body_of(r, leg.joint("shoulder_left")).parent = (*r.legs)[Leg::FR].joint("tilt") + 1;
                  },
                  "FL_shoulder_left"}),
    [](const auto& p) { return p.param.name; });

TEST(FiveBarGeometry, OfARobotWithoutLegsIsAnError) {
  RobotDescription r = robot();
  r.legs.reset();
  EXPECT_THROW(five_bar_geometry(r, Leg::FL), ConfigError);
}

}  // namespace
}  // namespace crossgait
