// What MJCF files say in words that older compilers do not know, and what they say that nothing simulates.
#include <cmath>

#include "tests/backends/made_mjcf.h"

namespace crossgait {
namespace {

class MjcfNewer : public MjcfReader {
 protected:
  /// The first body of FL, with these elements in its thigh.
  Body thigh(const std::string& elements, const std::string& compiler = "") {
    MadeMjcf mjcf;
    mjcf.compiler = compiler;
    mjcf.thigh = elements;
    return body(tree(mjcf), "FL_thigh");
  }
};

// As MuJoCo 4.0.0 compiles them: a frame at (.1, .2, .3), turned by 90 degrees about z, moves (1, 0, 0) to
// (.1, 1.2, .3).
TEST_F(MjcfNewer, FramesArePlacesInTheirBody) {
  for (const char* turn :
       {R"(euler="0 0 90")", R"(quat="1 0 0 1")", R"(axisangle="0 0 2 90")", R"(xyaxes="0 3 0 -1 1 0")"}) {
    SCOPED_TRACE(turn);
    const Body body = thigh(fmt::format(
        R"(<frame pos=".1 .2 .3" {}><geom name="ball" size=".03" pos="1 0 0"/>)"
        R"(<geom name="rod" type="capsule" size=".02" fromto="0 0 0 .4 0 0"/>)"
        R"(<frame pos="0 0 1"><geom name="box" type="box" size=".1 .2 .3" pos="1 0 0"/></frame></frame>)",
        turn));
    ASSERT_EQ(body.shapes.size(), 3U);
    EXPECT_LT((body.shapes[0].X_BG.translation() - Vector3(0.1, 1.2, 0.3)).norm(), 1e-12);
    EXPECT_LT((body.shapes[1].X_BG.translation() - Vector3(0.1, 0.4, 0.3)).norm(), 1e-12);
    EXPECT_NEAR(std::abs(body.shapes[1].X_BG.linear().col(2).y()), 1, 1e-12);
    EXPECT_LT((body.shapes[2].X_BG.translation() - Vector3(0.1, 1.2, 1.3)).norm(), 1e-12);
    EXPECT_NEAR(std::abs(body.shapes[2].X_BG.linear()(1, 0)), 1, 1e-12);
  }
  const Body about_fixed_axes = thigh(
      R"(<frame euler="1.5707963267948966 0 1.5707963267948966"><geom size=".03" pos="0 0 1"/></frame>)",
      R"(<compiler angle="radian" eulerseq="XYZ"/>)");
  EXPECT_LT((about_fixed_axes.shapes[0].X_BG.translation() - Vector3(1, 0, 0)).norm(), 1e-12);
  const Body by_z = thigh(R"(<frame zaxis="1 0 0"><geom size=".03" pos="0 0 1"/></frame>)");
  EXPECT_LT((by_z.shapes[0].X_BG.translation() - Vector3(1, 0, 0)).norm(), 1e-12);
}

TEST_F(MjcfNewer, FramesHoldBodiesJointsAndClasses) {
  MadeMjcf mjcf;
  mjcf.defaults = R"(<default class="damped"><joint damping="3"/></default>)";
  mjcf.trunk +=
      R"(<frame pos="0 0 .1" euler="0 0 90" childclass="damped"><body name="tail" pos="1 0 0">)"
      R"(<geom size=".05" mass=".1"/><frame euler="0 0 90"><joint name="wag" axis="1 0 0" pos="0 0 .1"/></frame>)"
      R"(</body></frame>)";
  const ParsedRobot robot = tree(mjcf);
  const Body& tail = body(robot, "tail");
  EXPECT_LT((tail.X_PB.translation() - Vector3(0, 1, 0.2)).norm(), 1e-12);
  EXPECT_LT((tail.joint.axis - Vector3(0, 1, 0)).norm(), 1e-12);
  EXPECT_EQ(tail.joint.damping, 3);
}

TEST_F(MjcfNewer, BadFramesAreRefusedByName) {
  const auto refused = [&](const std::string& elements) {
    MadeMjcf mjcf;
    mjcf.thigh = elements;
    return refusal(mjcf);
  };
  EXPECT_EQ(refused(R"(<frame pos="0 0"/>)").expected(), "3 finite number(s) in pos");
  EXPECT_EQ(refused(R"(<frame quat="0 0 0 0"/>)").expected(), "a quat of non-zero length");
  EXPECT_EQ(refused(R"(<frame zaxis="0 0 0"/>)").expected(), "axes of non-zero length in zaxis");
  MadeMjcf mjcf;
  mjcf.compiler = R"(<compiler eulerseq="xyw"/>)";
  mjcf.thigh = R"(<frame euler="1 2 3"/>)";
  EXPECT_EQ(refusal(mjcf).expected(), "three of the letters xyzXYZ in the compiler's eulerseq");
}

TEST_F(MjcfNewer, SitesThatAreConnectedAreALoopOfTheirBodies) {
  MadeMjcf mjcf;
  mjcf.defaults = R"(<site pos="0 0 -.1"/>)";
  mjcf.shin = R"(<site name="a"/>)";
  mjcf.thigh = R"(<frame pos="0 .3 0"><site name="b" pos="0 0 -.15"/></frame>)";
  mjcf.sections = R"(<equality><connect site1="a" site2="b"/></equality>)";
  const ParsedRobot robot = tree(mjcf);
  ASSERT_EQ(robot.loops.size(), 1U);
  EXPECT_EQ(robot.loops[0].link_a, "FL_shin");
  EXPECT_EQ(robot.loops[0].link_b, "FL_thigh");
  EXPECT_LT((robot.loops[0].p_a - Vector3(0, 0, -0.1)).norm(), 1e-15);
  EXPECT_LT((robot.loops[0].p_b - Vector3(0, 0.3, -0.15)).norm(), 1e-15);
  EXPECT_FALSE(robot.loop_softness);
  mjcf.sections = R"(<equality><connect site1="a" site2="c"/></equality>)";
  EXPECT_EQ(refusal(mjcf).expected(), "a site of this file in site2");
}

TEST_F(MjcfNewer, LoopsAreAsSoftAsTheFirstOfThemThatSaysIt) {
  MadeMjcf mjcf;
  mjcf.sections = R"(<equality><connect body1="trunk" body2="FR_shin" anchor="0 0 0"/>
                     <connect body1="FL_shin" body2="FR_shin" anchor="0 0 0" solref=".01 1"/>
                     <connect body1="RL_shin" body2="RR_shin" anchor="0 0 0" solref=".03 1"/></equality>)";
  const ParsedRobot robot = tree(mjcf);
  ASSERT_TRUE(robot.loop_softness);
  EXPECT_EQ(robot.loop_softness->time_constant, 0.01);
  EXPECT_EQ(robot.loop_softness->impedance_max, Softness().impedance_max);
  EXPECT_TRUE(warns(robot.warnings,
                    "that says one (0.01 1, 0.9 0.95 0.001), in the place of another (none said) of 1"));
  EXPECT_TRUE(warns(robot.warnings, "in the place of another (0.03 1, 0.9 0.95 0.001) of 1 <connect>"));
}

TEST_F(MjcfNewer, LoopsBetweenTwoLegsAreRefusedByName) {
  MadeMjcf mjcf;
  mjcf.sections = R"(<equality><connect body1="FL_shin" body2="FR_shin" anchor="0 0 0"/>
                     <connect body1="RL_shin" body2="RR_shin" anchor="0 0 0"/></equality>)";
  const auto refused = [&] {
    const ConfigError error = refusal(mjcf);
    EXPECT_EQ(error.expected(), "loops that close within a leg");
    return error.found();
  };
  EXPECT_EQ(refused(), "'connect_0' from 'FL_shin' to 'FR_shin', of two legs");
  // With a leg tied to the trunk, too, loops move all joints that there are.
  mjcf.sections.insert(mjcf.sections.find("<connect"),
                       R"(<connect body1="trunk" body2="FR_shin" anchor="0 0 0"/>)");
  EXPECT_EQ(refused(), "'connect_1' from 'FL_shin' to 'FR_shin', of two legs");
}

TEST_F(MjcfNewer, WhatNothingSimulatesIsSaid) {
  MadeMjcf mjcf;
  mjcf.trunk_joint = R"(<joint name="root" type="free" damping="3"/>)";
  mjcf.hip_joint = R"(frictionloss=".1" solreffriction=".03 1")";
  mjcf.sections = R"(<option actuatorgroupdisable="1"/>)";
  const std::vector<std::string> warnings = tree(mjcf).warnings;
  EXPECT_TRUE(
      warns(warnings, "did not simulate the damping of 3 and the armature of 0 of the base's free joint"));
  EXPECT_TRUE(warns(warnings, "did not simulate 4 attribute(s) solreffriction=\".03 1\" of <joint>"));
  EXPECT_TRUE(warns(warnings, "did not simulate 1 attribute(s) actuatorgroupdisable=\"1\" of <option>"));
}

TEST_F(MjcfNewer, AKeyframeThatMovesIsSaid) {
  MadeMjcf mjcf;
  const auto says = [&](const std::string& more) {
    mjcf.sections = fmt::format(
        R"(<keyframe><key qpos="0 0 0 1 0 0 0 .8 -1.6 .8 -1.6 .8 -1.6 .8 -1.6" {}/></keyframe>)", more);
    return warns(tree(mjcf).warnings, "took the angles alone, not ctrl, qvel and act, of 1 <key>");
  };
  EXPECT_FALSE(says(""));
  mjcf.sections = "";
  EXPECT_TRUE(says(R"(qvel="0 0 0 0 0 0 1 0 0 0 0 0 0 0")"));
}

TEST_F(MjcfNewer, FeetThatDoNotTouchTheFilesGroundAreSaid) {
  MadeMjcf mjcf;
  mjcf.defaults = R"(<default class="apart"><geom contype="2" conaffinity="4"/></default>)";
  mjcf.world = R"(<geom name="floor" type="plane" size="5 5 .1"/>)";
  mjcf.shin = R"(<geom class="apart" name="toe" size=".02" pos="0 0 -.21"/>)";
  EXPECT_TRUE(warns(load(mjcf).report.warnings, "feet FL do not touch the file's geom 'floor' in the file"));
  mjcf.defaults = R"(<default class="apart"><geom contype="2" conaffinity="5"/></default>)";
  EXPECT_FALSE(warns(load(mjcf).report.warnings, "do not touch"));
}

TEST_F(MjcfNewer, TheGroundMayBeABoxOrStandInABody) {
  const auto friction = [&](const std::string& world) {
    MadeMjcf mjcf;
    mjcf.world = world;
    return tree(mjcf).contact.shapes.at("FL_foot").friction[0];
  };
  EXPECT_EQ(friction(R"(<body name="floor"><geom type="plane" size="5 5 .1" friction="1.7"/></body>)"), 1.7);
  EXPECT_EQ(friction(R"(<geom type="box" size="5 5 .1" friction="1.6"/>)"), 1.6);
  EXPECT_EQ(
      friction(
          R"(<geom type="box" size="1 1 .1" friction="1.6"/><geom type="plane" size="5 5 .1" friction="1.5"/>)"),
      1.5);
  EXPECT_EQ(friction(R"(<body name="ball" pos="3 0 1"><freejoint/><geom size=".1" friction="1.4"/></body>)"),
            1);
}

TEST_F(MjcfNewer, APyramidalConeIsNoneOfARobots) {
  MadeMjcf mjcf;
  mjcf.sections = R"(<option cone="pyramidal"/>)";
  EXPECT_EQ(load(mjcf).robot.contact.find("cone"), nullptr);
  mjcf.sections = R"(<option cone="elliptic"/>)";
  EXPECT_NE(load(mjcf).robot.contact.find("cone"), nullptr);
}

TEST_F(MjcfNewer, EllipsoidsAreSpheresOrHulls) {
  const Body body = thigh(R"(<geom name="ball" type="ellipsoid" size=".05 .05 .05" pos="0 0 -.1"/>)"
                          R"(<geom name="egg" type="ellipsoid" size=".02 .03 .05" pos="0 0 -.2"/>)");
  ASSERT_EQ(body.shapes.size(), 2U);
  EXPECT_EQ(body.shapes[0].type, ShapeType::kSphere);
  EXPECT_EQ(body.shapes[0].size[0], 0.05);
  EXPECT_EQ(body.shapes[1].type, ShapeType::kHull);
  for (const Vector3& p : body.shapes[1].vertices)
    EXPECT_NEAR(p.cwiseQuotient(Vector3(0.02, 0.03, 0.05)).norm(), 1, 1e-12);
}

TEST_F(MjcfNewer, ToesAreAllOfAFoot) {
  MadeMjcf mjcf;
  mjcf.shin = R"(<geom name="toe" pos=".04 0 -.2" size=".02"/>)";
  const RobotDescription robot = load(mjcf).robot;
  const LegModel& leg = (*robot.legs)[Leg::FL];
  EXPECT_LT((leg.p_BF - Vector3(0.02, 0, -0.2)).norm(), 1e-12);
  EXPECT_EQ(robot.bodies[static_cast<std::size_t>(leg.foot_body)].shapes.size(), 2U);
  for (const int shape : {0, 1})
    EXPECT_EQ(leg_of_shape(robot, leg.foot_body, shape), static_cast<int>(Leg::FL));
  // However far apart, and whichever comes first.
  mjcf.shin =
      R"(<geom pos=".08 0 -.2" size=".02"/><geom pos="0 .08 -.2" size=".02"/><geom pos=".08 .08 -.2" size=".02"/>)";
  EXPECT_LT(((*load(mjcf).robot.legs)[Leg::FL].p_BF - Vector3(0.04, 0.04, -0.2)).norm(), 1e-12);
  // A ball by the knee is none of it.
  mjcf.shin = R"(<geom name="knee" pos="0 0 -.1" size=".02"/>)";
  const RobotDescription other = load(mjcf).robot;
  EXPECT_EQ(leg_of_shape(other, (*other.legs)[Leg::FL].foot_body, 0), -1);
  EXPECT_EQ((*other.legs)[Leg::FL].p_BF, Vector3(0, 0, -0.2));
}

}  // namespace
}  // namespace crossgait
