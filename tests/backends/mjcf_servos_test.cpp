// What MJCF files say of servos, joints and contact is what the description holds, whichever release of the
// compiler reads the rest.
#include <cmath>
#include <filesystem>
#include <memory>
#include <set>

#include "backends/plugin_loader.h"
#include "physics/robot/multibody.h"
#include "physics/robot/robot_members.h"
#include "tests/backends/made_mjcf.h"

namespace crossgait {
namespace {

namespace fs = std::filesystem;

class MjcfServos : public MjcfReader {
 protected:
  /// The joint of FL's hip with this actuator on it.
  Joint hip(const std::string& actuators, const std::string& joint = "", const std::string& defaults = "") {
    MadeMjcf mjcf;
    mjcf.compiler = compiler_;
    mjcf.defaults = defaults;
    mjcf.hip_joint = joint;
    mjcf.sections = sections_ + "<actuator>" + actuators + "</actuator>";
    const ParsedRobot robot = tree(mjcf);
    warnings_ = robot.warnings;
    return body(robot, "FL_thigh").joint;
  }
  bool warned(const std::string& of) const { return warns(warnings_, of); }

  std::string compiler_ = "<compiler angle=\"radian\"/>", sections_;
  std::vector<std::string> warnings_;
};

TEST_F(MjcfServos, TheTorqueLimitIsTheLeastOfAllThatTheFileSays) {
  EXPECT_EQ(hip(R"(<motor joint="FL_hip" ctrlrange="-35 35"/>)", R"(actuatorfrcrange="-9 9")").effort_limit,
            9);
  EXPECT_EQ(hip(R"(<motor joint="FL_hip" ctrlrange="-35 35"/>)", R"(actuatorfrcrange="-90 90")").effort_limit,
            35);
  EXPECT_EQ(hip(R"(<motor joint="FL_hip" gear="2" ctrlrange="-35 35" forcerange="-8 8"/>)").effort_limit, 16);
  // The gear is before the joint's own limit.
  EXPECT_EQ(
      hip(R"(<position joint="FL_hip" kp="60" gear="3" forcerange="-8 8"/>)", R"(actuatorfrcrange="-20 20")")
          .effort_limit,
      20);
  EXPECT_EQ(hip(R"(<position joint="FL_hip" kp="60" ctrlrange="-1 1"/>)").effort_limit, 0);
}

TEST_F(MjcfServos, ALimitOfTheJointIsThatOfAllItsActuators) {
  const std::string two = R"(<position joint="FL_hip" kp="60" forcerange="-8 8"/>
                             <velocity joint="FL_hip" kv="2" forcerange="-8 8"/>)";
  EXPECT_EQ(hip(two).effort_limit, 16);
  EXPECT_EQ(hip(two, R"(actuatorfrcrange="-10 10")").effort_limit, 10);
  EXPECT_EQ(hip(two).kd, 2);
}

TEST_F(MjcfServos, AreDampedAtAStepsEndUnderImplicitIntegrators) {
  const std::string servo = R"(<position joint="FL_hip" kp="60" kv="2"/>)";
  EXPECT_EQ(hip(servo).implicit_damping, 0);
  const std::string compiler = compiler_;
  for (const char* integrator : {"implicit", "implicitfast"}) {
    compiler_ = compiler + "<option integrator=\"" + integrator + "\"/>";
    EXPECT_EQ(hip(servo).implicit_damping, 1) << integrator;
    EXPECT_EQ(hip(servo).implicit_stiffness, 0) << integrator;
    EXPECT_EQ(hip(R"(<position joint="FL_hip" kp="60"/>)").implicit_damping, 0) << "nothing is damped";
  }
  compiler_ = compiler + R"(<option integrator="RK4"/>)";
  EXPECT_EQ(hip(servo).implicit_damping, 0);
}

TEST_F(MjcfServos, JointsAreDampedAtAStepsEndUnlessTheFileHasItOtherwise) {
  const std::string compiler = compiler_;
  const auto share = [&](const std::string& option, const char* joint = R"(damping="2")") {
    compiler_ = compiler + option;
    return hip(R"(<position joint="FL_hip" kp="60"/>)", joint).implicit_joint_damping;
  };
  EXPECT_EQ(share(""), 1) << "Euler's default";
  EXPECT_EQ(share("", ""), 0) << "nothing is damped";
  EXPECT_EQ(share(R"(<option integrator="implicitfast"/>)"), 1);
  EXPECT_EQ(share(R"(<option integrator="RK4"/>)"), 0);
  EXPECT_EQ(share(R"(<option><flag eulerdamp="disable"/></option>)"), 0);
}

TEST_F(MjcfServos, LimitsCountWhereTheyAreLimits) {
  const std::string motor = R"(<motor joint="FL_hip" ctrlrange="-35 35" ctrllimited="false"/>)";
  EXPECT_EQ(hip(motor).effort_limit, 0);
  EXPECT_EQ(hip(motor, R"(actuatorfrcrange="-9 9" actuatorfrclimited="false")").effort_limit, 0);
  compiler_ = R"(<compiler angle="radian" autolimits="false"/>)";
  EXPECT_EQ(hip("", R"(actuatorfrcrange="-9 9")").effort_limit, 0);
  EXPECT_EQ(hip("", R"(actuatorfrcrange="-9 9" actuatorfrclimited="true")").effort_limit, 9);
}

TEST_F(MjcfServos, TorqueLimitsMayDifferByDirection) {
  const Joint joint = hip(R"(<motor joint="FL_hip" ctrlrange="-10 24"/>)");
  EXPECT_EQ(joint.effort_limit, 24);
  EXPECT_EQ(joint.effort_negative, 10);
  // A gear that turns round turns the limits round.
  EXPECT_EQ(hip(R"(<motor joint="FL_hip" gear="-1" ctrlrange="-10 24"/>)").effort_limit, 10);
  EXPECT_EQ(hip(R"(<motor joint="FL_hip" ctrlrange="0 24"/>)").effort_limit, 24);
  EXPECT_TRUE(warned("with torques from 0 to 24 N m, taken for +-24 N m: 'FL_hip'"));
}

TEST_F(MjcfServos, ClassesAreOneSetOfSettingsForAllKinds) {
  const std::string defaults = R"(<position kp="60" kv="4"/><default class="a"><motor gear="2"/></default>)";
  EXPECT_EQ(hip(R"(<position joint="FL_hip" kp="50"/>)", "", defaults).kp, 50);
  EXPECT_EQ(hip(R"(<position joint="FL_hip" kp="50"/>)", "", defaults).kd, 4);
  EXPECT_EQ(hip(R"(<general joint="FL_hip"/>)", "", defaults).kp, 60);
  EXPECT_EQ(hip(R"(<position class="a" joint="FL_hip" kp="50"/>)", "", R"(<default class="a">
                   <motor gear="2"/></default>)")
                .kp,
            200);
  EXPECT_EQ(hip(R"(<motor joint="FL_hip"/>)", "", defaults).kp, 0);
  // Gains of another kind are none of its.
  EXPECT_EQ(hip(R"(<velocity joint="FL_hip"/>)", "", defaults).kd, 1);
  EXPECT_EQ(hip(R"(<position joint="FL_hip" kp="5"/>)", "", R"(<velocity kv="3"/>)").kd, 0);
  EXPECT_EQ(hip(R"(<velocity joint="FL_hip"/>)", "", R"(<velocity kv="3"/>)").kd, 3);
  EXPECT_EQ(
      hip("", R"(class="strong")", R"(<default class="strong"><joint actuatorfrcrange="-7 7"/></default>)")
          .effort_limit,
      7);
}

// As MuJoCo 3.3 and 4.0 have it.
TEST_F(MjcfServos, GainsPassByElementsOfOtherKindsInTheClassesBetween) {
  const auto nested = [](const std::string& outer, const std::string& inner) {
    return R"(<default class="p">)" + outer + R"(<default class="c">)" + inner + "</default></default>";
  };
  const std::string position = R"(<position class="c" joint="FL_hip"/>)",
                    velocity = R"(<velocity class="c" joint="FL_hip"/>)";
  const std::string servo = R"(<position kp="60" kv="4" timeconst=".02"/>)";
  for (const char* between : {R"(<motor forcerange="-7 7"/>)", R"(<velocity kv="9" forcerange="-7 7"/>)"}) {
    const Joint joint = hip(position, "", nested(servo, between));
    EXPECT_EQ(joint.kp, 60);
    EXPECT_EQ(joint.kd, 4);
    EXPECT_EQ(joint.lag, 0.02);
    EXPECT_EQ(joint.effort_limit, 7);
  }
  const std::string general =
      R"(<general gainprm="30" biastype="affine" biasprm="0 -30 -2" dyntype="filter"/>)";
  EXPECT_EQ(hip(velocity, "", nested(general, R"(<motor gear="1"/>)")).kd, 30);
  EXPECT_EQ(hip(position, "", nested(general, R"(<motor gear="1"/>)")).lag, 0);
  EXPECT_EQ(hip(velocity, "", nested(servo, R"(<motor gear="1"/>)")).kd, 1);
  // Within one class they do not.
  EXPECT_EQ(hip(position, "", R"(<default class="c"><position kp="60"/><motor gear="1"/></default>)").kp, 1);
}

TEST_F(MjcfServos, WhatIsNoServoStillAddsToItsJoint) {
  const Joint joint = hip(R"(<position joint="FL_hip" kp="60"/>
                             <damper joint="FL_hip" kv=".5" ctrlrange="0 2" gear="2" armature=".01" damping=".3"/>
                             <cylinder joint="FL_hip" area="1" armature=".02"/>)");
  EXPECT_DOUBLE_EQ(joint.armature, 0.06);
  EXPECT_DOUBLE_EQ(joint.damping, 1.2);
  EXPECT_EQ(joint.kp, 60);
  EXPECT_TRUE(warned("ignored the force of 1 <damper>, neither motor nor servo of a joint, first in damper"));
  EXPECT_TRUE(warned("kv=\".5\""));
  EXPECT_TRUE(warned("ignored the force of 1 <cylinder>"));
}

TEST_F(MjcfServos, ServosOfOneJointWithFiltersOfTheirOwnAreSaid) {
  EXPECT_EQ(
      hip(R"(<position joint="FL_hip" kp="40" timeconst=".02"/><position joint="FL_hip" kp="20"/>)").lag,
      0.02);
  EXPECT_TRUE(
      warned("1 joint(s) have several servos, all of which get the lag and delay of one: 'FL_hip' 0.02 s"));
  EXPECT_EQ(hip(R"(<position joint="FL_hip" kp="40" timeconst=".02"/>)").lag, 0.02);
  EXPECT_FALSE(warned("several servos"));
}

TEST_F(MjcfServos, DampingIsTheSameInEverySpelling) {
  EXPECT_EQ(hip(R"(<position joint="FL_hip" kp="60" kv="4"/>)").kd, 4);
  EXPECT_EQ(hip(R"(<general joint="FL_hip" gainprm="60" biastype="affine" biasprm="0 -60 -4"/>)").kd, 4);
  EXPECT_EQ(hip(R"(<position joint="FL_hip" kp="60" kv="4" gear="2"/>)").kd, 16);
  EXPECT_EQ(hip(R"(<general joint="FL_hip" gainprm="60" biastype="affine" biasprm="0 -50 4"/>)").kd, 0);
  EXPECT_TRUE(warned("took -4 for 0 as the damping"));
}

// M is what the hip moves with everything else free, at the file's zero: the inverse of the diagonal of the
// inverse inertia.
TEST_F(MjcfServos, ADampingRatioIsThatOfTheInertiaAtTheFilesZero) {
  MadeMjcf made;
  made.compiler = compiler_;
  RobotDescription robot;
  robot.bodies = tree(made).bodies;
  // `hip` gives all hips the armature of the file, or FL's alone that of an actuator.
  const auto moved = [&robot](const std::string& with_armature) {
    Eigen::Index fl = 0;
    for (std::size_t i = 1; i < robot.bodies.size(); ++i) {
      Joint& joint = robot.bodies[i].joint;
      joint.armature = joint.name.ends_with(with_armature) ? 0.05 : 0;
      if (joint.name == "FL_hip") fl = static_cast<Eigen::Index>(i) - 1;
    }
    return 1 / joint_inverse_weights(robot, false)[fl];
  };
  const double critical = 2 * std::sqrt(60 * moved("_hip"));
  constexpr double kRounding = 1e-11;  // of two inverses of a matrix of 14 rows
  const char* const armature = R"(armature=".05")";
  EXPECT_NEAR(hip(R"(<position joint="FL_hip" kp="60" dampratio="1"/>)", armature).kd, critical, kRounding);
  EXPECT_NEAR(
      hip(R"(<general joint="FL_hip" gainprm="60" biastype="affine" biasprm="0 -60 .5"/>)", armature).kd,
      critical / 2, kRounding);
  // kp and inertia are those of the joint, behind the gear.
  EXPECT_NEAR(hip(R"(<position joint="FL_hip" kp="15" gear="2" dampratio="1"/>)", armature).kd, critical,
              kRounding);
  EXPECT_NEAR(hip(R"(<position joint="FL_hip" kp="60" dampratio="1" armature=".0125" gear="2"/>)").kd,
              2 * std::sqrt(240 * moved("FL_hip")), kRounding);
}

TEST_F(MjcfServos, FiltersAreLags) {
  const Joint filtered = hip(R"(<general joint="FL_hip" gainprm="60" biastype="affine" biasprm="0 -60 -4"
                                 dyntype="filter" dynprm=".02"/>)");
  EXPECT_EQ(filtered.kp, 60);
  EXPECT_EQ(filtered.kd, 4);
  EXPECT_EQ(filtered.lag, 0.02);
  EXPECT_EQ(hip(R"(<position joint="FL_hip" kp="60" timeconst=".03"/>)").lag, 0.03);
  EXPECT_EQ(hip(R"(<position joint="FL_hip" timeconst="0"/>)", "", R"(<position timeconst=".03"/>)").lag, 0);
}

TEST_F(MjcfServos, TargetsHaveTheRangeOfTheControl) {
  const Joint narrow = hip(R"(<position joint="FL_hip" kp="60" ctrlrange="-.2 .3"/>)");
  EXPECT_EQ(narrow.target_lower, -0.2);
  EXPECT_EQ(narrow.target_upper, 0.3);
  const Joint geared = hip(R"(<position joint="FL_hip" kp="60" gear="-2" ctrlrange="-.2 .3"/>)");
  EXPECT_EQ(geared.target_lower, -0.15);
  EXPECT_EQ(geared.target_upper, 0.1);
  const Joint free = hip(R"(<position joint="FL_hip" kp="60" ctrlrange="-.2 .3" ctrllimited="false"/>)");
  EXPECT_EQ(free.target_lower, Joint().target_lower);
}

TEST_F(MjcfServos, TheRangeMayBeTheJoints) {
  const char* const range = R"(range="-1 2")";
  EXPECT_EQ(
      hip(R"(<position joint="FL_hip" kp="60" inheritrange="1" ctrllimited="true"/>)", range).target_lower,
      -1);
  const Joint half = hip(R"(<position joint="FL_hip" kp="60" inheritrange=".5"/>)", range);
  EXPECT_EQ(half.target_lower, -0.25);
  EXPECT_EQ(half.target_upper, 1.25);
  EXPECT_EQ(hip(R"(<position joint="FL_hip" ctrlrange="-.1 .1"/>)", range, R"(<position inheritrange="1"/>)")
                .target_upper,
            0.1);
  EXPECT_EQ(hip(R"(<position joint="FL_hip" inheritrange="1"/>)", range, R"(<position ctrlrange="-.1 .1"/>)")
                .target_upper,
            2);
  (void)hip(R"(<position joint="FL_hip" inheritrange="1"/>)");
  EXPECT_TRUE(warned("ignored 1 inheritrange of joints without a range"));
}

TEST_F(MjcfServos, SpringsAreTheJoints) {
  const Joint spring = hip("", R"(stiffness="40" springref="-1.2")");
  EXPECT_EQ(spring.stiffness, 40);
  EXPECT_EQ(spring.spring_reference, -1.2);
  EXPECT_EQ(hip("", R"(stiffness="40 3 2" damping=".5 .1")").stiffness, 40);
  EXPECT_TRUE(warned("took the first coefficient alone of 4 stiffness=\"40 3 2\""));
  EXPECT_TRUE(warned("took the first coefficient alone of 4 damping=\".5 .1\""));
}

TEST_F(MjcfServos, BlanksAroundAttributesMeanNothing) {
  sections_ = "<keyframe><key name=\"home\" qpos=\" 0 0 .2 1 0 0 0  1 -2  1 -2  1 -2  1 -2 \n\"/></keyframe>";
  EXPECT_EQ(hip("<position joint=\"FL_hip \" kp=\" 60\t\"/>").kp, 60);
}

TEST_F(MjcfServos, RefusesByName) {
  const auto refused = [&](const std::string& actuator) {
    return config_error([&] { (void)hip(actuator); });
  };
  EXPECT_EQ(refused(R"(<position joint="FL_hip" kv="1" dampratio="1"/>)").found(), "both");
  EXPECT_EQ(refused(R"(<position joint="FL_hip" ctrlrange="0 1" inheritrange="1"/>)").found(), "both");
  EXPECT_EQ(refused(R"(<position joint="nobody"/>)").found(), "'nobody'");
  EXPECT_EQ(refused(R"(<position joint="FL_hip" class="nobody"/>)").found(), "'nobody'");
  EXPECT_EQ(refused(R"(<position joint="FL_hip" kp="many"/>)").found(), "'many'");
  EXPECT_EQ(refused(R"(<position joint="FL_hip" kv="-1"/>)").expected(), "kv >= 0");
}

TEST_F(MjcfServos, ASecondHingeOfHundredthsIsBacklash) {
  MadeMjcf mjcf;
  mjcf.compiler = compiler_;
  mjcf.thigh = R"(<joint name="play" axis="0 1 0" range="-.03 .03"/>)";
  const ParsedRobot robot = tree(mjcf);
  EXPECT_EQ(body(robot, "FL_thigh").joint.name, "FL_hip");
  EXPECT_EQ(body(robot, "FL_thigh").joint.backlash, 0.06);
  EXPECT_TRUE(warns(robot.warnings, "read as a backlash of 0.06 rad"));
  for (const char* other : {R"(<joint name="play" axis="0 1 0" range="-.3 .3"/>)",
                            R"(<joint name="play" axis="0 0 1" range="-.03 .03"/>)"}) {
    mjcf.thigh = other;
    EXPECT_EQ(refusal(mjcf).found(), "a second one on 'FL_thigh'") << other;
  }
}

TEST_F(MjcfServos, AHingeOfHundredthsOnABodyOfItsOwnIsBacklashToo) {
  MadeMjcf mjcf;
  mjcf.compiler = compiler_;
  const auto with = [&](const std::string& joint) {
    mjcf.shin = R"(<body name="toe"><inertial pos="0 0 -.1" mass=".5" diaginertia=".02 .03 .04"/>
                   <joint name="play" )" +
                joint + "/></body>";
    return tree(mjcf);
  };
  const ParsedRobot robot = with(R"(axis="0 1 0" range="-.03 .03")");
  EXPECT_EQ(body(robot, "FL_shin").joint.backlash, 0.06);
  EXPECT_EQ(body(robot, "FL_shin").inertia.mass, 1.5);
  EXPECT_EQ(robot.bodies.size(), 9U);
  for (const char* other : {R"(axis="1 0 0" range="-.03 .03")", R"(axis="0 1 0" range="-.3 .3")",
                            R"(axis="0 1 0" range="-.03 .03" pos="0 0 -.1")"})
    EXPECT_EQ(with(other).bodies.size(), 10U) << other;
}

TEST_F(MjcfServos, LegsWhoseJointsFollowOthersAreRefused) {
  MadeMjcf mjcf;
  const auto refused = [&](const std::string& sections) {
    mjcf.sections = sections;
    return refusal(mjcf);
  };
  const ConfigError equal = refused(R"(<equality><joint joint1="FL_knee" joint2="FR_knee"/></equality>)");
  EXPECT_EQ(equal.element(), "joint 'FL_knee' of a leg");
  EXPECT_NE(equal.found().find("follows 'FR_knee'"), std::string::npos) << equal.what();
  const std::string belt = R"(<tendon><fixed name="belt"><joint joint="FL_hip" coef="1"/>
                              <joint joint="FL_knee" coef="1"/></fixed></tendon>)";
  const ConfigError driven = refused(belt + R"(<actuator><position joint="FL_hip" kp="60"/>
                                               <position tendon="belt" kp="60"/></actuator>)");
  EXPECT_NE(driven.found().find("is driven by tendon 'belt'"), std::string::npos) << driven.what();
  mjcf.sections = R"(<equality><joint joint1="FL_knee" joint2="FR_knee" active="false"/></equality>)" + belt;
  EXPECT_NO_THROW((void)load(mjcf));
}

TEST_F(MjcfServos, ATendonOfOneJointIsAGear) {
  sections_ = R"(<tendon><fixed name="t"><joint joint="FL_hip" coef="2"/></fixed></tendon>)";
  const Joint joint = hip(R"(<position tendon="t" kp="15" kv="1" gear="3"/>)");
  EXPECT_EQ(joint.kp, 15 * 36);
  EXPECT_EQ(joint.kd, 36);
}

TEST_F(MjcfServos, LegsOnTheWorldHadABaseOnce) {
  std::string bodies;
  for (const char* leg : {"a", "b", "c", "d"})
    bodies +=
        fmt::format(R"(<body name="{0}"><joint name="{0}_j" axis="0 1 0"/><geom size=".1"/></body>)", leg);
  const auto refused = [&](const std::string& text) {
    const std::string xml = write("welded.xml", "<mujoco><worldbody>" + text + "</worldbody></mujoco>");
    return config_error([&] { (void)read_mjcf(xml); });
  };
  const ConfigError error = refused(bodies);
  std::string shoulders;
  for (const char* leg : {"a", "b", "c", "d"})
    shoulders += fmt::format(
        R"(<body name="{0}"><body name="{0}_hip"><joint name="{0}_j" axis="0 1 0"/><geom size=".1"/></body></body>)",
        leg);
  EXPECT_EQ(refused(shoulders).expected(), error.expected());
  EXPECT_EQ(error.expected(), "a base that floats, on which the legs hang");
  EXPECT_NE(error.found().find("4 chains of joints that hang on the world itself ('a', 'b', 'c', 'd')"),
            std::string::npos)
      << error.what();
}

TEST_F(MjcfServos, AnotherOrderOfActuatorsIsSaid) {
  const auto warnings = [&](std::initializer_list<const char*> order) {
    MadeMjcf mjcf;
    for (const char* joint : order) mjcf.sections += fmt::format("<motor joint=\"{}\"/>", joint);
    mjcf.sections = "<actuator>" + mjcf.sections + "</actuator>";
    // A joint with an actuator that is no servo of a leg: it is held.
    mjcf.trunk += R"(<body name="tail"><joint name="tail"/><geom size=".05" mass=".1"/></body>)";
    return load(mjcf).report.warnings;
  };
  EXPECT_TRUE(warns(
      warnings({"FR_hip", "FR_knee", "FL_hip", "FL_knee", "tail", "RL_hip", "RL_knee", "RR_hip", "RR_knee"}),
      "actuators stand in another order than joints: a policy made on ctrl has `joints: {order: "
      "[FR_hip, FR_knee, FL_hip, FL_knee, RL_hip, RL_knee, RR_hip, RR_knee]}`"));
  EXPECT_FALSE(warns(
      warnings({"FL_hip", "FL_knee", "FR_hip", "FR_knee", "RL_hip", "RL_knee", "RR_hip", "tail", "RR_knee"}),
      "another order"));
}

// What the file says of a machine is all of it: without a rotor there is none, and no limit is one.
TEST_F(MjcfServos, WithGainsOfTheFileNothingIsMadeUpOfInertia) {
  MadeMjcf mjcf;
  mjcf.hip_joint = R"(armature="0.01")";
  std::string servos;
  for (const Leg leg : kLegs)
    servos += fmt::format(
        R"(<position joint="{0}_hip" kp="60" kv="1"/><position joint="{0}_knee" kp="60" kv="1"/>)",
        name(leg));
  mjcf.sections = "<actuator>" + servos + "</actuator>";
  const auto [robot, report] = load(mjcf);
  const LegModel& leg = (*robot.legs)[Leg::FL];
  EXPECT_EQ(robot.joint(leg.joint("hip")).armature, 0.01);
  EXPECT_EQ(robot.joint(leg.joint("knee")).armature, 0);
  EXPECT_TRUE(warns(report.warnings, "the file sets no limit to the torque of 8 joint(s) from 'FL_hip'"));
  mjcf.sections = "";
  EXPECT_GT(load(mjcf).robot.joint(leg.joint("knee")).armature, 0);
}

// A small motor beside a servo limits itself alone.
TEST_F(MjcfServos, AServoWithoutALimitHasNoneBesideAMotorThatHasOne) {
  EXPECT_EQ(hip(R"(<position joint="FL_hip" kp="60"/><motor joint="FL_hip" ctrlrange="-5 5"/>)").effort_limit,
            0);
  EXPECT_EQ(
      hip(R"(<position joint="FL_hip" kp="60" forcerange="-20 20"/><motor joint="FL_hip"/>)").effort_limit,
      20);
  (void)hip(R"(<position joint="FL_hip" kp="60" gear="2"/>)");
  EXPECT_TRUE(warned("takes targets for angles, which are 0.5 times the controls"));
}

TEST_F(MjcfServos, ADamperWithoutASpringIsSaid) {
  MadeMjcf mjcf;
  for (const Leg leg : kLegs)
    mjcf.sections +=
        fmt::format(R"(<velocity joint="{0}_hip" kv="2"/><velocity joint="{0}_knee" kv="2"/>)", name(leg));
  mjcf.sections = "<actuator>" + mjcf.sections + "</actuator>";
  EXPECT_TRUE(warns(load(mjcf).report.warnings, "the file gives kd 2 N m s/rad and no kp for 8 joint(s)"));
  (void)hip(R"(<general joint="FL_hip" gainprm="60" biastype="affine" biasprm="0 -40 0"/>)");
  EXPECT_TRUE(warned("takes targets for angles, which are 1.5 times the controls"));
}

// MuJoCo 4.0.0 and 2.2.2 combine these to the same numbers (margins apart).
TEST_F(MjcfServos, ContactIsCombinedAsMuJoCoDoes) {
  MadeMjcf mjcf;
  const auto touch = [&](const std::string& foot, const std::string& ground,
                         const std::string& sections = "") {
    mjcf.shin = "<geom name=\"toe\" size=\".02\" " + foot + "/>";
    mjcf.world = "<geom name=\"ground\" type=\"plane\" size=\"5 5 .1\" " + ground + "/>";
    mjcf.sections = sections;
    return tree(mjcf).contact.shapes.at("toe");
  };
  using Three = std::array<double, 3>;
  using Two = std::array<double, 2>;
  EXPECT_EQ(touch(R"(friction=".7")", R"(friction=".5")").friction, (Three{0.7, 0.005, 0.0001}));
  const ContactNumbers first = touch(R"(friction=".7" priority="1" condim="4")", R"(friction="1.5 .1")");
  EXPECT_EQ(first.friction, (Three{0.7, 0.005, 0.0001}));
  EXPECT_EQ(first.condim, 4);
  const ContactNumbers mixed =
      touch(R"(solref=".01 2" solmix="3")", R"(friction="1.5 .1" solref=".05 1" solimp=".8 .9 .01")");
  EXPECT_EQ(mixed.friction, (Three{1.5, 0.1, 0.0001}));
  EXPECT_NEAR(mixed.solref[0], 0.02, 1e-15);
  EXPECT_NEAR(mixed.solref[1], 1.75, 1e-15);
  EXPECT_NEAR(mixed.solimp[0], 0.875, 1e-15);
  EXPECT_NEAR(mixed.solimp[2], 0.00325, 1e-15);
  EXPECT_EQ(touch(R"(solref="-100 -10")", "").solref, (Two{-100, -10}));
  EXPECT_EQ(touch(R"(friction=".7")", "",
                  R"(<contact><pair geom1="ground" geom2="toe" friction=".2 .2 .01"/></contact>)")
                .friction,
            (Three{0.2, 0.01, 0.0001}));
  const auto unused =
      touch("", "", R"(<contact><pair geom1="ground" geom2="toe" friction=".2 .5 .01 .001 .002"/></contact>)")
          .not_simulated;
  EXPECT_EQ(unused.at("second_friction").number, 0.5);
  EXPECT_EQ(unused.at("second_rolling_friction").number, 0.002);
  EXPECT_EQ(
      touch(R"(friction=".7")", "", R"(<option o_friction=".3 .3 .01"><flag override="enable"/></option>)")
          .friction,
      (Three{0.3, 0.01, 0.0001}));
  const ParsedRobot robot = tree([&] {
    mjcf.sections = R"(<option timestep=".005" impratio="100" cone="elliptic" integrator="implicitfast"/>)";
    return mjcf;
  }());
  EXPECT_EQ(robot.contact.timestep, 0.005);
  EXPECT_EQ(robot.contact.impratio, 100);
  EXPECT_EQ(robot.contact.cone, "elliptic");
  EXPECT_EQ(robot.contact.integrator, "implicitfast");
  mjcf.sections = R"(<option gravity="0 0 -1.6"/><option noslip_iterations="3"/>)";
  const ParsedRobot moon = tree(mjcf);
  EXPECT_EQ(moon.contact.gravity, (Three{0, 0, -1.6}));
  EXPECT_EQ(moon.contact.noslip_iterations, 3);
}

/// The compiler that is asked, one plug-in's, until the end of a test.
EngineRegistry* only_compiler = nullptr;

// What releases of the compiler know of a file differs; what becomes of the robot must not.
TEST_F(MjcfServos, EveryReleaseReadsTheSameRobot) {
  MadeMjcf mjcf;
  mjcf.compiler = compiler_ + "<option impratio=\"10\"/>";
  mjcf.defaults = R"(<position kp="60" dampratio="1" inheritrange="1"/>
                     <joint actuatorfrcrange="-9 9" range="-2 2" damping=".1 .01"/>)";
  mjcf.hip_joint = R"(stiffness="4" springref=".5")";
  mjcf.sections = R"(<actuator><position joint="FL_hip"/><position joint="FL_knee" kv="2" timeconst=".01"/>
                     <motor joint="FR_hip" ctrlrange="-3 5"/></actuator>
                     <keyframe><key qpos="0 0 .2 1 0 0 0  1 -2  1 -2  1 -2  1 -2 "/></keyframe>)";
  const std::string xml = file(mjcf);
  std::vector<RobotDescription> robots;
  std::vector<std::vector<std::string>> warnings;
  std::vector<std::unique_ptr<EngineRegistry>> registries;
  for (const std::string& plugin : plugin_files(plugin_folders())) {
    const fs::path folder = path("plugin" + std::to_string(registries.size()));
    fs::create_directory(folder);
    fs::create_symlink(plugin, folder / fs::path(plugin).filename());
    registries.push_back(std::make_unique<EngineRegistry>(std::vector<std::string>{folder.string()}));
    if (!registries.back()->compiles_mjcf()) continue;
    only_compiler = registries.back().get();
    const MjcfCompiler before =
        set_mjcf_compiler([](const MjcfText& text) { return only_compiler->compile_mjcf(text); });
    LoadedRobot loaded = load_robot_with_report(xml);
    set_mjcf_compiler(before);
    robots.push_back(std::move(loaded.robot));
    warnings.push_back(std::move(loaded.report.warnings));
  }
  if (robots.size() < 2) GTEST_SKIP() << "one release of the compiler alone is installed";
  for (std::size_t i = 1; i < robots.size(); ++i) {
    EXPECT_EQ(warnings[i], warnings[0]);
    std::vector<double> a, b;
    const auto collect = [](std::vector<double>& into) {
      return [&into](const MemberPath& /*path*/, const auto& leaf) {
        if constexpr (std::is_same_v<decltype(leaf), const double&>) into.push_back(leaf);
      };
    };
    for_each_leaf(std::as_const(robots[0]), collect(a));
    for_each_leaf(std::as_const(robots[i]), collect(b));
    ASSERT_EQ(a.size(), b.size());
    // Decimal numbers of order one, turned into principal axes and back by each release.
    for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 1e-12 * std::max(1.0, std::abs(a[k])));
  }
}

}  // namespace
}  // namespace crossgait
