// Legs on bars from MJCF: which joints have servos is what its actuators say, and they walk.
#include <memory>

#include <gtest/gtest.h>

#include "motion/gait_source.h"
#include "motion/walk.h"
#include "tests/backends/made_mjcf.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

/// Hips and knees, a crank on each thigh and a rod from it to the shin.
std::string legs_on_bars(const char* driven) {
  std::string bodies, loops, actuators;
  for (const Leg leg : kLegs) {
    bodies += fmt::format(
        R"(<body name="{0}_thigh" pos="{1} {2} 0"><joint name="{0}_hip"/><geom fromto="0 0 0 0 0 -.2" mass=".3"/>
<body name="{0}_shin" pos="0 0 -.2"><joint name="{0}_knee"/><geom fromto="0 0 0 0 0 -.2" mass=".15"/>
<geom name="{0}_foot" type="sphere" size=".02" pos="0 0 -.2" mass=".01"/></body>
<body name="{0}_crank" pos="0 0 -.02"><joint name="{0}_crank"/><geom fromto="0 0 0 -.03 0 .03" mass=".02" contype="0" conaffinity="0"/>
<body name="{0}_rod" pos="-.03 0 .03"><joint name="{0}_rod"/><geom fromto="0 0 0 0 0 -.18" mass=".02" contype="0" conaffinity="0"/></body></body></body>)",
        name(leg), is_front(leg) ? 0.2 : -0.2, 0.12 * side_sign(leg));
    loops += fmt::format(R"(<connect name="{0}_loop" body1="{0}_rod" body2="{0}_shin" anchor="0 0 -.18"/>)",
                         name(leg));
    for (const std::string joint : {"hip", driven})
      actuators += fmt::format(R"(<position joint="{0}_{1}" kp="60" kv="1.5" forcerange="-15 15"/>)",
                               name(leg), joint);
  }
  return R"(<mujoco model="bars"><compiler angle="radian"/><default><geom type="capsule" size=".008"/>
<joint axis="0 1 0" range="-2.4 2.4" armature=".002" damping=".01"/></default><worldbody><body name="trunk" pos="0 0 .4"><freejoint/>
<geom type="box" size=".22 .1 .04" mass="3"/>)" +
         bodies + "</body></worldbody><equality>" + loops + "</equality><actuator>" + actuators +
         "</actuator></mujoco>";
}

class MjcfOnBars : public MjcfReader, public ::testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(, MjcfOnBars, ::testing::Values("crank", "knee"),
                         [](const auto& test) { return std::string(test.param) + "_driven"; });

TEST_P(MjcfOnBars, HaveServosWhereTheFileHasActuators) {
  const RobotDescription robot = load_robot(write("bars.xml", legs_on_bars(GetParam())));
  for (const Leg leg : kLegs) {
    const LegModel& model = (*robot.legs)[leg];
    ASSERT_EQ(model.linkage, LegLinkage::kClosedChain);
    ASSERT_EQ(model.servos.size(), 2U);
    EXPECT_EQ(robot.joint(model.servos[0]).name, fmt::format("{}_hip", name(leg)));
    EXPECT_EQ(robot.joint(model.servos[1]).name, fmt::format("{}_{}", name(leg), GetParam()));
    EXPECT_EQ(robot.joint(model.servos[1]).kp, 60);
    EXPECT_EQ(model.foot_body, model.joint("knee") + 1);
    EXPECT_EQ(model.passive.size(), 2U);
  }
}

TEST_P(MjcfOnBars, WhatIsNoLegIsSaid) {
  const std::string sound = legs_on_bars(GetParam());
  const auto refusal = [&](const std::string& before, const std::string& more) {
    std::string text = sound;
    text.insert(text.find(before), more);
    return config_error([&] { (void)load_robot(write("bars.xml", text)); });
  };
  const ConfigError tied =
      refusal("</equality>", R"(<connect name="tie" body1="FL_shin" body2="FR_shin" anchor="0 0 0"/>)");
  EXPECT_EQ(tied.element(), "legs");
  EXPECT_EQ(tied.found(), "'tie' from 'FL_shin' to 'FR_shin', of two legs");
  // All four joints of a leg with a servo: nothing is left for the loop to move.
  std::string driven;
  for (const Leg leg : kLegs) {
    for (const char* joint : {"knee", "crank", "rod"})
      driven += fmt::format(R"(<position joint="{}_{}" kp="9"/>)", name(leg), joint);
  }
  EXPECT_EQ(refusal("</actuator>", driven).element(), "legs.FL");
}

TEST_P(MjcfOnBars, AClassGivesNoNames) {
  std::string text = legs_on_bars(GetParam());
  const std::string axis = "axis=\"0 1 0\" range";
  ASSERT_NE(text.find(axis), std::string::npos);
  text.replace(text.find(axis), axis.size(), "name=\"0 1 0\" range");
  EXPECT_EQ(config_error([&] { (void)load_robot(write("bars.xml", text)); }).expected(),
            "no name in a class, which is of several");
}

TEST_P(MjcfOnBars, Walk) {
  const auto robot =
      std::make_shared<const RobotDescription>(load_robot(write("bars.xml", legs_on_bars(GetParam()))));
  for (const std::string& engine : available_engines()) {
    SCOPED_TRACE(engine);
    const std::unique_ptr<PhysicsBackend> world = make_world(engine, scenes::world_of(robot));
    const auto gait = choose_gait("trot", {}, std::nullopt, gait_scale(*robot));
    const MotionSummary walk = run_walk(*world, make_gait_controller(gait, world->spec()), {.seconds = 3});
    EXPECT_GT(walk.distance_m, 0.3);
    EXPECT_LT(walk.max_loop_gap_m, 0.01);
  }
}

}  // namespace
}  // namespace crossgait
